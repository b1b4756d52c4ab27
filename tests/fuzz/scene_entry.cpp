#include <cmath>
#include <memory>
#include <stdexcept>
#include <string_view>

#include "engine/rendering/scene.hpp"
#include "protocols/file/protocol_file.hpp"
#include "protocols/file/scene_file.hpp"
#include "tests/fuzz/entries.hpp"
#include "tests/fuzz/law.hpp"

namespace palpate::fuzz {

void read_scene(Bytes bytes) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    try {
        const protocols::SceneFile file = protocols::parse_scene(text, "fuzz.toml");
        if (file.curves.empty()) {
            return;
        }
        const auto outline = std::make_shared<const engine::Outline>(protocols::outline_of(file));
        const engine::Scene scene(outline, protocols::spec_of(file, 1e-3));
        engine::ContactState state;
        const engine::Box<2>& box = outline->spans().front().box();
        for (int i = 0; i < 8; ++i) {
            const engine::Vec2 h = box.low + (0.2 * i - 0.2) * box.size();
            const engine::Contact contact = scene.tick(state, h);
            demand(std::isfinite(contact.go.x) && std::isfinite(contact.go.y),
                   "finite in, finite out");
            demand(contact.mode != engine::Mode::free || contact.force == engine::Vec2{},
                   "no force while free");
        }
    } catch (const protocols::ProtocolError& refusal) {
        demand(*refusal.what() != '\0', "a refusal says why");
    } catch (const std::invalid_argument& refusal) {
        demand(*refusal.what() != '\0', "a refusal says why");
    }
}

}  // namespace palpate::fuzz

#include "protocols/file/calibration_file.hpp"
#include "protocols/file/deformation_file.hpp"
#include "protocols/file/observer_file.hpp"
#include "protocols/file/procedure_file.hpp"
#include "protocols/file/protocol_file.hpp"
#include "protocols/file/scene_file.hpp"
#include "data/csv/number_table.hpp"
#include "tests/fuzz/entries.hpp"

namespace palpate::fuzz {
namespace {

std::string_view text_of(Bytes bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Reads, and takes a documented refusal that says why.
template <class Read>
void read_or_refuse(const Read& read) {
    try {
        read();
    } catch (const protocols::ProtocolError& refusal) {
        demand(*refusal.what() != '\0', "a refusal says why");
    } catch (const data::CsvError& refusal) {
        demand(*refusal.what() != '\0', "a refusal says why");
    }
}

void feel(const protocols::SceneFile& file) {
    const auto outline = std::make_shared<const engine::Outline>(protocols::outline_of(file));
    const engine::Scene scene(outline, protocols::spec_of(file, 1e-3));
    engine::ContactState state;
    const engine::Box<2>& box = outline->spans().front().box();
    for (int i = 0; i < 8; ++i) {
        const engine::Vec2 h = box.low + (0.2 * i - 0.2) * box.size();
        const engine::Contact contact = scene.tick(state, h);
        demand(std::isfinite(contact.go.x) && std::isfinite(contact.go.y), "finite in, finite out");
        demand(contact.mode != engine::Mode::free || contact.force == engine::Vec2{},
               "no force while free");
    }
}

}  // namespace

void scene(Bytes bytes) {
    read_or_refuse([&] {
        const protocols::SceneFile file = protocols::parse_scene(text_of(bytes), "fuzz.toml");
        if (file.curves.empty()) {
            return;
        }
        try {
            feel(file);
        } catch (const std::invalid_argument& refusal) {
            demand(*refusal.what() != '\0', "a refusal says why");
        }
    });
}

void csv(Bytes bytes) {
    constexpr std::array<std::string_view, 3> kWanted{"time_s", "hip_x_m", "hip_y_m"};
    constexpr std::array<std::string_view, 1> kOptional{"hip_z_m"};
    read_or_refuse([&] {
        const data::NumberTable table =
            data::parse_numbers(text_of(bytes), "fuzz.csv", kWanted, kOptional);
        demand(table.values.size() == table.rows() * table.columns.size(), "rows are whole");
        for (const double value : table.values) {
            demand(std::isfinite(value), "a table holds finite numbers");
        }
    });
}

void protocol(Bytes bytes) {
    read_or_refuse([&] {
        const protocols::Protocol read = protocols::parse_protocol(text_of(bytes), "fuzz.toml");
        const std::string own = protocols::to_toml(read);
        demand(protocols::parse_protocol(own, "own.toml") == read,
               "the canonical text reads back as the same protocol");
    });
}

void procedure(Bytes bytes) {
    read_or_refuse(
        [&] { static_cast<void>(protocols::parse_procedure(text_of(bytes), "fuzz.toml")); });
}

void observer(Bytes bytes) {
    read_or_refuse([&] {
        const auto read = protocols::parse_observer(text_of(bytes), "fuzz.toml");
        demand(protocols::parse_observer(protocols::observer_text(read), "own.toml") == read,
               "the canonical text reads back as the same observer");
    });
}

void deformation(Bytes bytes) {
    read_or_refuse(
        [&] { static_cast<void>(protocols::parse_deformation(text_of(bytes), "fuzz.toml")); });
}

void calibration(Bytes bytes) {
    read_or_refuse([&] {
        for (const auto& read : protocols::parse_calibrations(text_of(bytes), "fuzz.toml")) {
            const std::string own = protocols::to_toml(read);
            const auto again = protocols::parse_calibrations(own, "own.toml");
            demand(again.size() == 1 && protocols::to_toml(again.front()) == own,
                   "the canonical text reads back as itself");
        }
    });
}

}  // namespace palpate::fuzz

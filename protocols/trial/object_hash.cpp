#include "protocols/trial/object_hash.hpp"

#include <bit>
#include <cstdint>

#include <fmt/format.h>

#include "engine/base/sha256.hpp"
#include "protocols/design/object_outline.hpp"

namespace palpate::protocols {
namespace {

std::string bits(double value) {
    return fmt::format("{:016x}", std::bit_cast<std::uint64_t>(value));
}

}  // namespace

std::string outline_text(const engine::Outline& outline) {
    std::string text = fmt::format("palpate-outline-v1 {}\n", outline.closed() ? "closed" : "open");
    for (std::size_t i = 0; i < outline.spans().size(); ++i) {
        const auto& curve = outline.spans()[i];
        const engine::SpanName& name = outline.name(i);
        text += fmt::format("span {} degree {} parameters {} {} ratio {}\n", name.segment,
                            curve.degree(), bits(name.lo), bits(name.hi), bits(name.ratio));
        for (std::size_t k = 0; k <= static_cast<std::size_t>(curve.degree()); ++k) {
            const engine::Vec2 point = curve.point(k);
            text += fmt::format("point {} {} weight {}\n", bits(point.x), bits(point.y),
                                bits(curve.weight(k)));
        }
    }
    return text;
}

std::string surface_text(const engine::NurbsSurface& surface) {
    const engine::Vec3& origin = surface.origin();
    std::string text = fmt::format("palpate-surface-v1 origin {} {} {}\n", bits(origin.x),
                                   bits(origin.y), bits(origin.z));
    for (std::size_t i = 0; i < surface.rows(); ++i) {
        for (std::size_t j = 0; j < surface.columns(); ++j) {
            const engine::BezierPatch& patch = surface.patch(i, j);
            text +=
                fmt::format("patch {} {} degree {} {}\n", i, j, patch.degree_u(), patch.degree_v());
            for (const engine::Quad& one : patch.net()) {
                const engine::Vec3 point = one.xyz();
                text += fmt::format("point {} {} {} weight {}\n", bits(point.x), bits(point.y),
                                    bits(point.z), bits(one.w()));
            }
        }
    }
    return text;
}

std::vector<std::pair<std::string, std::string>> object_hashes(const Protocol& protocol) {
    std::vector<std::pair<std::string, std::string>> hashes;
    for (std::size_t i = 0; i < protocol.objects.size(); ++i) {
        const std::string text = protocol.surface
                                   ? surface_text(*surface_of(protocol, protocol.objects[i]))
                                   : outline_text(*outline_of(protocol, i));
        hashes.emplace_back("object sha256 " + protocol.objects[i].name, sha256_hex(text));
    }
    return hashes;
}

}  // namespace palpate::protocols

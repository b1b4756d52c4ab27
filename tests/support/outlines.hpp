#pragma once

#include "engine/rendering/scene.hpp"
#include "tests/support/std.hpp"

namespace palpate::tests {

/// What an object of the study is felt with.
inline constexpr engine::Friction kStudyFriction{
    .mu_s = 0.7, .mu_d = 0.5, .tau_slip = 0.02, .tau_heal = 0.1};
inline constexpr engine::Slew kStudySlew{.speed = 0.2, .radius = 0.003};

/// Spans end to end, both ends open.
inline std::shared_ptr<const engine::Outline> open_outline(
    std::vector<engine::RationalBezier<2>> spans) {
    return std::make_shared<const engine::Outline>(std::move(spans), false);
}

/// Straight edges from corner to corner; closed: and from the last to the first.
inline std::shared_ptr<const engine::Outline> polyline(const std::vector<engine::Vec2>& corners,
                                                       bool closed = false) {
    std::vector<engine::RationalBezier<2>> edges;
    for (std::size_t i = 0; i + (closed ? 0 : 1) < corners.size(); ++i) {
        edges.push_back(engine::make_line(corners[i], corners[(i + 1) % corners.size()]));
    }
    return std::make_shared<const engine::Outline>(std::move(edges), closed);
}

}  // namespace palpate::tests

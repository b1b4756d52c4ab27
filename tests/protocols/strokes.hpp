#pragma once

#include "engine/realtime/tick_record.hpp"
#include "tests/support/arc_oracle.hpp"
#include "tests/support/random.hpp"

/// Ticks of a hand that strokes a two-curve object, made from circles by trigonometry: no engine
/// code renders them.
namespace palpate::tests {

struct StrokeSpec {
    double curvature = 0.0;   ///< 1/m
    double depth = 0.0005;    ///< m, how deep the hand presses
    double stiffness = 1000;  ///< N/m
    double mu = 0.0;          ///< the contact slides, at this coefficient
    int passes = 4;           ///< up and down, on each curve
    double speed = 0.08;      ///< m/s
    double tremor = 0.0;      ///< m, uniform, on the depth
};

inline std::vector<engine::TickRecord> strokes(const StrokeSpec& spec, std::uint64_t seed = 1) {
    Random random(seed);
    const Vec2 a{-0.040, 0.0};
    const Vec2 vertex{0.0, 0.040};
    const Vec2 b{0.040, 0.0};
    std::vector<engine::TickRecord> ticks;
    for (const ArcOracle& arc :
         {ArcOracle{a, vertex, spec.curvature}, ArcOracle{vertex, b, spec.curvature}}) {
        const double chord = glm::length(arc.to - arc.from);
        const Vec2 along = (arc.to - arc.from) / chord;
        const auto n = static_cast<int>(chord / (spec.speed * 1e-3));
        for (int pass = 0; pass < spec.passes; ++pass) {
            const double direction = pass % 2 == 0 ? 1.0 : -1.0;
            for (int i = 1; i < n; ++i) {
                const double share = static_cast<double>(i) / n;
                const Vec2 at = arc.from + chord * (direction > 0.0 ? share : 1.0 - share) * along;
                const ArcOracle::Foot foot = arc.closest(at);
                const double depth = spec.depth + spec.tremor * random.in(-1.0, 1.0);
                engine::TickRecord tick;
                tick.tick = static_cast<std::int64_t>(ticks.size());
                tick.time_ns = tick.tick * 1000000;
                tick.hip = engine::Vec3(foot.point - depth * foot.normal, 0.0);
                tick.go = engine::Vec3(foot.point, 0.0);
                const Vec2 tangent{foot.normal.y, -foot.normal.x};
                tick.normal_force = spec.stiffness * depth;
                tick.tangential_force = -direction * spec.mu * tick.normal_force;
                tick.force = engine::Vec3(
                    tick.normal_force * foot.normal + tick.tangential_force * tangent, 0.0);
                tick.command = tick.force;
                tick.mode = engine::Mode::slip;
                ticks.push_back(tick);
            }
        }
    }
    return ticks;
}

}  // namespace palpate::tests

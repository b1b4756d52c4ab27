#pragma once

#include <cmath>

#include "tests/figures/thesis/curve_tracker.hpp"
#include "tests/support/counted_wall.hpp"

namespace palpate::tests {

/// Does the feedback tracker with this gain come back to u when it starts a little beside it?
inline bool settles(const engine::NurbsCurve<2>& curve,
                    double gain,
                    double u,
                    const engine::Vec2& hip,
                    double period) {
    constexpr double kBeside = 1e-7;
    const figures::CurveTracker tracker(curve,
                                        {.kind = figures::TrackerKind::feedback, .gain = gain});
    figures::TrackerState state = tracker.start_at(u + kBeside);
    for (int i = 0; i < 6000; ++i) {
        tracker.step(state, hip, period);
        if (std::fabs(state.u - u) > 100.0 * kBeside) {
            return false;
        }
    }
    return std::fabs(state.u - u) < kBeside;
}

/// The largest gain at which the feedback tracker settles on the foot u of a resting HIP, found by
/// bisection without the formula, over the formula figures::critical_gain. NaN if neither half of
/// the formula is stable nor its double unstable.
inline double stability_limit_ratio(const engine::NurbsCurve<2>& curve,
                                    double u,
                                    const engine::Vec2& hip,
                                    double period) {
    const double formula = figures::critical_gain(curve, u, hip, period);
    return stability_limit(0.5 * formula, 2.0 * formula, 13,
                           [&](double gain) { return settles(curve, gain, u, hip, period); }) /
           formula;
}

}  // namespace palpate::tests

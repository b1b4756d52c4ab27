#include "engine/commissioning/handle_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/commissioning/nearest_numbers.hpp"
#include "engine/device/dry_friction.hpp"

namespace palpate::engine {
namespace {

constexpr int kSubSteps = 4;
constexpr std::size_t kEvery = 4;  ///< ticks between two that are compared

/// Inertia 1, 2, mass, damping 1, 2, friction 1, 2, ratio.
using Numbers = LeastSquares::Row;

constexpr Numbers kLeast{1e-6, 1e-6, 1e-3, 0.0, 0.0, 0.0, 0.0, 0.05};
constexpr Numbers kMost{1e-1, 1e-1, 5.0, 10.0, 10.0, 10.0, 10.0, 20.0};
/// What a step of the differences is, where a number is near 0.
constexpr Numbers kSmall{1e-6, 1e-6, 1e-3, 1e-4, 1e-4, 3e-5, 3e-5, 1e-2};

Numbers numbers_of(const FittedHandle& handle) {
    const HandleDynamics& d = handle.dynamics;
    Numbers all{d.inertia.x, d.inertia.y,  d.handle_mass, d.damping.x,
                d.damping.y, d.friction.x, d.friction.y,  handle.ratio};
    for (std::size_t i = 0; i < all.size(); ++i) {
        all[i] = std::clamp(all[i], kLeast[i], kMost[i]);
    }
    return all;
}

FittedHandle handle_of(const Numbers& x) {
    return {.dynamics = {.handle_mass = x[2],
                         .inertia = {x[0], x[1]},
                         .damping = {x[3], x[4]},
                         .friction = {x[5], x[6]}},
            .ratio = x[7]};
}

/// (I + m J^T J) v' = tau - B v - f sgn v from rest, damping and friction taken implicitly; J is that
/// of the measured way. Appends the counts of both joints at every kEvery-th tick.
void predict(const Track& track, const Numbers& x, std::vector<double>& counts) {
    const double h = track.period / kSubSteps;
    Vec2 rate{};
    Vec2 turned{};
    for (std::size_t k = 0; k < track.steps.size(); ++k) {
        const Track::Step& step = track.steps[k];
        const Vec2 m1 = x[2] * step.carry_1 + Vec2{x[0], 0.0};
        const Vec2 m2 = x[2] * step.carry_2 + Vec2{0.0, x[1]};
        const Vec2 a1 = m1 + Vec2{0.5 * h * x[3], 0.0};
        const Vec2 a2 = m2 + Vec2{0.0, 0.5 * h * x[4]};
        const Vec2 torque = step.torque * Vec2{1.0, x[7]};
        for (int i = 0; i < kSubSteps; ++i) {
            const Vec2 right{glm::dot(m1, rate) - 0.5 * h * x[3] * rate.x + h * torque.x,
                             glm::dot(m2, rate) - 0.5 * h * x[4] * rate.y + h * torque.y};
            const Vec2 after = after_dry_friction(a1, a2, right, {h * x[5], h * x[6]}, rate);
            turned += 0.5 * h * (rate + after);
            rate = after;
        }
        if (k % kEvery == 0) {
            counts.push_back(turned.x / track.per_count.x);
            counts.push_back(turned.y / track.per_count.y);
        }
    }
}

}  // namespace

Track track_of(
    const Pantograph& machine, const Pulse& pulse, bool swapped, const Vec2& sign, double delay) {
    Track track;
    const auto& samples = pulse.samples;
    const auto start = samples.front().counts;
    track.per_count = {machine.spec().axes[0].count_angle(), machine.spec().axes[1].count_angle()};
    track.period = samples.size() > 1 ? samples[1].time - samples[0].time : 1e-3;
    for (std::size_t k = 1; k < samples.size(); ++k) {
        const Vec2 asked(acting_torque(samples, k, delay));
        const auto fix = machine.locate(machine.angles(samples[k].joints()));
        if (!fix) {
            break;
        }
        const Jacobian& j = fix->jacobian;
        const Vec2 c1 = j.column_1();
        const Vec2 c2 = j.column_2();
        track.steps.push_back({.torque = sign * (swapped ? Vec2{asked.y, asked.x} : asked),
                               .turned = {static_cast<double>(samples[k].counts[0] - start[0]),
                                          static_cast<double>(samples[k].counts[1] - start[1])},
                               .carry_1 = {glm::dot(c1, c1), glm::dot(c1, c2)},
                               .carry_2 = {glm::dot(c1, c2), glm::dot(c2, c2)},
                               .fresh = samples[k].fresh});
    }
    return track;
}

FittedHandle fit_handle(std::span<const Track> tracks, const FittedHandle& start, bool free_ratio) {
    std::vector<double> measured;
    for (const Track& track : tracks) {
        for (std::size_t k = 0; k < track.steps.size(); k += kEvery) {
            const Track::Step& step = track.steps[k];
            measured.push_back(step.fresh ? step.turned.x : kUnknown);
            measured.push_back(step.fresh ? step.turned.y : kUnknown);
        }
    }
    const auto predicted = [&](const Numbers& x) {
        std::vector<double> counts;
        for (const Track& track : tracks) {
            predict(track, x, counts);
        }
        return counts;
    };
    return handle_of(nearest_numbers(predicted, measured, numbers_of(start),
                                     {kLeast, kMost, kSmall}, free_ratio ? 8 : 7));
}

}  // namespace palpate::engine

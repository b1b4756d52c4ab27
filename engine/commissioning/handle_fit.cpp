#include "engine/commissioning/handle_fit.hpp"

#include <algorithm>
#include <cmath>

#include "engine/commissioning/nearest_numbers.hpp"
#include "engine/device/dry_friction.hpp"

namespace palpate::engine {
namespace {

constexpr int kSubSteps = 2;
constexpr std::size_t kEvery = 4;  ///< ticks between two that are compared

/// Inertia 1, 2, mass, damping 1, 2, friction 1, 2, damping and friction of the handle, ratio,
/// lateness.
using Numbers = LeastSquares::Row;

constexpr Numbers kMin{1e-6, 1e-6, 1e-3, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.05, 0.0};
constexpr Numbers kMax{1e-1, 1e-1, 5.0, 10.0, 10.0, 10.0, 10.0, 100.0, 10.0, 20.0, kLatest};
/// What a step of the differences is, where a number is near 0.
constexpr Numbers kSmall{1e-6, 1e-6, 1e-3, 1e-4, 1e-4, 3e-5, 3e-5, 1e-2, 1e-3, 1e-2, 1e-3};

Numbers numbers_of(const FittedHandle& handle) {
    const HandleDynamics& d = handle.dynamics;
    Numbers all{d.inertia.x,       d.inertia.y,  d.handle_mass, d.damping.x,
                d.damping.y,       d.friction.x, d.friction.y,  d.handle_damping,
                d.handle_friction, handle.ratio, handle.late};
    for (std::size_t i = 0; i < all.size(); ++i) {
        all[i] = std::clamp(all[i], kMin[i], kMax[i]);
    }
    return all;
}

FittedHandle handle_of(const Numbers& x) {
    return {.dynamics = {.handle_mass = x[2],
                         .inertia = {x[0], x[1]},
                         .damping = {x[3], x[4]},
                         .friction = {x[5], x[6]},
                         .handle_damping = x[7],
                         .handle_friction = x[8]},
            .ratio = x[9],
            .late = x[10]};
}

/// (I + m J^T J) v' = tau - (B + b J^T J + m J^T C(v)) v - f sgn v - g J^T w / |w|, w = J v, from
/// rest, damping and friction taken implicitly; J and C are those of the measured way. Without C,
/// which says how J changes, the mass comes out a tenth too low. Appends the counts of both joints
/// at every kEvery-th tick.
void predict(const Track& track, const Numbers& x, std::vector<double>& counts) {
    const double h = track.period / kSubSteps;
    Vec2 rate{};
    Vec2 turned{};
    for (std::size_t k = 0; k < track.steps.size(); ++k) {
        const Track::Step& step = track.steps[k];
        const Vec2 m1 = x[2] * step.carry_1 + Vec2{x[0], 0.0};
        const Vec2 m2 = x[2] * step.carry_2 + Vec2{0.0, x[1]};
        const Vec2 b1 = 0.5 * h * (x[7] * step.carry_1 + Vec2{x[3], 0.0});
        const Vec2 b2 = 0.5 * h * (x[7] * step.carry_2 + Vec2{0.0, x[4]});
        const Vec2 torque = step.torque * Vec2{1.0, x[9]};
        const StepFriction friction{{h * x[5], h * x[6]}, h * x[8], step.carry_1, step.carry_2};
        for (int i = 0; i < kSubSteps; ++i) {
            const Vec2 right{glm::dot(m1 - b1, rate) + h * torque.x,
                             glm::dot(m2 - b2, rate) + h * torque.y};
            const Vec2 c1 = h * x[2] * (rate.x * step.drift_1[0] + rate.y * step.drift_2[0]);
            const Vec2 c2 = h * x[2] * (rate.x * step.drift_1[1] + rate.y * step.drift_2[1]);
            const Vec2 after =
                after_dry_friction(m1 + b1 + c1, m2 + b2 + c2, right, friction, rate);
            turned += 0.5 * h * (rate + after);
            rate = after;
        }
        if (k % kEvery == 0) {
            counts.push_back(turned.x / track.per_count.x);
            counts.push_back(turned.y / track.per_count.y);
        }
    }
}

/// Counts of both joints at the ticks that are compared.
std::vector<double> counted(std::span<const Track> tracks) {
    std::vector<double> measured;
    for (const Track& track : tracks) {
        for (std::size_t k = 0; k < track.steps.size(); k += kEvery) {
            const Track::Step& step = track.steps[k];
            measured.push_back(step.fresh ? step.turned.x : kUnknown);
            measured.push_back(step.fresh ? step.turned.y : kUnknown);
        }
    }
    return measured;
}

std::vector<double> predicted(std::span<const Track> tracks, const Numbers& x) {
    std::vector<double> counts;
    for (const Track& track : tracks) {
        const std::size_t before = counts.size();
        predict(track, x, counts);
        see_late(std::span(counts).subspan(before), 2, x[10] / (kEvery * track.period));
    }
    return counts;
}

/// Of the pulse that the numbers explain worst, so that one which somebody held is not lost among
/// many.
double unexplained(std::span<const Track> tracks, const Numbers& x) {
    double worst = 0.0;
    for (const Track& track : tracks) {
        worst = std::fmax(worst, left_over(counted({&track, 1}), predicted({&track, 1}, x), 1.0));
    }
    return worst;
}

/// Gains of both motors, friction and lateness, as numbers of a handle: a motion does not change if
/// torques and all that withstands them become as much stronger.
Numbers changed(const HandleDynamics& before, const Numbers& by) {
    Numbers x = numbers_of({.dynamics = before});
    for (std::size_t i = 0; i < 9; ++i) {
        x[i] *= (i < 3 ? 1.0 : by[2]) / by[0];
    }
    x[9] = by[1] / by[0];
    x[10] = by[3];
    return x;
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
        const auto before = machine.angles(samples[k - 1].counts);
        const auto after = machine.angles(samples[k].counts);
        const FiveBar& linkage = machine.spec().linkage;
        const auto pose =
            linkage.forward({0.5 * (before[0] + after[0]), 0.5 * (before[1] + after[1])});
        const auto jacobian = pose ? linkage.jacobian(*pose) : std::nullopt;
        if (!jacobian) {
            break;
        }
        const auto rows = [&](const Jacobian& a) {  // of J^T A
            const Vec2 c1 = jacobian->transposed(a.column_1());
            const Vec2 c2 = jacobian->transposed(a.column_2());
            return std::array<Vec2, 2>{Vec2{c1.x, c2.x}, Vec2{c1.y, c2.y}};
        };
        const std::array<Vec2, 2> carry = rows(*jacobian);
        track.steps.push_back({.torque = sign * (swapped ? Vec2{asked.y, asked.x} : asked),
                               .turned = {static_cast<double>(samples[k].counts[0] - start[0]),
                                          static_cast<double>(samples[k].counts[1] - start[1])},
                               .carry_1 = carry[0],
                               .carry_2 = carry[1],
                               .drift_1 = rows(linkage.drift(*pose, *jacobian, {1.0, 0.0})),
                               .drift_2 = rows(linkage.drift(*pose, *jacobian, {0.0, 1.0})),
                               .fresh = samples[k].fresh});
    }
    return track;
}

FittedHandle fit_handle(std::span<const Track> tracks,
                        const FittedHandle& start,
                        Unknowns unknowns) {
    const Numbers found = nearest_numbers([&](const Numbers& x) { return predicted(tracks, x); },
                                          counted(tracks), numbers_of(start), {kMin, kMax, kSmall},
                                          static_cast<std::size_t>(unknowns));
    FittedHandle handle = handle_of(found);
    handle.unexplained = unexplained(tracks, found);
    return handle;
}

HandleChange fit_change(std::span<const Track> tracks, const HandleDynamics& before) {
    const auto moved = [&](const Numbers& by) {
        return predicted(tracks, changed(before, by));
    };
    const Numbers found = nearest_numbers(moved, counted(tracks), {1.0, 1.0, 1.0, 0.0},
                                          {.least = {0.02, 0.02, 0.0, 0.0},
                                           .max = {10.0, 10.0, 10.0, kLatest},
                                           .small = {1e-2, 1e-2, 1e-2, 1e-3}},
                                          4);
    return {.gain = {found[0], found[1]},
            .friction = found[2],
            .late = found[3],
            .unexplained = unexplained(tracks, changed(before, found))};
}

}  // namespace palpate::engine

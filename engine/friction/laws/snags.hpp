#pragma once

#include <algorithm>
#include <cmath>

#include "engine/friction/laws/law_task.hpp"

namespace palpate::engine {

/// The snag that was passed last on the way from one place to another: one lies in each stretch of
/// `spacing`, at a random place of it. @return how far beyond it `to` lies, m; < 0: there was none
[[nodiscard]] inline double beyond_snag(double from,
                                        double to,
                                        double spacing,
                                        std::uint64_t seed) noexcept {
    const double low = std::min(from, to);
    const double high = std::max(from, to);
    const double cell = std::floor(to / spacing);
    if (!(std::fabs(cell) < 0x1p53)) {  // closer than doubles can count: one lies at every place
        return from == to ? -1.0 : 0.0;
    }
    double nearest = -1.0;
    for (int step = -1; step <= 1; ++step) {
        const double one = cell + step;
        const auto number = static_cast<std::uint64_t>(static_cast<std::int64_t>(one));
        const double at = (one + uniform(seed, number)) * spacing;
        const double beyond = std::fabs(to - at);
        if (at > low && at <= high && (nearest < 0.0 || beyond < nearest)) {
            nearest = beyond;
        }
    }
    return nearest;
}

/// Snags in the surface (Mark, Randolph, Finch, Van Verth & Taylor, "Adding force feedback to
/// graphics systems: issues and solutions", SIGGRAPH 1996; thesis 1.4.2):
///
///     in a snag:  F = -k (x - c)             until |F| > mu_s F_N
///     elsewhere:  F = -mu_d F_N sgn(v)
///
/// Centres c lie along the outline, one at a random place of every `snag_spacing`, by `seed`; they
/// stay where they are, and so are a texture. A snag catches whoever passes its centre, k is
/// `stiffness`. In the cone. Between the snags it is coulomb_sign, holds nothing at rest and
/// chatters, and is not passive; the snags by themselves are.
[[nodiscard]] inline FrictionForce snags(const LawTask& law,
                                         LawState& state,
                                         const Rub& rub) noexcept {
    const double from = state.placed ? state.place : rub.place;
    state.place = rub.place;
    state.placed = true;
    if (state.sliding) {  // over the outline's beginning the place jumps: no way leads there
        const bool jumped = std::fabs(rub.place - from) > 4.0 * std::fabs(rub.travel) + 1e-6;
        const double beyond =
            jumped ? -1.0 : beyond_snag(from, rub.place, law.spec.snag_spacing, law.spec.seed);
        if (beyond >= 0.0) {
            state.sliding = false;
            state.stretch = sign_of(rub.travel) * std::min(beyond, std::fabs(rub.travel));
        }
    } else if (state.way == 0.0) {  // the contact begins between the snags
        state.way = 1.0;
        state.sliding = true;
    } else {
        state.stretch += rub.travel;
    }
    if (!state.sliding) {
        const double force = -law.stiffness * state.stretch;
        if (std::fabs(force) <= law.mu_s * rub.load) {
            return {.force = force, .mu = law.mu_s, .slid = false};
        }
        state.sliding = true;
    }
    return {.force = -law.mu_d * rub.load * sign_of(rub.travel),
            .mu = law.mu_d,
            .slid = rub.travel != 0.0};
}

inline constexpr LawTraits kSnags{.word = "snags",
                                  .paper = "Mark et al. 1996",
                                  .step = snags,
                                  .reads = {"tangential_stiffness", "snag_spacing", "law_seed"},
                                  .sticks = true,
                                  .by_place = true,
                                  .in_cone = true,
                                  .chatters = true};

}  // namespace palpate::engine

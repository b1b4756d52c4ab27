#pragma once

#include <algorithm>
#include <cmath>

#include "engine/friction/laws/law_task.hpp"

namespace palpate::engine {

/// Bonds that snap and form anew (Haessig & Friedland, "On the modeling and simulation of
/// friction", J. Dyn. Sys. Meas. Control 113, 1991; thesis eq. 1.5):
///
///     F = -sum sigma (x - b_i),    |x - b_i| <= reach = mu_s F_N / (n sigma)
///
/// n is `bristles`, n sigma `stiffness`. A bond stretched beyond its reach snaps, and a new one
/// forms where its stretch is a random share of the reach, uniform in [3 mu_d / mu_s - 2, 1]:
/// carried on from there, bonds that slide along pull by mu_d F_N in the mean. All first bonds are
/// formed where the contact begins, so that they first break away together, at mu_s F_N. Random
/// numbers are those of `seed`, by their number in this trial.
///
/// In the cone and passive (n sigma <= K): a new bond is never stretched more than the one that
/// snapped. Needs mu_d >= mu_s / 3; costs a tick by every bristle; ripples by chance, by a share of
/// 1 / sqrt n.
[[nodiscard]] inline FrictionForce bristle(const LawTask& law,
                                           LawState& state,
                                           const Rub& rub) noexcept {
    const double reach = law.mu_s * rub.load / law.stiffness;
    const double lowest = law.mu_s > 0.0 ? 3.0 * law.mu_d / law.mu_s - 2.0 : 1.0;
    const double max_over = std::fabs(rub.travel);
    double sum = 0.0;
    bool snapped = false;
    for (int i = 0; i < law.spec.bristles; ++i) {
        double& stretch = state.bristles[static_cast<std::size_t>(i)];
        stretch += rub.travel;
        const double way = sign_of(stretch);
        // What of the travel came after the bond snapped stretches the new one.
        double over = std::min(std::fabs(stretch) - reach, max_over);
        for (int again = 0; over > 0.0 && again < 16; ++again) {
            snapped = true;
            const double share = lowest + (1.0 - lowest) * uniform(law.spec.seed, state.draws++);
            stretch = way * (share * reach + over);
            over = way * stretch - reach;
        }
        stretch = std::clamp(stretch, -reach, reach);
        sum += stretch;
    }
    return {.force = -law.stiffness / law.spec.bristles * sum,
            .mu = snapped ? law.mu_d : law.mu_s,
            .slid = snapped};
}

inline constexpr LawTraits kBristle{.word = "bristle",
                                    .paper = "Haessig & Friedland 1991",
                                    .step = bristle,
                                    .reads = {"tangential_stiffness", "bristles", "law_seed"},
                                    .sticks = true,
                                    .max_mu_s = 3,
                                    .passive = true,
                                    .in_cone = true};

}  // namespace palpate::engine

#pragma once

#include <cmath>

#include "engine/friction/laws/stuck_spring.hpp"

namespace palpate::engine {

/// Karnopp's law (Karnopp, "Computer simulation of stick-slip friction in mechanical dynamic
/// systems", J. Dyn. Sys. Meas. Control 107, 1985; thesis figure 1.4.2):
///
///     |v| < DV:  stuck, holds up to mu_s F_N                  (a spring k: stuck_spring)
///     else:      F = -mu_d F_N sgn(v)
///
/// DV is `stick_speed`. A velocity that changed its sign was within DV in between. How it feels
/// depends on DV, and on the rate: v = dx / T of an encoder's count q jumps by q / T, 10 mm/s for
/// 10 um at 1 kHz, which DV has to exceed or it chatters.
[[nodiscard]] inline FrictionForce karnopp(const LawTask& law,
                                           LawState& state,
                                           const Rub& rub) noexcept {
    const bool slow = std::fabs(rub.travel) < law.spec.stick_speed * law.period;
    return stuck_spring(law, state, rub, slow || sign_of(rub.travel) != state.way);
}

inline constexpr LawTraits kKarnopp{.word = "karnopp",
                                    .paper = "Karnopp 1985",
                                    .step = karnopp,
                                    .reads = {"tangential_stiffness", "stick_speed"},
                                    .sticks = true,
                                    .in_cone = true,
                                    .chatters = true};

}  // namespace palpate::engine

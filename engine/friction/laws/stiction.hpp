#pragma once

#include "engine/friction/laws/stuck_spring.hpp"

namespace palpate::engine {

/// Stiction (thesis eq. 1.2, figure 1.4.1 c):
///
///     v = 0:   F holds against the hand up to mu_s F_N        (a spring k: stuck_spring)
///     v != 0:  F = -mu_d F_N sgn(v)
///
/// "v = 0" is meant literally: a tick without travel, or a change of sign. So with an encoder that
/// counts once in several ticks it sticks and breaks away again, a chatter of (mu_s - mu_d) F_N.
[[nodiscard]] inline FrictionForce stiction(const LawTask& law,
                                            LawState& state,
                                            const Rub& rub) noexcept {
    return stuck_spring(law, state, rub, sign_of(rub.travel) != state.way);
}

inline constexpr LawTraits kStiction{.word = "stiction",
                                     .paper = "Morin 1833",
                                     .step = stiction,
                                     .reads = {"tangential_stiffness"},
                                     .sticks = true,
                                     .in_cone = true,
                                     .chatters = true};

}  // namespace palpate::engine

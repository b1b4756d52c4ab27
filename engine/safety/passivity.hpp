#pragma once

#include <cmath>

namespace palpate::engine {

/// The damping b that a device needs so that a held, sampled contact gives it no energy, N s/m.
///
///     b >= K T (1/2 + d) + |B|          Colgate & Schenkel 1997, thesis (1.1); with d ticks of
///     delay
///
/// @param stiffness  K, N/m   @param period  T, s   @param delay_ticks  d, beyond the hold, >= 0
/// @param damping    B of the contact, N s/m
[[nodiscard]] inline double min_damping(double stiffness,
                                        double period,
                                        double delay_ticks,
                                        double damping = 0.0) noexcept {
    return stiffness * period * (0.5 + delay_ticks) + std::fabs(damping);
}

}  // namespace palpate::engine

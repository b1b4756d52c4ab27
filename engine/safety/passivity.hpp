#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

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

/// By how many ticks the delay may grow until min_damping() is all that the device damps: below 0
/// it does not damp enough as it is.
/// @param stiffness  K, N/m, > 0   @param device  b of the device, N s/m   Others as there.
[[nodiscard]] inline double spare_delay(
    double stiffness, double period, double delay_ticks, double damping, double device) noexcept {
    return (device - min_damping(stiffness, period, delay_ticks, damping)) / (stiffness * period);
}

/// The dry friction that a device needs so that a contact comes to rest although positions are read
/// in steps, N.
///
///     f >= (K + 2 |B| / T) e            Abbott & Okamura 2005 for B = 0: K <= 2 f / step
///
/// Over one tick the held force K (x + e_k) gives the handle at most K T/2 int v^2 + K e int |v|
/// beyond what its spring had stored; damping takes b int v^2 of it, dry friction f int |v|. With b
/// >= min_damping() and this f no motion can last. Less may do, as the place of rest lies in a
/// step; for the worst place the simulated machine needs 0.92 to 0.98 of it (`palpate bench
/// passivity`).
///
/// @param error  e, the most that a reading lies off the handle, m: half a step
[[nodiscard]] inline double resting_friction(double stiffness,
                                             double period,
                                             double error,
                                             double damping = 0.0) noexcept {
    return (stiffness + 2.0 * std::fabs(damping) / period) * error;
}

/// The fastest that a contact may creep on for ever, m/s, root mean square; 0: it comes to rest.
///
///     v <= (resting friction - f) / (b - min_damping)
///
/// Since a motion that lasts neither gains nor loses: (b - min_damping) mean(v^2) <= (resting
/// friction - f) mean |v|. The simulated machine creeps at 0.005 to 0.16 of it.
///
/// @param friction  f, dry friction of the device at the handle, N, >= 0
/// @param spare     b - min_damping, N s/m; infinity for <= 0
[[nodiscard]] inline double creep_limit(double resting, double friction, double spare) noexcept {
    const double push = std::max(resting - friction, 0.0);
    return push == 0.0 ? 0.0 : spare > 0.0 ? push / spare : std::numeric_limits<double>::infinity();
}

}  // namespace palpate::engine

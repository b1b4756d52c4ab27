#pragma once

#include <array>
#include <cstddef>

#include "engine/geometry/vec.hpp"
#include "engine/safety/safety_limits.hpp"

namespace palpate::engine {

/// What the rendering gave beyond what it took. A plain value.
struct EnergyObserver {
    static constexpr std::size_t kForces = 16;  ///< ticks of delay that can be given, and the last

    double energy = 0.0;  ///< E, J, >= 0
    double stored = 0.0;  ///< in the contact at the last tick, J, at full gain
    Vec3 hip{};           ///< of the last tick, m
    bool started = false;
    std::array<Vec3, kForces> forces{};  ///< commanded, N
    std::size_t commands = 0;
};

/// Energy stored in a contact whose force K x is cut at `max_force`, J: K x^2 / 2, beyond the cut F
/// x - F^2 / 2K with F = max_force. Its gradient is the cut force, and that is what makes the sum
/// below close.
/// @param length  x, m, >= 0
[[nodiscard]] double stored_energy(double length, double stiffness, double max_force) noexcept;

/// One reading on. Over the tick before, the device held the force of d ticks earlier:
///
///     A = F[n-1-d] . (h[n] - h[n-1]) + g (S[n] - S[n-1])       given to the user and put in store,
///     J
///     E = max(0, E + A - b |h[n] - h[n-1]|^2 / t)              b takes at least this out in the
///     time t
///
/// S is the energy of the contact and g the gain of the ramp; the work of the ramp itself, (g[n] -
/// g[n-1]) S[n], is asked for by the experimenter and left out. A sampled spring gives A = K |dh|^2
/// / 2 and less with friction (engine/rendering/energy_ledger.hpp), cut or not, so E stays 0 just
/// when b >= K T / 2: Colgate's bound; with delay b >= K T (1/2 + d). Whoever has less was warned
/// before the first trial, and b counts as that least damping: what raises E then is no spring. It
/// follows the motion, or rests on readings that are old or wrong, or has the wrong sign. What it
/// cannot see is a device that acts later than it says: commands and readings then look like a
/// spring. The speed limit is what is left.
///
/// @param hip     m, finite     @param spring  GO - HIP, m; 0 out of contact
/// @param gain    g of the last tick     @param since  s from the last fresh reading, >= T
/// @return E after this tick, J; NaN once any of it was not a number
double observe_energy(EnergyObserver& observer,
                      const SafetyLimits& limits,
                      const Vec3& hip,
                      const Vec3& spring,
                      double gain,
                      double since) noexcept;

/// What was commanded in this tick: acts from here on, or `delay_ticks` later.
void note_command(EnergyObserver& observer, const Vec3& force) noexcept;

}  // namespace palpate::engine

#include "engine/safety/energy_observer.hpp"

#include <algorithm>
#include <cmath>

#include "engine/safety/passivity.hpp"

namespace palpate::engine {
namespace {

/// The force commanded `back` ticks before the last one; 0 before the first.
Vec3 command_before(const EnergyObserver& observer, std::size_t back) noexcept {
    return back < observer.commands
             ? observer.forces[(observer.commands - 1 - back) % EnergyObserver::kForces]
             : Vec3{};
}

/// The mean force that acted over the last tick, for a delay of whole ticks and a part.
Vec3 acting(const EnergyObserver& observer, double delay_ticks) noexcept {
    const double delay = std::clamp(delay_ticks, 0.0, EnergyObserver::kForces - 2.0);
    const double whole = std::floor(delay);
    const double part = delay - whole;
    const auto back = static_cast<std::size_t>(whole);
    return (1.0 - part) * command_before(observer, back) +
           part * command_before(observer, back + 1);
}

}  // namespace

double stored_energy(double length, double stiffness, double max_force) noexcept {
    const double force = stiffness * length;
    return force <= max_force ? 0.5 * force * length
                              : max_force * (length - 0.5 * max_force / stiffness);
}

double observe_energy(EnergyObserver& observer,
                      const SafetyLimits& limits,
                      const Vec3& hip,
                      const Vec3& spring,
                      double gain,
                      double since) noexcept {
    const double stored = stored_energy(glm::length(spring), limits.stiffness, limits.max_force);
    if (observer.started) {
        const Vec3 step = hip - observer.hip;
        const double given = glm::dot(acting(observer, limits.delay_ticks), step) +
                             gain * (stored - observer.stored);
        const double needed = min_damping(limits.stiffness, limits.period, limits.delay_ticks);
        const double taken = std::max(limits.damping, needed) * glm::dot(step, step) / since;
        const double energy = observer.energy + given - taken;
        observer.energy = energy <= 0.0 ? 0.0 : energy;  // keeps a NaN
    }
    observer.stored = stored;
    observer.hip = hip;
    observer.started = true;
    return observer.energy;
}

void note_command(EnergyObserver& observer, const Vec3& force) noexcept {
    observer.forces[observer.commands++ % EnergyObserver::kForces] = force;
}

}  // namespace palpate::engine

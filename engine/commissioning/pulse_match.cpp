#include "engine/commissioning/pulse_match.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/text.hpp"
#include "engine/commissioning/straight_axes.hpp"
#include "engine/device/machine.hpp"
#include "engine/device/simulated_pantograph.hpp"

namespace palpate::engine {
namespace {

constexpr double kDegree = 180.0 / kPi;
constexpr double kMinShare = 0.4;  ///< of a push at once: a change of friction is not enough for it
constexpr double kMaxShare = 2.0;

std::string percent(double share) {
    return number_text(std::round(100.0 * share)) + " %";
}

PantographPlant free_handle(const PantographSpec& spec, const HandleDynamics& dynamics) {
    return PantographPlant({.machine = spec,
                            .inertia = dynamics.inertia,
                            .damping = dynamics.damping,
                            .coulomb = dynamics.friction,
                            .current_time = 0.0,
                            .handle_mass = dynamics.handle_mass,
                            .handle_damping = dynamics.handle_damping,
                            .handle_friction = dynamics.handle_friction,
                            .hand = kNobody});
}

std::string pushed_text(const Pulse& pulse, std::size_t axes) {
    const Vec3& f = pulse.force;
    const std::string way = f.x > 0.0 ? "to the right"
                          : f.x < 0.0 ? "to the left"
                          : f.y > 0.0 ? "away"
                          : f.y < 0.0 ? "near"
                          : f.z > 0.0 ? "up"
                                      : "down";
    const auto mm = [](double metres) {
        return number_text(std::round(metres * 1e3) + 0.0);
    };
    return "pushed " + way + " at (" + mm(pulse.place.x) + ", " + mm(pulse.place.y) +
           (axes > 2 ? ", " + mm(pulse.place.z) : std::string()) + ") mm the handle ";
}

/// The torques of a pulse up to sample `last`, each as late as the device.
void push_plant(PantographPlant& plant, const Pulse& pulse, std::size_t last, double delay) {
    const auto& samples = pulse.samples;
    std::size_t next = 0;
    double now = 0.0;
    while (now < samples[last].time) {
        const double change = next < last ? samples[next].time + delay : samples[last].time;
        const double until = std::fmin(change, samples[last].time);
        plant.advance(until - now);
        now = until;
        if (next < last) {
            plant.set_torque(Vec2(samples[next++].torque));
        }
    }
}

/// @param expected, measured  in one unit   @param counts  between them
PulseMatch compared(const Vec3& expected, const Vec3& measured, double counts) {
    const double length = glm::length(expected);
    if (!(length > 0.0)) {
        return {.share = 0.0, .angle = kPi, .counts = counts};
    }
    return {.share = glm::length(measured) / length,
            .angle =
                arc_tan2(glm::length(glm::cross(expected, measured)), glm::dot(expected, measured)),
            .counts = counts};
}

PulseMatch match_linkage(const PantographSpec& spec,
                         const Pulse& pulse,
                         const HandleDynamics& dynamics,
                         double delay) {
    const Pantograph machine(spec);
    const auto& samples = pulse.samples;
    const std::size_t last = std::min(pulse.turn, samples.size() - 1);
    const auto start = machine.angles(samples.front().counts);
    const auto end = machine.angles(samples[last].counts);
    const auto from = machine.locate(start);
    if (!from) {
        return compared({}, {}, HUGE_VAL);
    }
    PantographPlant plant = free_handle(spec, dynamics);
    plant.begin({.start = from->hip, .tremor = 0.0});
    push_plant(plant, pulse, last, delay);
    const Vec2 expected{plant.angles()[0] - start[0], plant.angles()[1] - start[1]};
    const Vec2 measured{end[0] - start[0], end[1] - start[1]};
    return compared(Vec3(expected, 0.0), Vec3(measured, 0.0),
                    std::fmax(std::fabs(expected.x - measured.x) / spec.axes[0].count_angle(),
                              std::fabs(expected.y - measured.y) / spec.axes[1].count_angle()));
}

PulseMatch match_axes(const GantrySpec& spec,
                      const Pulse& pulse,
                      const std::array<AxisDynamics, 3>& axes,
                      double delay) {
    const Gantry gantry(spec);
    const std::size_t last = std::min(pulse.turn, pulse.samples.size() - 1);
    const Vec3 expected = predicted_way(gantry, pulse, last, axes, delay);
    const Vec3 measured = way_of(gantry, pulse, last);
    const Vec3 off = glm::abs(expected - measured) / gantry.quantum();
    return compared(expected, measured, std::fmax(off.x, std::fmax(off.y, off.z)));
}

}  // namespace

PulseMatch match(const Machine& machine,
                 const Pulse& pulse,
                 const RigRecord& record,
                 double delay) {
    const Calibration& how = machine.calibration();
    return how.gantry ? match_axes(*how.gantry, pulse, record.axes, delay)
                      : match_linkage(how.pantograph, pulse, record.dynamics, delay);
}

std::string wrong_with(const Machine& machine,
                       const Pulse& pulse,
                       const RigRecord& record,
                       double delay) {
    const std::string pushed = pushed_text(pulse, machine.axes());
    if (pulse.trip != Trip::none) {
        return pushed + "tripped the safety chain: " + std::string(explanation(pulse.trip));
    }
    const PulseMatch found = match(machine, pulse, record, delay);
    const std::string moved = pushed + "moved " + percent(found.share) + " of what it should: ";
    if (!(found.share >= kMinShare)) {
        return moved +
               "is somebody holding it, does something block it, is a motor too weak, or are "
               "its answers old";
    }
    if (!(found.angle <= kMaxTurn)) {
        return pushed + "went " + number_text(std::round(found.angle * kDegree)) +
               " degrees beside that: a motor or an encoder is reversed or swapped, a motor has "
               "become weaker, or the handle was not at home";
    }
    if (!(found.share <= kMaxShare)) {
        return moved + "a motor is too strong, or the handle is lighter than it was";
    }
    return {};
}

std::string unexplained_by(const RigRecord& record,
                           const Machine& machine,
                           std::span<const Pulse> pulses,
                           double delay) {
    for (const Pulse& pulse : pulses) {
        const PulseMatch found = match(machine, pulse, record, delay);
        if (!(std::fabs(found.share - 1.0) <= kMaxGainError && found.angle <= kMaxTurn) &&
            !(found.counts <= kMaxRounding)) {
            return unexplained_text(pushed_text(pulse, machine.axes()) + "moved " +
                                    percent(found.share) + " of what they say, " +
                                    number_text(std::round(found.angle * kDegree)) +
                                    " degrees beside it");
        }
    }
    return {};
}

}  // namespace palpate::engine

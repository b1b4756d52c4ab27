#include "engine/commissioning/commissioning.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/text.hpp"
#include "engine/device/simulated_pantograph.hpp"
#include "engine/safety/passivity.hpp"

namespace palpate::engine {
namespace {

constexpr double kLook = 0.25;                           ///< s at a mark
constexpr double kStrong = 0.3;                          ///< N, of the pulses that find numbers
constexpr std::array<double, 3> kForces{0.1, 0.2, 0.3};  ///< N, until the handle moves
constexpr std::int32_t kEnough = 12;  ///< counts that a pulse has to move an encoder
constexpr double kCertain = 0.8;      ///< share of the damping found that is relied upon
constexpr double kTick = 1e-3;        ///< s, of the stiffness that is said to be usable

std::string mm(const Vec2& place) {
    return "(" + number_text(std::round(place.x * 1e4) / 10.0) + ", " +
           number_text(std::round(place.y * 1e4) / 10.0) + ") mm";
}

std::string encoders_text(const EncoderProof& proof) {
    const std::string what =
        explained(proof.connection, "encoder", "counts twice as much as counts_per_turn says",
                  "counts half as much as counts_per_turn says");
    if (proof.fits && !what.empty()) {
        return what + ": correct the wiring or the calibration, then commission again";
    }
    return "the encoders do not say where the handle is, whatever their wiring: the nearest guess "
           "misses a mark by " +
           number_text(std::round(std::fmin(proof.missed, 1.0) * 1e4) / 10.0) +
           " mm: check the marks, the lengths of the links and counts_per_turn";
}

/// Marks in the order of the places; nothing but zero force meanwhile.
/// @return what is wrong
std::string read_marks(PulseRunner& runner,
                       const Device& device,
                       const std::vector<Vec2>& places,
                       const CommissioningDesk& desk,
                       std::vector<MarkReading>& marks,
                       bool& given_up) {
    for (const Vec2& place : places) {
        given_up = !desk.bring(place);
        if (given_up) {
            return "it was given up";
        }
        MarkReading mark = runner.watch(kLook);
        if (!std::isfinite(mark.place.x)) {
            const std::string trouble = device.trouble();
            return "the device said nothing at " + mm(place) +
                   (trouble.empty() ? "" : ": " + trouble);
        }
        if (mark.span.x > 2.0 || mark.span.y > 2.0) {
            return "the handle did not rest at " + mm(place) + ": let go of it, on a level desk";
        }
        mark.place = place;
        marks.push_back(mark);
    }
    return {};
}

/// The four directions, twice where `times` says so.
void push(PulseRunner& runner, double force, std::vector<Pulse>& pulses) {
    for (const Vec2& direction : kPulseDirections) {
        pulses.push_back(runner.give(direction, {.force = force}));
    }
}

std::string tripped(std::span<const Pulse> pulses) {
    const auto one = std::find_if(pulses.begin(), pulses.end(),
                                  [](const Pulse& pulse) { return pulse.trip != Trip::none; });
    return one == pulses.end()
             ? std::string()
             : "a pulse tripped the safety chain: " + std::string(explanation(one->trip));
}

/// The weakest force that moves the handle, and the pulses of it.
/// @return what is wrong
std::string find_force(PulseRunner& runner, double& force, std::vector<Pulse>& pulses) {
    for (const double newtons : kForces) {
        force = newtons;
        pulses.clear();
        push(runner, force, pulses);
        if (std::string what = tripped(pulses); !what.empty()) {
            return what;
        }
        if (std::all_of(pulses.begin(), pulses.end(),
                        [](const Pulse& pulse) { return moved(pulse) >= kEnough; })) {
            return {};
        }
    }
    return "0.3 N do not move the handle: is it free, are the motors connected and switched on, is "
           "a switch pressed";
}

std::string motors_text(const Connection& connection, const std::array<double, 2>& gain) {
    std::string text = explained(connection, "motor", "is too strong", "is too weak");
    for (std::size_t i = 0; i < 2; ++i) {
        if (!(std::fabs(std::fabs(gain[i]) - 1.0) <= kMostGainError)) {
            text += (text.empty() ? "" : ", ") + std::string("motor ") + std::to_string(i + 1) +
                    " gives " + number_text(std::round(100.0 * std::fabs(gain[i])) / 100.0) +
                    " times what it should";
        }
    }
    return text;
}

double least_friction(const Pantograph& machine,
                      const std::vector<Vec2>& places,
                      const HandleDynamics& dynamics) {
    double least = 1e9;
    for (const Vec2& place : places) {
        const auto fix = machine.locate(*machine.reach(place));
        least = std::fmin(least, dynamics.friction.x / glm::length(fix->jacobian.column_1()));
        least = std::fmin(least, dynamics.friction.y / glm::length(fix->jacobian.column_2()));
    }
    return least;
}

void fill_record(RigRecord& record,
                 const Device& device,
                 const PantographSpec& spec,
                 const std::vector<Vec2>& places,
                 const HandleDynamics& dynamics) {
    const DeviceTraits traits = device.traits();
    record.dynamics = dynamics;
    record.damping = kCertain * min_handle_damping({.machine = spec, .damping = dynamics.damping});
    record.friction = least_friction(Pantograph(spec), places, dynamics);
    record.round_trip = traits.round_trip;
    record.rate_hz = traits.round_trip > 0.0 ? std::fmin(1.0 / traits.round_trip, 1e4) : 1e4;
    record.stiffness = record.damping / min_damping(1.0, kTick, traits.delay_ticks);
    record.mark = places.at(1);
}

/// Pulses at all places, the last one first: the handle is there.
std::string prove_pushes(PulseRunner& runner,
                         const Device& device,
                         const PantographSpec& spec,
                         const std::vector<Vec2>& places,
                         double mass,
                         const CommissioningDesk& desk,
                         double period,
                         Commissioned& done) {
    const double delay = device.traits().delay_ticks * period;
    for (std::size_t i = places.size(); i-- > 0;) {
        const bool first = i + 1 == places.size();
        done.given_up = !first && !desk.bring(places[i]);
        if (done.given_up) {
            return "it was given up";
        }
        std::vector<Pulse> here;
        if (first) {
            if (std::string what = find_force(runner, done.record.force, here); !what.empty()) {
                return what;
            }
            const Connection order = order_of_motors(spec, here, delay);
            if (!(order == Connection{})) {
                return explained(order, "motor", "", "") +
                       ": correct the wiring or the calibration, then commission again";
            }
        } else {
            push(runner, done.record.force, here);
        }
        push(runner, std::fmax(kStrong, done.record.force), here);
        if (std::string what = tripped(here); !what.empty()) {
            return what;
        }
        done.pulses.insert(done.pulses.end(), here.begin(), here.end());
    }
    done.motors = prove_motors(spec, done.pulses, mass, delay);
    const std::string what = motors_text(done.motors->connection, done.motors->gain);
    if (!what.empty()) {
        return what + " for a handle of " + number_text(std::round(mass * 1e4) / 10.0) +
               " g: correct the amplifiers or the calibration, or weigh the handle and give "
               "--handle-g, then commission again";
    }
    return wrong_with(spec, done.pulses, done.motors->dynamics, delay);
}

}  // namespace

Commissioned commission(Device& device,
                        const PantographSpec& spec,
                        const std::vector<Vec2>& places,
                        double mass,
                        const CommissioningDesk& desk) {
    if (!(told_apart(spec, places) > 2.0 * kPlaced)) {
        throw std::invalid_argument(
            "these marks do not tell how the encoders are connected: give others, further apart "
            "and not in one line with home");
    }
    if (!(mass > 0.0 && std::isfinite(mass))) {
        throw std::invalid_argument("the handle weighs " + number_text(mass) +
                                    " kg: give a number above 0");
    }
    Commissioned done;
    PulseRunner runner(device, spec, desk.period, desk.wait);
    std::vector<MarkReading> marks;
    done.refused = read_marks(runner, device, places, desk, marks, done.given_up);
    if (!done.refused.empty()) {
        return done;
    }
    done.encoders = prove_encoders(spec, marks);
    if (!done.encoders.fits || !(done.encoders.connection == Connection{})) {
        done.refused = encoders_text(done.encoders);
        return done;
    }
    done.refused = prove_pushes(runner, device, spec, places, mass, desk, desk.period, done);
    if (done.refused.empty()) {
        fill_record(done.record, device, spec, places, done.motors->dynamics);
    }
    return done;
}

ShortForm prove_again(PulseRunner& runner,
                      const PantographSpec& spec,
                      const RigRecord& record,
                      double delay) {
    ShortForm form;
    for (const Vec2& direction : kPulseDirections) {
        const Pulse pulse = runner.give(direction, {.force = record.force});
        form.refused = wrong_with(spec, {&pulse, 1}, record.dynamics, delay);
        if (!form.refused.empty()) {
            return form;
        }
        const PulseMatch found = match(spec, pulse, record.dynamics, delay);
        form.found += (form.found.empty() ? "" : ", ") +
                      number_text(std::round(100.0 * found.share)) + " % at " +
                      number_text(std::round(found.angle * 180.0 / kPi)) + " deg";
    }
    return form;
}

}  // namespace palpate::engine

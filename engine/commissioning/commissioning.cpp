#include "engine/commissioning/commissioning.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "engine/commissioning/pulse_match.hpp"
#include "engine/commissioning/straight_axes.hpp"
#include "engine/device/machine.hpp"
#include "engine/device/simulated_pantograph.hpp"
#include "engine/safety/passivity.hpp"

namespace palpate::engine {
namespace {

constexpr double kLook = 0.25;        ///< s at a mark
constexpr double kStrong = 0.3;       ///< N, of the pulses that find numbers
constexpr std::int32_t kEnough = 12;  ///< counts that a pulse has to move an encoder
constexpr double kNearHome = 0.002;   ///< m: a pose that a board has just taken for home
constexpr double kCertain = 0.8;      ///< share of the damping found that is relied upon
constexpr const char* kCorrect = ": correct the wiring or the calibration, then commission again";
constexpr const char* kAgain = ". Commission again once that is right";
constexpr double kTick = 1e-3;  ///< s, of the stiffness that is said to be usable

/// A handle that is being proved, and whoever brings it to its places.
struct Bench {
    PulseRunner& runner;
    const Device& device;
    const Calibration& machine;
    const std::vector<Vec3>& places;  ///< m, home first
    const Vec3& mass;                 ///< kg, of each axis
    const CommissioningDesk& desk;
};

/// @throws std::invalid_argument for marks that do not tell how encoders are connected
void check_marks(const Calibration& machine, const std::vector<Vec3>& places) {
    if (machine.gantry) {
        return check_straight_places(*machine.gantry, places);
    }
    std::vector<Vec2> plane;
    for (const Vec3& place : places) {
        plane.emplace_back(place);
    }
    refuse_if(!(separation(machine.pantograph, plane) > 2.0 * kPlaced),
              "these marks do not tell how the encoders are connected: give others, further apart "
              "and not in one line with home");
}

/// Of the pulses that find numbers, N. @param force  that moves the handle
double strong(const Calibration& machine, double force) {
    const double max = pulse_forces(machine.axes()).back();
    return std::fmax(kStrong, machine.gantry ? std::fmin(3.0 * force, max) : force);
}

std::string encoders_text(const EncoderProof& proof) {
    const std::string what =
        explained(proof.connection, "encoder", "counts twice as much as counts_per_turn says",
                  "counts half as much as counts_per_turn says");
    if (proof.fits && !what.empty()) {
        return what + ", if the handle rested at home and then at each mark" + kCorrect;
    }
    return "the encoders do not say where the handle is, whatever their wiring: the nearest guess "
           "misses a mark by " +
           number_text(std::round(std::fmin(proof.missed, 1.0) * 1e4) / 10.0) +
           " mm: was the handle at home and then at each mark, are the lengths of the links and "
           "counts_per_turn right";
}

/// A board that was opened anew where the handle stood says that it is home.
/// @param seen  what the encoders say of `place`, m
std::string took_for_home(const Bench& bench, const Vec3& place, const Vec3& seen) {
    const Vec3& home = bench.places.front();
    const bool far = glm::length(place - home) > 2.0 * kPlaced;
    if (!bench.runner.reconnected() || !far || !(glm::length(seen - home) <= kNearHome)) {
        return {};
    }
    return "the device fell silent, and was opened anew while the handle was at " +
           place_text(place, bench.machine.axes()) +
           ": it took that for home. Check its cable and what else this machine does, bring the "
           "handle home and commission again";
}

/// Encoders at the places, in their order; nothing but zero force meanwhile.
/// @return what is wrong
std::string read_marks(const Bench& bench, std::vector<Rest>& marks, bool& given_up) {
    const auto axes = static_cast<std::size_t>(bench.device.traits().axes);
    for (const Vec3& place : bench.places) {
        given_up = !bench.desk.bring(place);
        if (given_up) {
            return "it was given up";
        }
        const Rest mark = bench.runner.watch(kLook);
        if (!std::isfinite(mark.place.x)) {
            const std::string trouble = bench.device.trouble();
            return "the device said nothing at " + place_text(place, axes) +
                   (trouble.empty() ? "" : ": " + trouble);
        }
        if (mark.span.x > 2.0 || mark.span.y > 2.0 || mark.span.z > 2.0) {
            return "the handle did not rest at " + place_text(place, axes) +
                   (axes > 2 ? ": let go of it; one that sinks by itself needs a counterweight or "
                               "a spring"
                             : ": let go of it, on a level desk");
        }
        if (std::string what = took_for_home(bench, place, mark.place); !what.empty()) {
            return what;
        }
        if (axes == 2 && std::any_of(marks.begin(), marks.end(), [&](const Rest& one) {
                return glm::length(one.counts - mark.counts) <= 2.0;
            })) {
            return "the handle stands where it stood before, and not at " +
                   place_text(place, axes) +
                   ": bring it there before you press Enter, or see whether the encoders are "
                   "connected" +
                   kAgain;
        }
        marks.push_back(mark);
    }
    return {};
}

/// What speaks against the encoders, which were read at the places.
std::string prove_marks(const Calibration& machine,
                        const std::vector<Vec3>& places,
                        const std::vector<Rest>& rests,
                        EncoderProof& proof) {
    if (machine.gantry) {
        const std::string what = wrong_encoders(machine, places, rests);
        return what.empty() ? what : what + kAgain;
    }
    std::vector<MarkReading> marks;
    for (std::size_t i = 0; i < places.size(); ++i) {
        marks.push_back({.place = Vec2(places[i]), .counts = Vec2(rests[i].counts)});
    }
    proof = prove_encoders(machine.pantograph, marks);
    return proof.fits && proof.connection == Connection{} ? std::string() : encoders_text(proof);
}

/// All directions once.
void push(const Bench& bench, double force, std::vector<Pulse>& pulses) {
    for (const Vec3& direction : pulse_directions(bench.machine.axes())) {
        pulses.push_back(
            bench.runner.give(direction, pulse_plan(bench.machine, direction, force, bench.mass)));
    }
}

std::string tripped(std::span<const Pulse> pulses) {
    const auto one = std::find_if(pulses.begin(), pulses.end(),
                                  [](const Pulse& pulse) { return pulse.trip != Trip::none; });
    return one == pulses.end()
             ? std::string()
             : "a pulse tripped the safety chain: " + std::string(explanation(one->trip)) +
                   ". Nobody may hold the handle meanwhile";
}

/// The weakest force that moves the handle, and the pulses of it.
/// @return what is wrong
std::string find_force(const Bench& bench, double& force, std::vector<Pulse>& pulses) {
    const Calibration& machine = bench.machine;
    const auto enough = [&](const Pulse& pulse) {
        return machine.gantry ? moved_enough(Gantry(*machine.gantry), pulse)
                              : moved(pulse) >= kEnough;
    };
    const auto directions = pulse_directions(machine.axes());
    pulses.assign(directions.size(), Pulse{});
    std::vector<bool> moves(directions.size(), false);
    for (const double newtons : pulse_forces(machine.axes())) {
        for (std::size_t i = 0; i < directions.size(); ++i) {
            if (!moves[i]) {  // what moves is not pushed harder
                force = newtons;
                pulses[i] = bench.runner.give(
                    directions[i], pulse_plan(machine, directions[i], newtons, bench.mass));
                moves[i] = enough(pulses[i]);
            }
        }
        if (std::string what = tripped(pulses); !what.empty()) {
            return what;
        }
        if (std::find(moves.begin(), moves.end(), false) == moves.end()) {
            return {};
        }
    }
    if (machine.gantry) {
        return {};  // which motor it is tells wrong_motors()
    }
    return "0.3 N do not move the handle: is it free, does nobody hold it, are the motors "
           "connected and switched on, is a switch pressed";
}

/// Which motor turns which joint, and which way.
/// @return what is wrong
std::string prove_order(const Calibration& machine,
                        const std::vector<Pulse>& pulses,
                        double delay) {
    if (machine.gantry) {
        const std::string what = wrong_motors(machine, pulses);
        return what.empty() ? what : what + kAgain;
    }
    const std::string what =
        explained(order_of_motors(machine.pantograph, pulses, delay), "motor", "", "");
    return what.empty() ? what : what + kCorrect;
}

std::string motors_text(const Connection& connection, const std::array<double, 2>& gain) {
    std::string text = explained(connection, "motor", "is too strong", "is too weak");
    for (std::size_t i = 0; i < 2; ++i) {
        if (!(std::fabs(std::fabs(gain[i]) - 1.0) <= kMaxGainError)) {
            text += (text.empty() ? "" : ", ") + std::string("motor ") + std::to_string(i + 1) +
                    " gives " + number_text(std::round(100.0 * std::fabs(gain[i])) / 100.0) +
                    " times what it should";
        }
    }
    return text;
}

double least_friction(const Pantograph& machine,
                      const std::vector<Vec3>& places,
                      const HandleDynamics& dynamics) {
    double least = 1e9;
    for (const Vec3& place : places) {
        const auto fix = machine.locate(*machine.reach(Vec2(place)));
        least = std::fmin(least, dynamics.friction.x / glm::length(fix->jacobian.column_1()));
        least = std::fmin(least, dynamics.friction.y / glm::length(fix->jacobian.column_2()));
    }
    return least + dynamics.handle_friction;
}

/// How strong the motors are, and how the handle moves.
/// @return what is wrong
std::string prove_strength(const Calibration& machine,
                           const Vec3& mass,
                           double delay,
                           CommissioningResult& done) {
    if (machine.gantry) {
        const FittedAxes found = fit_axes(Gantry(*machine.gantry), done.pulses, mass, delay);
        done.record.axes = found.axes;
        return wrong_strength(found, mass);
    }
    done.motors = prove_motors(machine.pantograph, done.pulses, mass.x, delay);
    done.record.dynamics = done.motors->dynamics;
    const std::string what = motors_text(done.motors->connection, done.motors->gain);
    const std::string other =
        unexplained_by_motion(what.empty() ? 0.0 : done.motors->unexplained, done.motors->late);
    return what.empty() || !other.empty()
             ? other
             : what + " for a handle of " + number_text(std::round(mass.x * 1e4) / 10.0) +
                   " g: correct the amplifiers or the calibration, or weigh the handle and give "
                   "--handle-g, then commission again";
}

void fill_record(RigRecord& record, const Bench& bench) {
    const Calibration& machine = bench.machine;
    const DeviceTraits traits = bench.device.traits();
    double damping = 0.0;
    if (machine.gantry) {
        const auto& axes = record.axes;
        damping = std::fmin(axes[0].damping, std::fmin(axes[1].damping, axes[2].damping));
        record.friction =
            std::fmin(axes[0].friction, std::fmin(axes[1].friction, axes[2].friction));
    } else {
        damping = min_handle_damping({.machine = machine.pantograph,
                                      .damping = record.dynamics.damping,
                                      .handle_damping = record.dynamics.handle_damping});
        record.friction =
            least_friction(Pantograph(machine.pantograph), bench.places, record.dynamics);
    }
    record.damping = kCertain * damping;
    record.round_trip = traits.round_trip;
    record.rate_hz = traits.round_trip > 0.0 ? std::fmin(1.0 / traits.round_trip, 1e4) : 1e4;
    record.stiffness = record.damping / min_damping(1.0, kTick, traits.delay_ticks);
}

/// Pulses at all places, the last one first: the handle is there. Straight axes are the same
/// everywhere.
std::string prove_pushes(const Bench& bench, CommissioningResult& done) {
    const Calibration& machine = bench.machine;
    const std::vector<Vec3>& places = bench.places;
    const double delay = bench.device.traits().delay_ticks * bench.desk.period;
    double& force = done.record.force;
    const std::size_t last = machine.gantry ? places.size() - 1 : 0;
    for (std::size_t i = places.size(); i-- > last;) {
        const bool first = i + 1 == places.size();
        done.given_up = !first && !bench.desk.bring(places[i]);
        if (done.given_up) {
            return "it was given up";
        }
        std::vector<Pulse> here;
        if (first) {
            std::string what = find_force(bench, force, here);
            what = what.empty() ? prove_order(machine, here, delay) : what;
            if (!what.empty()) {
                return what;
            }
        } else {
            push(bench, force, here);
        }
        push(bench, strong(machine, force), here);
        if (std::string what = took_for_home(bench, places[i], here.back().place); !what.empty()) {
            return what;
        }
        if (std::string what = tripped(here); !what.empty()) {
            return what;
        }
        done.pulses.insert(done.pulses.end(), here.begin(), here.end());
    }
    const std::string what = prove_strength(machine, bench.mass, delay, done);
    return what.empty() ? unexplained_by(done.record, Machine(machine), done.pulses, delay) : what;
}

}  // namespace

CommissioningResult commission(Device& device,
                               const Calibration& machine,
                               const std::vector<Vec3>& places,
                               const Vec3& mass,
                               const CommissioningDesk& desk) {
    check_marks(machine, places);
    for (int i = 0; i < static_cast<int>(machine.gantry ? machine.axes() : 1); ++i) {
        refuse_if(!(mass[i] > 0.0 && std::isfinite(mass[i])),
                  "the handle weighs {:.9g} kg: give a number above 0", mass[i]);
    }
    CommissioningResult done;
    done.record.mark = second_mark(machine, places);
    PulseRunner runner(device, Machine(machine), desk.period, desk.wait);
    const Bench bench{runner, device, machine, places, mass, desk};
    std::vector<Rest> marks;
    done.refused = read_marks(bench, marks, done.given_up);
    if (done.refused.empty()) {
        done.refused = prove_marks(machine, places, marks, done.encoders);
    }
    if (done.refused.empty()) {
        done.refused = prove_pushes(bench, done);
    }
    if (done.refused.empty()) {
        fill_record(done.record, bench);
    }
    return done;
}

std::vector<Vec3> places_to_commission(const Calibration& machine, const Vec2& home) {
    if (machine.gantry) {
        return straight_places(*machine.gantry);
    }
    std::vector<Vec3> places;
    for (const Vec2& place : commissioning_places(machine.pantograph, home)) {
        places.emplace_back(place, 0.0);
    }
    return places;
}

}  // namespace palpate::engine

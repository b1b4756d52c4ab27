#include "engine/commissioning/straight_axes.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "engine/commissioning/encoder_proof.hpp"
#include "engine/commissioning/nearest_numbers.hpp"
#include "engine/commissioning/pulse_fit.hpp"
#include "engine/device/machine.hpp"
#include "engine/math/elementary.hpp"

namespace palpate::engine {
namespace {

constexpr double kFurthest = 0.040;  ///< m from home to a mark
constexpr double kNearest = 0.020;   ///< a half or a double count misses it by twice kPlaced
constexpr double kMargin = 0.010;    ///< m from a mark to the ends, for pulses
constexpr double kFar = 0.001;       ///< m of way that tells something
constexpr double kUnseen = 0.010;    ///< m by which a force without friction speeds up unseen

std::string name(int axis) {
    return {"xyz"[axis]};
}

std::string hundredths(double value) {
    return number_text(std::round(100.0 * value) / 100.0);
}

void append(std::string& found, const std::string& what) {
    found += (found.empty() ? "" : "; ") + what;
}

/// The key of the calibration that turns a sign over.
std::string turned(const std::string& what, int axis, bool clockwise) {
    return what + "_" + name(axis) + " = \"" + (clockwise ? "forward" : "backward") + "\"";
}

int largest(const Vec3& way) {
    const Vec3 far = glm::abs(way);
    return far.z > std::fmax(far.x, far.y) ? 2 : far.y > far.x ? 1 : 0;
}

/// What stands for one axis against the mark that lies along it.
std::string wrong_encoder(
    const OpenWiring& wiring, int axis, const Vec3& place, double aim, const Vec3& way) {
    Vec3 missed = way;
    missed[axis] -= aim;
    if (glm::length(missed) <= kPlaced) {
        return {};
    }
    const int seen = largest(way);
    if (std::fabs(way[seen]) < kPlaced) {
        return "encoder " + name(axis) + " did not count on the way to " + place_text(place, 3) +
               ": is its cable in, does it turn with its axis";
    }
    if (seen != axis) {
        return "encoder " + name(seen) + " counts what moves along " + name(axis) +
               ": swap the encoders' cables, or channel_" + name(seen) + " and channel_" +
               name(axis) + " if their motors are swapped too";
    }
    std::string what;
    const double share = way[axis] / aim;
    if (share < 0.0) {
        append(what, "encoder " + name(axis) + " is reversed: write " +
                         turned("encoder", axis,
                                wiring.encoder_clockwise[static_cast<std::size_t>(axis)]));
    }
    if (std::fabs(std::fabs(share) - 1.0) * std::fabs(aim) > kPlaced) {
        append(what, "encoder " + name(axis) + " counts " + hundredths(std::fabs(share)) +
                         " times what counts_per_turn and radius_mm say");
    }
    if (what.empty()) {
        what = "the encoders miss the mark " + place_text(place, 3) + " by " +
               number_text(std::round(1e4 * glm::length(missed)) / 10.0) + " mm";
    }
    return what;
}

/// Pulses along an axis together: to and fro count alike, and what pulls all the time goes out.
struct PushSum {
    bool forward = false;  ///< the handle moved enough when it was pushed so
    bool backward = false;
    Vec3 way{};          ///< sum of the ways until the force was reversed, in its direction
    double force = 0.0;  ///< N, the strongest
};

PushSum pushed_along(const Gantry& gantry, std::span<const Pulse> pulses, int axis) {
    PushSum all;
    for (const Pulse& pulse : pulses) {
        const double force = pulse.force[axis];
        if (force != 0.0) {
            (force > 0.0 ? all.forward : all.backward) |= moved_enough(gantry, pulse);
            all.way += (force > 0.0 ? 1.0 : -1.0) * way_of(gantry, pulse, pulse.turn);
            all.force = std::fmax(all.force, std::fabs(force));
        }
    }
    return all;
}

std::string wrong_motor(const OpenWiring& wiring, int axis, const PushSum& pushed) {
    const std::string motor = "motor " + name(axis);
    if (!pushed.forward && !pushed.backward) {
        return "nothing counts when " + motor + " pushes by " + number_text(pushed.force) +
               " N: is it connected and switched on, is its axis free, does somebody hold the "
               "handle, is the cable of encoder " +
               name(axis) + " in, is a switch pressed";
    }
    const int seen = largest(pushed.way);
    const bool back = pushed.way[seen] < 0.0;
    if (seen != axis) {
        return motor + " moves axis " + name(seen) + (back ? " backward" : "") +
               ": swap the motors' cables";
    }
    if (back) {
        return motor + " is reversed: turn its two wires round, or write " +
               turned("motor", axis, wiring.motor_clockwise[static_cast<std::size_t>(axis)]);
    }
    if (!pushed.forward || !pushed.backward) {
        return motor + " moves its axis " + (pushed.forward ? "forward" : "backward") +
               " and not the other way by " + number_text(pushed.force) +
               " N: is something in its way, or its weight too much";
    }
    Vec3 beside = pushed.way;
    beside[axis] = 0.0;
    const double angle = arc_tan2(glm::length(beside), pushed.way[axis]);
    if (!(angle <= kMaxTurn)) {
        return motor + " moves the handle " + number_text(std::round(angle * 180.0 / kPi)) +
               " degrees beside its axis: are the axes at right angles";
    }
    return {};
}

/// A pulse as the fit of one axis needs it.
struct AxisTrack {
    double period = 1e-3;       ///< s
    std::vector<double> force;  ///< N that acts until each sample
    std::vector<double> way;    ///< m there; kUnknown: nothing new was read
};

AxisTrack track_of(const Gantry& gantry, const Pulse& pulse, int axis, double delay) {
    AxisTrack track;
    const auto& samples = pulse.samples;
    const double radius = gantry.spec().axes[static_cast<std::size_t>(axis)].radius;
    track.period = samples.size() > 1 ? samples[1].time - samples[0].time : 1e-3;
    for (std::size_t k = 1; k < samples.size(); ++k) {
        track.force.push_back(acting_torque(samples, k, delay)[axis] / radius);
        track.way.push_back(samples[k].fresh ? way_of(gantry, pulse, k)[axis] : kUnknown);
    }
    return track;
}

/// Appends the way at each sample; damping and dry friction are taken implicitly.
void predict(const AxisTrack& track, const AxisDynamics& axis, std::vector<double>& ways) {
    constexpr int kParts = 4;
    const double h = track.period / kParts;
    const double damper = 0.5 * h * axis.damping;
    double speed = 0.0;
    double way = 0.0;
    for (const double force : track.force) {
        for (int i = 0; i < kParts; ++i) {
            const double kick = (axis.mass - damper) * speed + h * (force - axis.pull);
            const double rub = std::fmin(std::fabs(kick), h * axis.friction);
            const double after = (kick - std::copysign(rub, kick)) / (axis.mass + damper);
            way += 0.5 * h * (speed + after);
            speed = after;
        }
        ways.push_back(way);
    }
}

AxisDynamics dynamics_of(const LeastSquares::Row& x) {
    return {.mass = x[0], .damping = x[1], .friction = x[2], .pull = x[3]};
}

/// The pulses along an axis, and their ways one after the other.
struct AxisPulses {
    std::vector<AxisTrack> tracks;
    std::vector<double> measured;
};

AxisPulses pulses_along(const Gantry& gantry,
                        std::span<const Pulse> pulses,
                        int axis,
                        double delay) {
    AxisPulses all;
    for (const Pulse& pulse : pulses) {
        if (pulse.force[axis] != 0.0) {
            all.tracks.push_back(track_of(gantry, pulse, axis, delay));
            std::ranges::copy(all.tracks.back().way, std::back_inserter(all.measured));
        }
    }
    return all;
}

/// @param late  s by which they are seen later
std::vector<double> predicted_ways(const AxisPulses& all, const AxisDynamics& axis, double late) {
    std::vector<double> ways;
    for (const AxisTrack& track : all.tracks) {
        predict(track, axis, ways);
        see_late(std::span(ways).last(track.way.size()), 1, late / track.period);
    }
    return ways;
}

}  // namespace

std::vector<Vec3> straight_places(const GantrySpec& spec) {
    const Vec3 home = spec.home();
    std::vector<Vec3> places{home};
    for (int i = 0; i < 3; ++i) {
        const StraightAxis& axis = spec.axes[static_cast<std::size_t>(i)];
        const double up = axis.high - axis.home - kMargin;
        const double down = axis.home - axis.low - kMargin;
        const double way = std::floor(1e3 * std::fmin(kFurthest, std::fmax(up, down))) / 1e3;
        Vec3 place = home;
        place[i] += up >= down ? way : -way;
        places.push_back(place);
    }
    check_straight_places(spec, places);
    return places;
}

void check_straight_places(const GantrySpec& spec, std::span<const Vec3> places) {
    const Gantry gantry(spec);
    bool good = places.size() == 4 && places.front() == spec.home();
    for (int i = 0; i < 3 && good; ++i) {
        Vec3 beside = places[static_cast<std::size_t>(i) + 1] - places.front();
        good = std::fabs(beside[i]) >= kNearest * (1.0 - 1e-9) &&
               gantry.weakest_force(places[static_cast<std::size_t>(i) + 1]).has_value();
        beside[i] = 0.0;
        good = good && beside == Vec3{};
    }
    refuse_if(!good,
              "marks of three axes are home and a place along each axis, 20 mm away from it or "
              "more and 10 mm from the axis' end: correct home or the ends of {}",
              spec.name);
    for (int i = 0; i < 3; ++i) {
        const StraightAxis& axis = spec.axes[static_cast<std::size_t>(i)];
        refuse_if(!(axis.home - axis.low >= kMargin && axis.high - axis.home >= kMargin),
                  "home of axis {} is less than 10 mm from its end, and weak pulses move the "
                  "handle there: let it rest further inside",
                  name(i));
    }
}

std::string wrong_encoders(const Calibration& machine,
                           std::span<const Vec3> places,
                           std::span<const Rest> rests) {
    const Vec3 quantum = Gantry(*machine.gantry).quantum();
    std::string found;
    for (int i = 0; i < 3; ++i) {
        const auto at = static_cast<std::size_t>(i) + 1;
        const std::string what = wrong_encoder(machine.board.value_or(OpenWiring{}), i, places[at],
                                               places[at][i] - places[0][i],
                                               quantum * (rests[at].counts - rests[0].counts));
        if (!what.empty()) {
            append(found, what);
        }
    }
    return found.empty()
             ? found
             : found +
                   ". All this if the handle rested at home and then at each mark: was it there";
}

std::string wrong_motors(const Calibration& machine, std::span<const Pulse> pulses) {
    const Gantry gantry(*machine.gantry);
    if (std::none_of(pulses.begin(), pulses.end(),
                     [&](const Pulse& pulse) { return moved_enough(gantry, pulse); })) {
        return "no motor moves the handle by " + number_text(pulse_forces(3).back()) +
               " N: does somebody hold it, are the motors connected and switched on, is a switch "
               "pressed";
    }
    std::string found;
    for (int i = 0; i < 3; ++i) {
        const std::string what =
            wrong_motor(machine.board.value_or(OpenWiring{}), i, pushed_along(gantry, pulses, i));
        if (!what.empty()) {
            append(found, what);
        }
    }
    return found;
}

bool moved_enough(const Gantry& gantry, const Pulse& pulse) {
    return glm::length(way_of(gantry, pulse, pulse.turn)) >= kFar;
}

PulsePlan straight_pulse(double force, double mass) {
    PulsePlan plan{.force = force};
    plan.longest = std::fmin(plan.longest, std::sqrt(2.0 * kUnseen * mass / force));
    return plan;
}

PulsePlan pulse_plan(const Calibration& machine,
                     const Vec3& direction,
                     double force,
                     const Vec3& mass) {
    return machine.gantry ? straight_pulse(force, glm::dot(glm::abs(direction), mass))
                          : PulsePlan{.force = force};
}

Vec3 way_of(const Gantry& gantry, const Pulse& pulse, std::size_t sample) {
    const auto& samples = pulse.samples;
    const Machine::Counts& to = samples[std::min(sample, samples.size() - 1)].counts;
    const Machine::Counts& from = samples.front().counts;
    return gantry.quantum() * Vec3(to[0] - from[0], to[1] - from[1], to[2] - from[2]);
}

Vec3 predicted_way(const Gantry& gantry,
                   const Pulse& pulse,
                   std::size_t sample,
                   const std::array<AxisDynamics, 3>& axes,
                   double delay) {
    Vec3 way{};
    for (int i = 0; i < 3 && sample > 0; ++i) {
        std::vector<double> ways;
        predict(track_of(gantry, pulse, i, delay), axes[static_cast<std::size_t>(i)], ways);
        way[i] = ways[std::min(sample, ways.size()) - 1];
    }
    return way;
}

FittedAxes fit_axes(const Gantry& gantry,
                    std::span<const Pulse> pulses,
                    const Vec3& mass,
                    double delay) {
    const NumberRange range{.least = {1e-3, 0.0, 0.0, -20.0, 0.0},
                            .max = {50.0, 100.0, 20.0, 20.0, kLatest},
                            .small = {1e-3, 1e-2, 1e-3, 1e-3, 1e-3}};
    FittedAxes found;
    for (int i = 0; i < 3; ++i) {
        const AxisPulses pushed = pulses_along(gantry, pulses, i, delay);
        const auto predicted = [&](const LeastSquares::Row& x) {
            return predicted_ways(pushed, dynamics_of(x), x[4]);
        };
        const auto x = nearest_numbers(predicted, pushed.measured, {mass[i], 1.0, 0.02}, range, 4);
        const auto at = static_cast<std::size_t>(i);
        found.axes[at] = dynamics_of(x);
        found.late =
            std::fmax(found.late, nearest_numbers(predicted, pushed.measured, x, range, 5)[4]);
        found.unexplained[at] = left_over(pushed.measured, predicted(x), gantry.quantum()[i]);
    }
    return found;
}

std::string wrong_strength(const FittedAxes& found, const Vec3& mass) {
    std::string wrong;
    double left = 0.0;
    for (int i = 0; i < 3; ++i) {
        const auto at = static_cast<std::size_t>(i);
        const double gain = mass[i] / found.axes[at].mass;
        if (!(std::fabs(gain - 1.0) <= kMaxGainError)) {
            left = std::fmax(left, found.unexplained[at]);
            append(wrong, "motor " + name(i) + " gives " + hundredths(gain) +
                              " times what it should for " +
                              number_text(std::round(1e4 * mass[i]) / 10.0) + " g that it moves");
        }
    }
    const std::string other = unexplained_by_motion(left, found.late);
    return wrong.empty() || !other.empty()
             ? other
             : wrong +
                   ": correct torque_limit_mn_m or the amplifier, or weigh what each "
                   "motor moves and give --moved-g, then commission again";
}

AxesChange change_of_axes(const Gantry& gantry,
                          std::span<const Pulse> pulses,
                          const std::array<AxisDynamics, 3>& axes,
                          double delay) {
    const NumberRange range{
        .least = {0.02, 0.0, 0.0}, .max = {10.0, 10.0, kLatest}, .small = {1e-2, 1e-2, 1e-3}};
    AxesChange change;
    for (int i = 0; i < 3; ++i) {
        const AxisPulses pushed = pulses_along(gantry, pulses, i, delay);
        const AxisDynamics& was = axes[static_cast<std::size_t>(i)];
        const auto predicted = [&](const LeastSquares::Row& by) {
            return predicted_ways(pushed,
                                  {.mass = was.mass / by[0],
                                   .damping = was.damping * by[1] / by[0],
                                   .friction = was.friction * by[1] / by[0],
                                   .pull = was.pull / by[0]},
                                  by[2]);
        };
        const auto by = nearest_numbers(predicted, pushed.measured, {1.0, 1.0, 0.0}, range, 3);
        change.gain[i] = by[0];
        change.late = std::fmax(change.late, by[2]);
        change.unexplained = std::fmax(
            change.unexplained, left_over(pushed.measured, predicted(by), gantry.quantum()[i]));
    }
    return change;
}

}  // namespace palpate::engine

#include "engine/commissioning/pulse_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "engine/base/text.hpp"
#include "engine/commissioning/handle_fit.hpp"
#include "engine/math/least_squares.hpp"

namespace palpate::engine {
namespace {

constexpr std::int32_t kFewestCounts = 4;  ///< of a joint that is said to have moved

/// What stands in the equation of a joint at one moment.
struct Moment {
    Vec2 turned{};   ///< rad, both joints
    Vec2 carried{};  ///< J^T J turned: what the handle's mass feels
    Vec2 summed{};   ///< int turned
    Vec2 rubbed{};   ///< int int sgn of the rates
    Vec2 pushed{};   ///< int int of both motors' torque
};

double sign_of_rate(std::span<const PulseSample> samples, std::size_t at, std::size_t joint) {
    constexpr std::size_t kSide = 8;
    const std::size_t before = at < kSide ? 0 : at - kSide;
    const std::size_t after = std::min(at + kSide, samples.size() - 1);
    const int change = samples[after].counts[joint] - samples[before].counts[joint];
    return change > 0 ? 1.0 : change < 0 ? -1.0 : 0.0;
}

/// int int torque up to `time` less `delay`; each torque lasts until the next one.
class Pushes {
public:
    Pushes(std::span<const PulseSample> samples, double delay) : samples_(samples), delay_(delay) {}

    /// @param time  never less than before
    [[nodiscard]] Vec2 at(double time) {
        const double to = time - delay_;
        while (next_ < samples_.size() && samples_[next_].time <= to) {
            go_to(samples_[next_].time);
            torque_ = Vec2(samples_[next_++].torque);
        }
        if (to > now_) {
            go_to(to);
        }
        return way_;
    }

private:
    void go_to(double time) {
        const double step = time - now_;
        way_ += rate_ * step + torque_ * (0.5 * step * step);
        rate_ += torque_ * step;
        now_ = time;
    }

    std::span<const PulseSample> samples_;
    double delay_;
    std::size_t next_ = 0;
    double now_ = 0.0;
    Vec2 torque_{};
    Vec2 rate_{};
    Vec2 way_{};
};

std::vector<Moment> moments_of(const Pantograph& machine, const Pulse& pulse, double delay) {
    const auto& samples = pulse.samples;
    const auto start = machine.angles(samples.front().counts);
    const auto fix = machine.locate(start);
    std::vector<Moment> moments;
    if (!fix) {
        return moments;
    }
    Pushes pushes(samples, delay);
    Vec2 rub{};
    Moment now;
    for (std::size_t k = 1; k < samples.size(); ++k) {
        const double step = samples[k].time - samples[k - 1].time;
        const auto angles = machine.angles(samples[k].counts);
        const Vec2 turned{angles[0] - start[0], angles[1] - start[1]};
        const Vec2 sign{sign_of_rate(samples, k, 0), sign_of_rate(samples, k, 1)};
        now.summed += 0.5 * step * (turned + now.turned);
        now.rubbed += step * (rub + 0.5 * step * sign);
        rub += step * sign;
        now.turned = turned;
        const auto here =
            machine.locate({start[0] + 0.5 * turned.x, start[1] + 0.5 * turned.y});  // J halfway
        const Jacobian& jacobian = here ? here->jacobian : fix->jacobian;
        now.carried = jacobian.transposed(jacobian * turned);
        now.pushed = pushes.at(samples[k].time);
        if (samples[k].fresh) {
            moments.push_back(now);
        }
    }
    return moments;
}

bool joint_moved(const Pulse& pulse, std::size_t joint) {
    return std::any_of(pulse.samples.begin(), pulse.samples.end(), [&](const auto& sample) {
        return std::abs(sample.counts[joint] - pulse.samples.front().counts[joint]) >=
               kFewestCounts;
    });
}

struct Moments {
    Vec2 place{};
    std::vector<Moment> all;
    std::array<bool, 2> moved{};
};

/// Which joint each motor turns, and which way: signs are those of Connection::factor.
struct Order {
    bool swapped = false;
    Vec2 sign{1.0, 1.0};

    /// What drives the joints.
    [[nodiscard]] Vec2 of(const Vec2& motors) const noexcept {
        return sign * (swapped ? Vec2{motors.y, motors.x} : motors);
    }
};

/// The turn of both joints by the push of each motor, at one place.
using Response = std::array<Vec2, 2>;

Response response_of(std::span<const Moments> pulses) {
    std::array<LeastSquares, 2> joint{LeastSquares(2), LeastSquares(2)};
    for (const Moments& pulse : pulses) {
        for (const Moment& now : pulse.all) {
            joint[0].add({now.pushed.x, now.pushed.y}, now.turned.x);
            joint[1].add({now.pushed.x, now.pushed.y}, now.turned.y);
        }
    }
    const auto one = joint[0].solved();
    const auto two = joint[1].solved();
    return {Vec2{one[0], two[0]}, Vec2{one[1], two[1]}};
}

/// A handle that is pushed goes along: the response to the joints' own torques is symmetric and
/// positive definite. Of the eight orders of two motors that holds of one alone.
/// @return the smaller eigenvalue of the symmetric part by the size of all, -1 to 1
double positivity(const Response& response, const Order& order) {
    const Vec2 by_1 = order.sign.x * response[order.swapped ? 1 : 0];
    const Vec2 by_2 = order.sign.y * response[order.swapped ? 0 : 1];
    const double xx = by_1.x;
    const double yy = by_2.y;
    const double one = by_2.x;
    const double two = by_1.y;
    const double xy = 0.5 * (one + two);
    const double size = std::sqrt(xx * xx + yy * yy + one * one + two * two);
    const double least = 0.5 * (xx + yy - std::sqrt((xx - yy) * (xx - yy) + 4.0 * xy * xy));
    return size > 0.0 ? least / size : 0.0;
}

/// Pulses of one place stand together.
std::vector<std::span<const Moments>> by_place(std::span<const Moments> pulses) {
    constexpr double kSame = 0.008;  // m
    std::vector<std::span<const Moments>> places;
    for (std::size_t from = 0; from < pulses.size();) {
        std::size_t to = from + 1;
        while (to < pulses.size() && glm::length(pulses[to].place - pulses[from].place) <= kSame) {
            ++to;
        }
        places.push_back(pulses.subspan(from, to - from));
        from = to;
    }
    return places;
}

Order order_of(std::span<const Moments> pulses) {
    std::vector<Response> responses;
    for (const auto& place : by_place(pulses)) {
        responses.push_back(response_of(place));
    }
    Order best;
    double max = -std::numeric_limits<double>::infinity();
    for (const bool swapped : {false, true}) {
        for (const Vec2& sign :
             {Vec2{1.0, 1.0}, Vec2{-1.0, 1.0}, Vec2{1.0, -1.0}, Vec2{-1.0, -1.0}}) {
            const Order order{.swapped = swapped, .sign = sign};
            double sum = 0.0;
            for (const Response& response : responses) {
                sum += positivity(response, order);
            }
            if (sum > max) {
                max = sum;
                best = order;
            }
        }
    }
    return best;
}

/// The equations of both joints together: a first idea of the handle.
HandleDynamics first_idea(std::span<const Moments> pulses, const Order& order) {
    LeastSquares squares(7);
    for (const Moments& pulse : pulses) {
        for (const Moment& now : pulse.all) {
            const Vec2 pushed = order.of(now.pushed);
            if (pulse.moved[0]) {
                squares.add(
                    {now.turned.x, 0.0, now.carried.x, now.summed.x, 0.0, now.rubbed.x, 0.0},
                    pushed.x);
            }
            if (pulse.moved[1]) {
                squares.add(
                    {0.0, now.turned.y, now.carried.y, 0.0, now.summed.y, 0.0, now.rubbed.y},
                    pushed.y);
            }
        }
    }
    const auto x = squares.solved();
    const auto within = [](double value, double least, double max) {
        return std::fmin(std::fmax(value, least), max);
    };
    return {.handle_mass = within(x[2], 0.02, 1.0),
            .inertia = {within(x[0], 2e-5, 1e-2), within(x[1], 2e-5, 1e-2)},
            .damping = {within(x[3], 1e-4, 1.0), within(x[4], 1e-4, 1.0)},
            .friction = {within(x[5], 1e-4, 1.0), within(x[6], 1e-4, 1.0)},
            .handle_damping = 0.05,
            .handle_friction = 0.005};
}

std::vector<Moments> moments_of_all(const Pantograph& machine,
                                    std::span<const Pulse> pulses,
                                    double delay) {
    std::vector<Moments> all;
    for (const Pulse& pulse : pulses) {
        all.push_back({.place = Vec2(pulse.place),
                       .all = moments_of(machine, pulse, delay),
                       .moved = {joint_moved(pulse, 0), joint_moved(pulse, 1)}});
    }
    return all;
}

/// 1/2, 1 or 2, whichever is nearest as a ratio, with the sign of `gain`.
double nearest_factor(double gain) {
    const double size = std::fabs(gain);
    const double factor = size < std::sqrt(0.5) ? 0.5 : size > std::sqrt(2.0) ? 2.0 : 1.0;
    return gain < 0.0 ? -factor : factor;
}

}  // namespace

Connection order_of_motors(const PantographSpec& spec,
                           std::span<const Pulse> pulses,
                           double delay) {
    const Order order = order_of(moments_of_all(Pantograph(spec), pulses, delay));
    return {.swapped = order.swapped, .factor = {order.sign.x, order.sign.y}};
}

MotorProof prove_motors(const PantographSpec& spec,
                        std::span<const Pulse> pulses,
                        double mass,
                        double delay) {
    const Pantograph machine(spec);
    const std::vector<Moments> all = moments_of_all(machine, pulses, delay);
    const auto ever = [&](std::size_t joint) {
        return std::any_of(all.begin(), all.end(),
                           [joint](const Moments& pulse) { return pulse.moved[joint]; });
    };
    MotorProof proof;
    proof.moved = ever(0) && ever(1);
    if (!proof.moved) {
        return proof;
    }
    const Order order = order_of(all);
    std::vector<Track> tracks;
    for (const Pulse& pulse : pulses) {
        tracks.push_back(track_of(machine, pulse, order.swapped, order.sign, delay));
    }
    const FittedHandle fitted = fit_handle(tracks, {first_idea(all, order), 1.0}, Unknowns::ratio);
    proof.connection.swapped = order.swapped;
    proof.late = fit_handle(tracks, fitted, Unknowns::lateness).late;
    proof.unexplained = fitted.unexplained;
    proof.gain = {order.sign.x * mass / fitted.dynamics.handle_mass,
                  order.sign.y * mass / fitted.dynamics.handle_mass * fitted.ratio};
    for (std::size_t i = 0; i < 2; ++i) {
        proof.connection.factor[i] = nearest_factor(proof.gain[i]);
    }
    if (proof.connection == Connection{}) {
        proof.dynamics = fit_handle(tracks, {fitted.dynamics, 1.0}, Unknowns::dynamics).dynamics;
    }
    return proof;
}

std::string unexplained_text(const std::string& what) {
    return "the motion is not explained by mass, damping and friction: " + what +
           ". Is the desk level, does a cable pull at the handle, does somebody hold it, is "
           "something in its way? Nothing is said of the motors before that is right";
}

std::string unexplained_by_motion(double left, double late) {
    return left > kMaxUnexplained
             ? unexplained_text(number_text(std::round(100.0 * left)) + " % of a push is left over")
         : late > kMaxLate
             ? unexplained_text("it is seen " + number_text(std::round(1e3 * late)) +
                                " ms late, as where answers are old or the handle has become "
                                "heavier")
             : std::string();
}

}  // namespace palpate::engine

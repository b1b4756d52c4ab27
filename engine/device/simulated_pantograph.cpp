#include "engine/device/simulated_pantograph.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/base/processor.hpp"
#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "engine/device/dry_friction.hpp"
#include "engine/device/pantograph.hpp"
#include "engine/geometry/pair.hpp"

namespace palpate::engine {
namespace {

/// s. A whole part of the periods at 1, 2 and 4 kHz; the error of a step is that of a hand of 10
/// Hz, (2 pi 10 Hz 250 us)^2 / 12 = 2e-5 of the motion.
constexpr double kSubStep = 250e-6;
constexpr double kLongestAdvance = 1.0;  ///< s
constexpr double kNoTorque = 1e-30;      ///< N m from the command: a current that dies away arrives

/// exp(-x) for x >= 0 from + - * / alone: Taylor for x / 2^k <= 1/16, then k squarings. 1e-14.
double decay(double x) noexcept {
    int halvings = 0;
    while (x > 0.0625 && halvings < 12) {
        x *= 0.5;
        ++halvings;
    }
    if (x > 0.0625) {
        return 0.0;  // exp(-256) and less
    }
    double value = 1.0;
    for (int n = 10; n >= 1; --n) {
        value = 1.0 - x / n * value;
    }
    for (int i = 0; i < halvings; ++i) {
        value *= value;
    }
    return value;
}

void in_range(double value, double lowest, double highest, const char* what) {
    require_range(value, lowest, highest, std::string("the simulated pantograph's ") + what);
}

void check(const PlantModel& model) {
    check(model.machine);
    for (int i = 0; i < 2; ++i) {
        in_range(model.inertia[i], 1e-8, 10.0, "inertia (kg m^2)");
        in_range(model.damping[i], 0.0, 10.0, "joint damping (N m s/rad)");
        in_range(model.coulomb[i], 0.0, 10.0, "dry friction (N m)");
    }
    in_range(model.current_time, 0.0, 1.0, "current's time constant (s)");
    in_range(model.handle_mass, 0.0, 10.0, "handle mass (kg)");
    in_range(model.handle_damping, 0.0, 1e3, "handle damping (N s/m)");
    in_range(model.handle_friction, 0.0, 1e3, "dry friction at the handle (N)");
    in_range(model.hand.mass, 0.0, 10.0, "hand mass (kg)");
    in_range(model.hand.stiffness, 0.0, 1e5, "hand stiffness (N/m)");
    in_range(model.hand.damping, 0.0, 1e3, "hand damping (N s/m)");
    in_range(model.hand.strength, 0.0, 1e3, "hand strength (N)");
}

double clamped(double torque, double limit) noexcept {
    return std::isfinite(torque) ? std::clamp(torque, -limit, limit) : 0.0;
}

/// Rows of a 2 x 2 matrix.
struct Matrix {
    Pair row_1;
    Pair row_2;

    [[nodiscard]] Vec2 operator*(const Vec2& v) const noexcept {
        return Vec2{dot(row_1, pair(v)), dot(row_2, pair(v))};
    }
};

/// J^T A.
Matrix transposed_times(const Jacobian& j, const Jacobian& a) noexcept {
    const Pair x = pair(a.row_x);
    const Pair y = pair(a.row_y);
    return {.row_1 = j.row_x.x * x + j.row_y.x * y, .row_2 = j.row_x.y * x + j.row_y.y * y};
}

Vec2 vec(Pair pair) noexcept {
    return Vec2{pair[0], pair[1]};
}

/// Code and torque of one motor.
struct MotorCode {
    std::int32_t code = 0;
    double torque = 0.0;  ///< N m
};

MotorCode coded(const Axis& axis, double torque) noexcept {
    const double one = axis.torque_limit / axis.codes_full_scale;
    const double code = std::floor(torque / one + 0.5);
    return {.code = static_cast<std::int32_t>(code), .torque = code * one};
}

}  // namespace

PantographPlant::Steps::Steps(double seconds, const PlantModel& model) noexcept
    : span(seconds),
      count(static_cast<int>(std::ceil(span / kSubStep * (1.0 - 1e-9)))),
      h(span / count),
      half(0.5 * h) {
    const double mass = model.handle_mass + model.hand.mass;
    const double damping = model.hand.damping + model.handle_damping;
    turning = h * mass;
    less = mass - half * damping;
    more = mass + half * damping;
    less_turned = model.inertia - half * model.damping;
    more_turned = model.inertia + half * model.damping;
    rub = h * model.coulomb;
    const double time = model.current_time;
    if (const double ratio = time > 0.0 ? h / time : 0.0; ratio > 0.0) {
        left = decay(ratio);
        mean = (1.0 - left) / ratio;
    }
}

PantographPlant::PantographPlant(const PlantModel& model)
    : model_(model),
      steps_(kSubStep, model),
      frame_(model.machine.origin, model.machine.turn),
      path_(Exploration{}) {
    check(model);
    const Pantograph machine(model.machine);
    angles_ = machine.reach(path_.at(0.0).position).value_or(machine.angles({}));
}

void PantographPlant::begin(const Exploration& plan) {
    HandPath path(plan);
    const auto angles = Pantograph(model_.machine).reach(path.at(0.0).position);
    refuse_if(!angles,
              "the simulated pantograph cannot reach the start pose ({:.9g}, {:.9g}) m: move the "
              "start closer to the object",
              plan.start.x, plan.start.y);
    path_ = std::move(path);
    angles_ = *angles;
    rates_ = Vec2{};
    command_ = Vec2{};
    torque_ = Vec2{};
    time_ = 0.0;
    lost_ = false;
}

void PantographPlant::set_torque(const Vec2& newton_metres) noexcept {
    const auto& [one, two] = model_.machine.axes;
    command_ = Vec2{clamped(newton_metres.x, one.torque_limit),
                    clamped(newton_metres.y, two.torque_limit)};
}

/// The hand's intention at two steps at once.
void PantographPlant::take_steps() noexcept {
    const double h = steps_.h;
    for (int i = 0; i < steps_.count && !lost_; i += 2) {
        const auto [aim, next] = path_.at(time_ + 0.5 * h, (time_ + h) + 0.5 * h);
        follow(aim);
        if (i + 1 < steps_.count && !lost_) {
            follow(next);
        }
    }
}

/// One step, with the motors' current on its way to the command.
void PantographPlant::follow(const HandPath::Intention& aim) noexcept {
    const Vec2 away = torque_ - command_;
    step(command_ + steps_.mean * away, aim);
    torque_ = glm::length(away) > kNoTorque ? command_ + steps_.left * away : command_;
}

void PantographPlant::advance(double seconds) noexcept {
    if (!(seconds > 0.0) || lost_) {
        return;
    }
    const double span = std::min(seconds, kLongestAdvance);
    if (rests()) {
        time_ += span;
        return;
    }
    if (span != steps_.span) {
        steps_ = Steps(span, model_);
    }
    as_this_processor_can([this] { take_steps(); });
}

/// What nobody holds rests on, to the bit, while dry friction holds its motors.
bool PantographPlant::rests() const noexcept {
    return model_.hand.stiffness == 0.0 && model_.hand.damping == 0.0 && rates_ == Vec2{} &&
           torque_ == command_ && std::fabs(torque_.x) <= model_.coulomb.x &&
           std::fabs(torque_.y) <= model_.coulomb.y;
}

void PantographPlant::step(const Vec2& torque, const HandPath::Intention& aim) noexcept {
    const Steps& by = steps_;
    const FiveBar& linkage = model_.machine.linkage;
    const HandModel& hand = model_.hand;
    const JointAngles half{angles_[0] + by.half * rates_.x, angles_[1] + by.half * rates_.y};
    const auto pose = linkage.forward(half);
    const auto jacobian = pose ? linkage.jacobian(*pose) : std::nullopt;
    if (!jacobian) {
        lost_ = true;
        return;
    }
    Vec2 pull = hand.stiffness * (aim.position - frame_.point_to_object(pose->handle));
    const double strength = glm::length(pull);
    if (strength > hand.strength) {
        pull *= hand.strength / strength;
    }
    const Vec2 force = frame_.to_linkage(pull + hand.damping * aim.velocity);

    // (m + b h / 2) v+ = (m - b h / 2) v + h drive, c as C(v) v+
    const Matrix g = transposed_times(*jacobian, *jacobian);
    const Matrix turning = transposed_times(*jacobian, linkage.drift(*pose, *jacobian, rates_));
    const Vec2 drive = torque + jacobian->transposed(force);
    const Vec2 right = by.less_turned * rates_ + by.less * (g * rates_) + by.h * drive;
    Vec2 row_1 = vec(by.more * g.row_1 + by.turning * turning.row_1);
    Vec2 row_2 = vec(by.more * g.row_2 + by.turning * turning.row_2);
    row_1.x += by.more_turned.x;
    row_2.y += by.more_turned.y;
    const Vec2 rates = after_dry_friction(
        row_1, row_2, right, {by.rub, by.h * model_.handle_friction, vec(g.row_1), vec(g.row_2)},
        rates_);
    if (!std::isfinite(rates.x + rates.y)) {
        lost_ = true;
        return;
    }
    rates_ = rates;
    angles_ = {half[0] + by.half * rates.x, half[1] + by.half * rates.y};
    time_ += by.h;
}

double min_handle_damping(const PlantModel& model) {
    constexpr double kStep = 0.005;
    constexpr int kWide = 8;   // 40 mm to each side
    constexpr int kHigh = 12;  // 60 mm above the chord
    const Pantograph machine(model.machine);
    const double damp_1 = std::sqrt(model.damping.x);
    const double damp_2 = std::sqrt(model.damping.y);
    double lowest = std::numeric_limits<double>::infinity();
    for (int i = -kWide; i <= kWide; ++i) {
        for (int k = 0; k <= kHigh; ++k) {
            const auto angles = machine.reach({i * kStep, k * kStep});
            const auto fix = angles ? machine.locate(*angles) : std::nullopt;
            if (!fix) {
                continue;
            }
            // J^-T B J^-1 = S^T S with S = sqrt(B) J^-1
            const Jacobian& j = fix->jacobian;
            const double det = j.determinant();
            const Jacobian s{.row_x = Vec2{j.row_y.y, -j.row_x.y} * (damp_1 / det),
                             .row_y = Vec2{-j.row_y.x, j.row_x.x} * (damp_2 / det)};
            const double smallest = singular_values(s).smallest;
            lowest = std::fmin(lowest, smallest * smallest);
        }
    }
    return (std::isfinite(lowest) ? lowest : 0.0) + model.handle_damping;
}

SimulatedPantograph::SimulatedPantograph(const PantographModel& model, double period)
    : machine_(model.plant.machine),
      plant_(model.plant),
      period_(period),
      delayed_(model.delay_ticks == 1) {
    refuse_if(!(period > 0.0 && period <= 0.1),
              "the simulated pantograph's period is {:.9g} s: give a number above 0, at most 0.1",
              period);
    refuse_if(model.delay_ticks != 0 && model.delay_ticks != 1,
              "the simulated pantograph's delay is {} ticks: give 0 or 1", model.delay_ticks);
    const PantographSpec& spec = model.plant.machine;
    traits_ = {.gives_force = true,
               .damping = spec.damping ? *spec.damping : min_handle_damping(model.plant),
               .delay_ticks = model.delay_ticks + model.plant.current_time / period,
               .motor_time = spec.motor_time};
}

void SimulatedPantograph::begin(const Exploration& plan) {
    plant_.begin(plan);
    fix_.reset();
    waiting_ = Vec2{};
    first_ = true;
}

Reading SimulatedPantograph::read() noexcept {
    if (first_) {
        first_ = false;
    } else {
        plant_.advance(period_);
    }
    Reading reading;
    as_this_processor_can([this, &reading] {
        reading.counts = machine_.counts(plant_.angles());
        fix_ = plant_.lost() ? std::nullopt : machine_.locate(machine_.angles(reading.counts));
    });
    if (fix_) {
        reading.hip = Vec3(fix_->hip, 0.0);
    } else {
        reading.fault = DeviceFault::unreachable;
    }
    return reading;
}

AppliedForce SimulatedPantograph::write(const Vec3& force) noexcept {
    AppliedForce applied;
    Vec2 torque{};
    if (fix_) {
        const MotorDrive drive = machine_.drive(*fix_, Vec2(force));
        const MotorCode one = coded(machine_.spec().axes[0], drive.torque.x);
        const MotorCode two = coded(machine_.spec().axes[1], drive.torque.y);
        applied = {.codes = {one.code, two.code}, .saturated = drive.saturated, .load = drive.load};
        torque = Vec2{one.torque, two.torque};
    } else {
        applied.saturated = Vec2(force) != Vec2{};
    }
    plant_.set_torque(delayed_ ? waiting_ : torque);
    waiting_ = torque;
    return applied;
}

}  // namespace palpate::engine

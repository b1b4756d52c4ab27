#include "engine/device/simulated_pantograph.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include "engine/base/text.hpp"

namespace palpate::engine {
namespace {

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
    if (!(period > 0.0 && period <= 0.1)) {
        throw std::invalid_argument("the simulated pantograph's period is " + number_text(period) +
                                    " s: give a number above 0, at most 0.1");
    }
    if (model.delay_ticks != 0 && model.delay_ticks != 1) {
        throw std::invalid_argument("the simulated pantograph's delay is " +
                                    std::to_string(model.delay_ticks) + " ticks: give 0 or 1");
    }
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
    reading.counts = machine_.counts(plant_.angles());
    fix_ = plant_.lost() ? std::nullopt : machine_.locate(machine_.angles(reading.counts));
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
        const Pantograph::Drive drive = machine_.drive(*fix_, Vec2(force));
        const MotorCode one = coded(machine_.spec().axes[0], drive.torque.x);
        const MotorCode two = coded(machine_.spec().axes[1], drive.torque.y);
        applied = {.codes = {one.code, two.code},
                   .saturated = drive.saturated,
                   .load = Vec3(drive.load, 0.0)};
        torque = Vec2{one.torque, two.torque};
    } else {
        applied.saturated = Vec2(force) != Vec2{};
    }
    plant_.set_torque(delayed_ ? waiting_ : torque);
    waiting_ = torque;
    return applied;
}

}  // namespace palpate::engine

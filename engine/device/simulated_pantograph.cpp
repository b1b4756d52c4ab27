#include "engine/device/simulated_pantograph.hpp"

#include <cmath>
#include <stdexcept>

#include "engine/math/elementary.hpp"

namespace palpate::engine {
namespace {

constexpr int kSubSteps = 10;

std::int32_t rounded(double value) noexcept {
    return static_cast<std::int32_t>(std::floor(value + 0.5));
}

}  // namespace

SimulatedPantograph::SimulatedPantograph(const PantographModel& model, double period)
    : model_(model), period_(period), path_(Exploration{}) {
    begin(Exploration{});
}

void SimulatedPantograph::begin(const Exploration& plan) {
    path_ = HandPath(plan);
    const Vec2 start = path_.at(0.0).position + model_.origin;
    const auto angles = model_.linkage.inverse(start);
    const auto pose = angles ? model_.linkage.forward(*angles) : std::nullopt;
    const auto jacobian = pose ? model_.linkage.jacobian(*angles, *pose) : std::nullopt;
    if (!jacobian) {
        throw std::invalid_argument("the simulated pantograph cannot reach the start pose (" +
                                    std::to_string(plan.start.x) + ", " +
                                    std::to_string(plan.start.y) +
                                    ") m: move the start closer to the object");
    }
    angles_ = *angles;
    last_jacobian_ = *jacobian;
    rates_ = Vec2{};
    torque_ = Vec2{};
    time_ = 0.0;
    first_ = true;
    lost_ = false;
}

bool SimulatedPantograph::hand_is_done() const noexcept {
    return time_ >= path_.duration();
}

JointAngles SimulatedPantograph::measured() const noexcept {
    const double count = 2.0 * kPi / model_.counts_per_turn;
    return {rounded(angles_[0] / count) * count, rounded(angles_[1] / count) * count};
}

Reading SimulatedPantograph::read() noexcept {
    if (first_) {
        first_ = false;
    } else {
        for (int i = 0; i < kSubSteps && !lost_; ++i) {
            integrate(period_ / kSubSteps);
        }
    }
    const double count = 2.0 * kPi / model_.counts_per_turn;
    const auto pose = model_.linkage.forward(measured());
    Reading reading;
    reading.fault = !lost_ && pose.has_value() ? DeviceFault::none : DeviceFault::unreachable;
    reading.counts = {rounded(angles_[0] / count), rounded(angles_[1] / count)};
    if (pose) {
        reading.hip = pose->handle - model_.origin;
    }
    return reading;
}

Applied SimulatedPantograph::write(const Vec2& force) noexcept {
    const JointAngles angles = measured();
    const auto pose = model_.linkage.forward(angles);
    const auto jacobian = pose ? model_.linkage.jacobian(angles, *pose) : std::nullopt;
    if (!jacobian) {
        torque_ = Vec2{};
        return {.saturated = true};
    }
    Vec2 torque = jacobian->transposed(force);
    const double most = std::fmax(std::fabs(torque.x), std::fabs(torque.y));
    Applied applied;
    if (most > model_.torque_limit) {  // both scaled alike: the force keeps its direction
        torque *= model_.torque_limit / most;
        applied.saturated = true;
    }
    const double code = model_.torque_limit / model_.codes_full_scale;
    applied.codes = {rounded(torque.x / code), rounded(torque.y / code)};
    torque_ = Vec2{applied.codes[0] * code, applied.codes[1] * code};
    return applied;
}

void SimulatedPantograph::integrate(double dt) noexcept {
    const auto pose = model_.linkage.forward(angles_);
    const auto jacobian = pose ? model_.linkage.jacobian(angles_, *pose) : std::nullopt;
    if (!jacobian) {
        lost_ = true;
        return;
    }
    const Jacobian& j = *jacobian;
    const double mass = model_.handle_mass + model_.hand_mass;
    const Vec2 velocity = j * rates_;
    const Vec2 drift = (velocity - last_jacobian_ * rates_) / dt;  // J' q'
    const HandPath::Intention aim = path_.at(time_);
    Vec2 pull = model_.hand_stiffness * (aim.position - (pose->handle - model_.origin));
    const double strength = glm::length(pull);
    if (strength > model_.hand_strength) {
        pull *= model_.hand_strength / strength;
    }
    const Vec2 hand = pull + model_.hand_damping * (aim.velocity - velocity);
    const Vec2 drive = torque_ - model_.joint_damping * rates_ + j.transposed(hand - mass * drift);
    // (I + m J^T J) q'' = drive
    const Vec2 column_1{j.row_x.x, j.row_y.x};
    const Vec2 column_2{j.row_x.y, j.row_y.y};
    const double m11 = model_.link_inertia + mass * glm::dot(column_1, column_1);
    const double m12 = mass * glm::dot(column_1, column_2);
    const double m22 = model_.link_inertia + mass * glm::dot(column_2, column_2);
    const double det = m11 * m22 - m12 * m12;
    const Vec2 acceleration{(m22 * drive.x - m12 * drive.y) / det,
                            (m11 * drive.y - m12 * drive.x) / det};
    rates_ += dt * acceleration;
    angles_ = {angles_[0] + dt * rates_.x, angles_[1] + dt * rates_.y};
    last_jacobian_ = j;
    time_ += dt;
}

}  // namespace palpate::engine

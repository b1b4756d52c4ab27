#include "engine/device/simulated_gantry.hpp"

#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "engine/base/text.hpp"
#include "engine/math/elementary.hpp"

namespace palpate::engine {
namespace {

constexpr double kLongestStep = 250e-6;  ///< s
constexpr double kCountsPerM = 1e6;      ///< HIP is a whole number of them, and of 0.1 um
constexpr double kCodesPerN = 1e3;
constexpr double kShakeHz = 9.0;
constexpr double kAbove = 0.015;  ///< m above the middle on the way down and up again

std::int32_t whole_steps(double steps) noexcept {
    return static_cast<std::int32_t>(std::floor(steps + 0.5));
}

void require_range(double value, double lowest, double highest, const char* what) {
    if (!(value >= lowest && value <= highest)) {
        throw std::invalid_argument(std::string("the simulated gantry's ") + what + " is " +
                                    number_text(value) + ": give " + number_text(lowest) + " to " +
                                    number_text(highest));
    }
}

/// Down onto the patch, strokes across its middle in ever new directions, and off again.
TimedWay<3> way_of(const SurfaceExploration& plan) {
    const auto at = [&plan](double angle, double height) {
        const SinCos turned = sin_cos(angle);
        return Vec3(plan.radius * turned.cos, plan.radius * turned.sin, height);
    };
    constexpr double kNext = 0.375 * kPi;  // far enough for the hand to go on over the middle
    double angle = plan.turn;
    std::vector<Vec3> corners{plan.start, at(angle, kAbove), at(angle, -plan.press_depth)};
    for (int i = 0; i < plan.strokes; ++i) {
        corners.push_back(at(angle + kPi, -plan.press_depth));
        angle += kPi + kNext;
        corners.push_back(at(angle, -plan.press_depth));
    }
    corners.push_back(at(angle, kAbove));
    return {std::move(corners), plan.speed};
}

}  // namespace

SimulatedGantry::SimulatedGantry(const GantryModel& model, double period)
    : model_(model), period_(period) {
    require_range(period, 1e-6, 0.1, "period (s)");
    require_range(model.mass, 1e-3, 10.0, "mass (kg)");
    require_range(model.damping, 0.0, 100.0, "damping (N s/m)");
    require_range(model.force_limit, 0.1, 100.0, "motor's limit (N)");
    require_range(model.current_time, 0.0, 1.0, "current's time constant (s)");
    require_range(model.hand.mass, 0.0, 10.0, "hand mass (kg)");
    require_range(model.hand.stiffness, 0.0, 1e5, "hand stiffness (N/m)");
    require_range(model.hand.damping, 0.0, 1e3, "hand damping (N s/m)");
    require_range(model.hand.strength, 0.0, 1e3, "hand strength (N)");
    traits_ = {
        .damping = model.damping, .delay_ticks = 1.0 + model.current_time / period, .axes = 3};
    begin({});
}

void SimulatedGantry::begin(const SurfaceExploration& plan) {
    plan_ = plan;
    way_ = way_of(plan);
    position_ = plan.start;
    velocity_ = command_ = current_ = waiting_ = Vec3{};
    time_ = 0.0;
    first_ = true;
}

void SimulatedGantry::advance() noexcept {
    const int steps = static_cast<int>(std::ceil(period_ / kLongestStep * (1.0 - 1e-9)));
    const double h = period_ / steps;
    const HandModel& hand = model_.hand;
    const double damping = 0.5 * h * (model_.damping + hand.damping);
    const double mass = model_.mass + hand.mass;
    // The current's way to its command, by the trapezoidal rule.
    const double share = std::fmin(1.0, h / (model_.current_time + 0.5 * h));
    for (int i = 0; i < steps; ++i) {
        const double middle = time_ + 0.5 * h;
        TimedWay<3>::Moment aim = way_.at(middle);
        const SinCos shake = sin_cos(2.0 * kPi * kShakeHz * middle + plan_.tremor_phase);
        aim.position += plan_.tremor * Vec3(shake.sin, shake.cos, shake.sin);
        position_ += 0.5 * h * velocity_;
        Vec3 pull = hand.stiffness * (aim.position - position_);
        const double strength = glm::length(pull);
        if (strength > hand.strength) {
            pull *= hand.strength / strength;
        }
        const Vec3 next = current_ + share * (command_ - current_);
        const Vec3 given = model_.current_time > 0.0 ? 0.5 * (current_ + next) : next;
        const Vec3 drive = given + pull + hand.damping * aim.velocity;
        current_ = next;
        velocity_ = ((mass - damping) * velocity_ + h * drive) / (mass + damping);
        position_ += 0.5 * h * velocity_;
        time_ += h;
    }
}

Reading SimulatedGantry::read() noexcept {
    if (!first_) {
        advance();
    }
    first_ = false;
    Reading reading;
    reading.counts = {whole_steps(position_.x * kCountsPerM),
                      whole_steps(position_.y * kCountsPerM)};
    reading.count_3 = whole_steps(position_.z * kCountsPerM);
    reading.hip = {reading.counts[0] / kCountsPerM, reading.counts[1] / kCountsPerM};
    reading.hip_z = reading.count_3 / kCountsPerM;
    return reading;
}

Applied SimulatedGantry::press(const Vec3& force) noexcept {
    Applied applied;
    const auto coded = [&](double newton) {
        const double most = model_.force_limit;
        applied.saturated = applied.saturated || std::fabs(newton) > most;
        return whole_steps(std::fmin(std::fmax(newton, -most), most) * kCodesPerN);
    };
    applied.codes = {coded(force.x), coded(force.y)};
    applied.code_3 = coded(force.z);
    command_ = waiting_;
    waiting_ = Vec3(applied.codes[0], applied.codes[1], applied.code_3) / kCodesPerN;
    return applied;
}

std::optional<double> SimulatedGantry::reading_error(const Vec2& /*hip*/) const noexcept {
    return std::sqrt(3.0) * 0.5 / kCountsPerM;
}

}  // namespace palpate::engine

#include "engine/device/simulated_gantry.hpp"

#include <cmath>
#include <cstdint>
#include <vector>

#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "engine/math/elementary.hpp"

namespace palpate::engine {
namespace {

constexpr double kLongestStep = 250e-6;  ///< s
constexpr double kShakeHz = 9.0;
constexpr double kAbove = 0.015;  ///< m above the middle on the way down and up again

void gantry_range(double value, double lowest, double highest, const char* what) {
    require_range(value, lowest, highest, std::string("the simulated gantry's ") + what);
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
    if (plan.returns) {
        corners.push_back(plan.start);
    }
    return {std::move(corners), plan.speed};
}

constexpr double kCountsPerM = 1e6;  ///< HIP is a whole number of them, and of 0.1 um
constexpr double kCodesPerN = 1e3;

std::int32_t whole_steps(double steps) noexcept {
    return static_cast<std::int32_t>(std::floor(steps + 0.5));
}

Vec3 in_space(const std::array<std::int32_t, 3>& steps) noexcept {
    return {steps[0], steps[1], steps[2]};
}

}  // namespace

GantryPlant::GantryPlant(const GantryModel& model) : model_(model) {
    gantry_range(model.mass, 1e-3, 10.0, "mass (kg)");
    gantry_range(model.damping, 0.0, 100.0, "damping (N s/m)");
    burden(model.friction, model.weight);
    gantry_range(model.force_limit, 0.1, 100.0, "motor's limit (N)");
    gantry_range(model.current_time, 0.0, 1.0, "current's time constant (s)");
    gantry_range(model.hand.mass, 0.0, 10.0, "hand mass (kg)");
    gantry_range(model.hand.stiffness, 0.0, 1e5, "hand stiffness (N/m)");
    gantry_range(model.hand.damping, 0.0, 1e3, "hand damping (N s/m)");
    gantry_range(model.hand.strength, 0.0, 1e3, "hand strength (N)");
    begin({});
}

void GantryPlant::burden(double friction, double weight) {
    gantry_range(friction, 0.0, 100.0, "dry friction (N)");
    gantry_range(weight, -100.0, 100.0, "weight (N)");
    model_.friction = friction;
    model_.weight = weight;
}

void GantryPlant::begin(const SurfaceExploration& plan) {
    plan_ = plan;
    way_ = way_of(plan);
    position_ = plan.start;
    velocity_ = command_ = current_ = Vec3{};
    time_ = 0.0;
}

void GantryPlant::advance(double seconds) noexcept {
    const int steps = static_cast<int>(std::ceil(seconds / kLongestStep * (1.0 - 1e-9)));
    const double h = seconds / steps;
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
        const Vec3 drive =
            given + pull + hand.damping * aim.velocity - Vec3(0.0, 0.0, model_.weight);
        current_ = next;
        const Vec3 kick = (mass - damping) * velocity_ + h * drive;
        const Vec3 rub = glm::min(glm::abs(kick), Vec3(h * model_.friction));
        velocity_ = (kick - glm::sign(kick) * rub) / (mass + damping);
        position_ += 0.5 * h * velocity_;
        time_ += h;
    }
}

SimulatedGantry::SimulatedGantry(const GantryModel& model, double period)
    : plant_(model), period_(period) {
    refuse_if(!(period >= 1e-6 && period <= 0.1),
              "the simulated gantry's period (s) is {:.9g}: give 1e-06 to 0.1", period);
    traits_ = {
        .damping = model.damping, .delay_ticks = 1.0 + model.current_time / period, .axes = 3};
}

void SimulatedGantry::begin(const SurfaceExploration& plan) {
    plant_.begin(plan);
    waiting_ = Vec3{};
    first_ = true;
}

Reading SimulatedGantry::read() noexcept {
    if (!first_) {
        plant_.advance(period_);
    }
    first_ = false;
    const Vec3& position = plant_.position();
    Reading reading;
    reading.counts = {whole_steps(position.x * kCountsPerM), whole_steps(position.y * kCountsPerM),
                      whole_steps(position.z * kCountsPerM)};
    reading.hip = in_space(reading.counts) / kCountsPerM;
    return reading;
}

AppliedForce SimulatedGantry::write(const Vec3& force) noexcept {
    AppliedForce applied;
    const auto coded = [&](double newton) {
        const double max = plant_.model().force_limit;
        applied.saturated = applied.saturated || std::fabs(newton) > max;
        return whole_steps(std::fmin(std::fmax(newton, -max), max) * kCodesPerN);
    };
    applied.codes = {coded(force.x), coded(force.y), coded(force.z)};
    plant_.set_force(waiting_);
    waiting_ = in_space(applied.codes) / kCodesPerN;
    return applied;
}

std::optional<double> SimulatedGantry::reading_error(const Vec3& /*hip*/) const noexcept {
    return std::sqrt(3.0) * 0.5 / kCountsPerM;
}

}  // namespace palpate::engine

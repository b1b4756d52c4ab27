#include "engine/device/simulated_gantry.hpp"

#include <cmath>
#include <cstdint>
#include <stdexcept>

#include "engine/base/text.hpp"

namespace palpate::engine {
namespace {

constexpr double kCountsPerM = 1e6;  ///< HIP is a whole number of them, and of 0.1 um
constexpr double kCodesPerN = 1e3;

std::int32_t whole_steps(double steps) noexcept {
    return static_cast<std::int32_t>(std::floor(steps + 0.5));
}

Vec3 in_space(const std::array<std::int32_t, 3>& steps) noexcept {
    return {steps[0], steps[1], steps[2]};
}

}  // namespace

SimulatedGantry::SimulatedGantry(const GantryModel& model, double period)
    : plant_(model), period_(period) {
    if (!(period >= 1e-6 && period <= 0.1)) {
        throw std::invalid_argument("the simulated gantry's period (s) is " + number_text(period) +
                                    ": give 1e-06 to 0.1");
    }
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

#pragma once

#include <cmath>
#include <deque>

#include "engine/commissioning/encoder_proof.hpp"
#include "engine/device/simulated_pantograph.hpp"

namespace palpate::tests {

/// A free handle on a machine whose motors and encoders are not connected as its calibration says,
/// on a virtual clock: a torque written at one tick acts from the next one on.
class MiswiredMachine : public engine::Device {
public:
    /// @param plant  the machine as it is, with what its motors and its handle are
    MiswiredMachine(const engine::PlantModel& plant,
                    const engine::Connection& encoders,
                    const engine::Connection& motors,
                    double period = 1e-3)
        : machine_(plant.machine),
          plant_(free_handle(plant)),
          encoders_(encoders),
          motors_(motors),
          period_(period) {}

    /// A person brings the handle there and lets go.
    void bring(const engine::Vec2& place) {
        plant_.begin({.start = place, .tremor = 0.0});
        brought_ = place;
        past_.clear();
        acting_ = {};
        if (!homed_) {
            home_ = zero_ = plant_.angles();
            homed_ = true;
        }
    }
    [[nodiscard]] const engine::PantographPlant& plant() const { return plant_; }
    /// The last torque written was not zero.
    [[nodiscard]] bool pushes() const { return waiting_ != engine::Vec2{}; }
    /// The most torque that the motors ever gave, N m.
    [[nodiscard]] double strongest() const { return strongest_; }
    /// The most force that was ever asked for, N.
    [[nodiscard]] double max_asked() const { return max_asked_; }

    /// From now on a cable pulls the handle back to where it is brought, N/m.
    void tie(double stiffness) { cable_ = stiffness; }
    /// From now on a drag grows with the square of its speed, N s^2/m^2.
    void dip(double drag) { drag_ = drag; }
    /// From now on its answers are so many ticks older than they should be.
    void lag(std::size_t ticks) { lag_ = ticks; }
    /// It falls silent, and takes the pose in which it is opened anew for home.
    void fall_silent() { silent_ = true; }
    [[nodiscard]] bool reconnect() override {
        zero_ = silent_ ? plant_.angles() : zero_;
        silent_ = false;
        return true;
    }

    [[nodiscard]] engine::Reading read() noexcept override {
        plant_.set_torque(acting_ + pulled());
        const auto before = machine_.locate(plant_.angles());
        plant_.advance(period_);
        const auto after = machine_.locate(plant_.angles());
        speed_ = before && after ? (after->hip - before->hip) / period_ : engine::Vec2{};
        engine::Reading reading;
        if (silent_) {
            reading.fault = engine::DeviceFault::silent;
            return reading;
        }
        const auto at_home = machine_.counts(home_);
        past_.push_back(plant_.angles());
        while (past_.size() > lag_ + 1) {
            past_.pop_front();
        }
        for (std::size_t i = 0; i < 2; ++i) {
            const std::size_t joint = encoders_.swapped ? 1 - i : i;
            const double turned =
                (past_.front()[joint] - zero_[joint]) / machine_.spec().axes[joint].count_angle();
            reading.counts[i] = at_home[i] + static_cast<std::int32_t>(
                                                 std::floor(turned * encoders_.factor[i] + 0.5));
        }
        fix_ = machine_.locate(machine_.angles(reading.counts));
        if (fix_) {
            reading.hip = engine::Vec3(fix_->hip, 0.0);
        } else {
            reading.fault = engine::DeviceFault::unreachable;
        }
        return reading;
    }
    engine::AppliedForce write(const engine::Vec3& force) noexcept override {
        max_asked_ = std::fmax(max_asked_, glm::length(force));
        const engine::Vec2 asked =
            fix_ ? machine_.drive(*fix_, engine::Vec2(force)).torque : engine::Vec2{};
        engine::Vec2 given{};
        for (int i = 0; i < 2; ++i) {
            given[i] =
                motors_.factor[static_cast<std::size_t>(i)] * asked[motors_.swapped ? 1 - i : i];
        }
        strongest_ = std::fmax(strongest_, std::fmax(std::fabs(given.x), std::fabs(given.y)));
        acting_ = waiting_;
        waiting_ = given;
        return {};
    }
    [[nodiscard]] std::string name() const override { return "a miswired machine"; }
    [[nodiscard]] engine::DeviceTraits traits() const noexcept override {
        return {.delay_ticks = 1.0 + plant_.model().current_time / period_};
    }

private:
    static engine::PlantModel free_handle(engine::PlantModel plant) {
        plant.hand = {.mass = 0.0, .stiffness = 0.0, .damping = 0.0, .strength = 0.0};
        return plant;
    }
    /// N m of the cable and the drag.
    [[nodiscard]] engine::Vec2 pulled() const noexcept {
        const auto fix = machine_.locate(plant_.angles());
        return fix ? fix->jacobian.transposed(cable_ * (brought_ - fix->hip) -
                                              drag_ * glm::length(speed_) * speed_)
                   : engine::Vec2{};
    }

    engine::Pantograph machine_;
    engine::PantographPlant plant_;
    engine::Connection encoders_;
    engine::Connection motors_;
    double period_;
    engine::JointAngles home_{};
    engine::JointAngles zero_{};  ///< where it counts as at home
    bool silent_ = false;
    bool homed_ = false;
    std::optional<engine::Pantograph::Fix> fix_{};
    engine::Vec2 waiting_{};
    engine::Vec2 acting_{};
    engine::Vec2 brought_{};
    double cable_ = 0.0;  ///< N/m
    double drag_ = 0.0;   ///< N s^2/m^2
    engine::Vec2 speed_{};
    std::deque<engine::JointAngles> past_;
    std::size_t lag_ = 0;
    double strongest_ = 0.0;
    double max_asked_ = 0.0;
};

}  // namespace palpate::tests

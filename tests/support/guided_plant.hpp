#pragma once

#include <functional>
#include <stdexcept>

#include "engine/device/emulator/emulated_board.hpp"
#include "engine/device/pantograph.hpp"

namespace palpate::tests {

/// A plant whose handle is held so firmly that no torque moves it: it goes where it is led.
class GuidedPlant : public engine::BoardHand {
public:
    explicit GuidedPlant(const engine::Calibration& machine)
        : pantograph_(machine.pantograph), path_(engine::Exploration{}) {
        lead(*machine.home);
    }

    /// @param hip  object frame, m; within reach
    void lead(const engine::Vec2& hip) {
        const auto angles = pantograph_.reach(hip);
        if (!angles) {
            throw std::invalid_argument("out of reach");
        }
        angles_ = *angles;
    }
    void begin(const engine::Exploration& plan) override {
        path_ = engine::HandPath(plan);
        lead(plan.start);
        time_ = 0.0;
        exploring_ = true;
    }
    [[nodiscard]] bool hand_is_done() const noexcept override {
        return exploring_ && time_ >= path_.duration();
    }

    void set_torque(const engine::Vec2& newton_metres) noexcept override {
        torque_ = newton_metres;
    }
    void advance(double seconds) noexcept override {
        time_ += seconds;
        if (exploring_) {
            angles_ = pantograph_.reach(path_.at(time_).position).value_or(angles_);
        }
    }
    [[nodiscard]] engine::JointAngles angles() const noexcept override { return angles_; }
    [[nodiscard]] engine::Vec2 torque() const noexcept { return torque_; }

private:
    engine::Pantograph pantograph_;
    engine::HandPath path_;
    engine::JointAngles angles_{};
    engine::Vec2 torque_{};
    double time_ = 0.0;
    bool exploring_ = false;
};

/// A guard that only says what it is told to say, and counts what it hears.
class ScriptedGuard : public engine::MotorGuard {
public:
    struct Script {
        bool there = true;  ///< watch() works
        bool alive = true;
        bool tripped = false;
        bool force = false;  ///< what the driver said last
        int watches = 0;
        int releases = 0;
    };

    explicit ScriptedGuard(Script& script) : script_(&script) {}

    [[nodiscard]] bool watch(int /*port*/,
                             std::span<const std::uint8_t> /*zero*/,
                             std::span<const std::uint8_t> /*setup*/) override {
        ++script_->watches;
        script_->tripped = false;
        script_->alive = script_->alive || script_->there;
        return script_->there;
    }
    void release() noexcept override { ++script_->releases; }
    void force_on() noexcept override { script_->force = true; }
    void force_off() noexcept override { script_->force = false; }
    [[nodiscard]] bool alive() const noexcept override { return script_->alive; }
    [[nodiscard]] bool tripped() const noexcept override { return script_->tripped; }

private:
    Script* script_;
};

}  // namespace palpate::tests

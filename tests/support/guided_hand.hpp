#pragma once

#include "engine/device/emulator/emulated_board.hpp"
#include "tests/support/emulated_machine.hpp"

namespace palpate::tests {

/// A hand that holds the handle so firmly that no torque moves it: it goes where it is led, or
/// where an exploration leads.
class GuidedHand : public engine::BoardHand {
public:
    /// At home. @param machine  has a home within reach
    explicit GuidedHand(const engine::Calibration& machine)
        : pantograph_(machine.pantograph), path_(engine::Exploration{}) {
        lead(*machine.home);
    }

    /// @param hip  object frame, m. @throws std::invalid_argument if it is out of reach
    void lead(const engine::Vec2& hip) {
        const auto angles = pantograph_.reach(hip);
        if (!angles) {
            throw std::invalid_argument("the hand is led out of the linkage's reach");
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

    void set_torque(const engine::Vec3& newton_metres) noexcept override {
        torque_ = newton_metres;
    }
    void advance(double seconds) noexcept override {
        time_ += seconds;
        if (exploring_) {
            angles_ = pantograph_.reach(path_.at(time_).position).value_or(angles_);
        }
    }
    [[nodiscard]] double angle(std::size_t axis) const noexcept override { return angles_[axis]; }
    [[nodiscard]] const engine::JointAngles& angles() const noexcept { return angles_; }
    [[nodiscard]] engine::Vec3 torque() const noexcept { return torque_; }

private:
    engine::Pantograph pantograph_;
    engine::HandPath path_;
    engine::JointAngles angles_{};
    engine::Vec3 torque_{};
    double time_ = 0.0;
    bool exploring_ = false;
};

/// The third generation's Haply machine.
inline const engine::Calibration& haply_machine() {
    static const engine::Calibration calibration = emulated_calibration();
    return calibration;
}

/// A hand for each emulated board of it.
inline engine::MakeHand guided_hand() {
    return [] {
        return std::make_unique<GuidedHand>(haply_machine());
    };
}

}  // namespace palpate::tests

#pragma once

#include "engine/device/emulator/port_board.hpp"

namespace palpate::tests {

/// A handle on three straight axes that is where it is led, whatever the motors give.
class LedGantry : public engine::BoardPlant {
public:
    /// At home. @param machine  with a gantry
    explicit LedGantry(const engine::Calibration& machine)
        : machine_(*machine.gantry), at_(machine.gantry->home()) {}

    void lead(const engine::Vec3& place) { at_ = place; }
    void set_torque(const engine::Vec3& newton_metres) noexcept override {
        torque_ = newton_metres;
    }
    void advance(double /*seconds*/) noexcept override {}
    [[nodiscard]] double angle(std::size_t axis) const noexcept override {
        return (at_ - machine_.home())[static_cast<int>(axis)] / machine_.axes[axis].radius;
    }
    /// N m
    [[nodiscard]] const engine::Vec3& torque() const noexcept { return torque_; }

private:
    engine::GantrySpec machine_;
    engine::Vec3 at_{};
    engine::Vec3 torque_{};
};

/// Drums of 10 mm, 2,400 counts a turn, 12 N, home 40 mm up: what examples/gantry.toml says.
inline engine::Calibration gantry_machine() {
    engine::Calibration machine;
    machine.board.emplace();
    engine::GantrySpec& gantry = machine.gantry.emplace();
    for (engine::StraightAxis& axis : gantry.axes) {
        axis.motor = {.counts_per_turn = 2400.0,
                      .torque_limit = 0.12,
                      .torque_forever = 0.06,
                      .codes_full_scale = 800.0};
    }
    gantry.axes[2].low = -0.030;
    gantry.axes[2].home = 0.040;
    gantry.damping = 3.0;
    gantry.motor_time = 30.0;
    return machine;
}

}  // namespace palpate::tests

#pragma once

#include "engine/device/drivers/haply_wire.hpp"
#include "engine/device/emulator/emulated_board.hpp"
#include "tests/support/std.hpp"

namespace palpate::tests {

/// A Haply machine for tests of the engine alone, which knows no files: links, counts and wiring of
/// the shipped calibrations, zeros at 0, home at (0, 60) mm above the middle of the workspace.
/// @param preset  "gen3", "gen2" or "haplet"
/// @throws std::invalid_argument for another
inline engine::Calibration emulated_calibration(std::string_view preset = "gen3") {
    struct Machine {
        std::string_view name;
        double driven, free, base;  ///< links, m
        double counts_per_turn;
        engine::Vec2 origin;
        std::uint8_t id;
        std::array<std::uint8_t, 2> port;
        std::array<bool, 2> clockwise;
    };
    const Machine machines[]{
        {"gen3", 0.07, 0.09, 0.038, 4880.0, {0.019, 0.065}, 5, {2, 1}, {false, false}},
        {"gen2", 0.07, 0.09, 0.0, 10752.0, {0.0, 0.065}, 5, {2, 1}, {false, true}},
        {"haplet", 0.05, 0.07, 0.02, 13824.0, {0.010, 0.035}, 3, {1, 2}, {true, true}}};
    const auto* const of = std::ranges::find(machines, preset, &Machine::name);
    if (of == std::end(machines)) {
        throw std::invalid_argument("no such machine: " + std::string(preset));
    }
    const engine::Axis axis{.counts_per_turn = of->counts_per_turn,
                            .zero = 0.0,
                            .torque_limit = engine::kHaplyTorque,
                            .torque_forever = 0.5 * engine::kHaplyTorque,
                            .codes_full_scale = 4095.0};
    engine::Calibration calibration;
    calibration.pantograph.name = of->name;
    calibration.pantograph.linkage = {.driven_1 = of->driven,
                                      .driven_2 = of->driven,
                                      .free_1 = of->free,
                                      .free_2 = of->free,
                                      .base = of->base};
    calibration.pantograph.axes = {axis, axis};
    calibration.pantograph.origin = of->origin;
    calibration.haply = engine::HaplyWiring{.id = of->id,
                                            .port = of->port,
                                            .motor_clockwise = of->clockwise,
                                            .encoder_clockwise = of->clockwise,
                                            .grip_pin = {}};
    calibration.home = engine::Vec2{0.0, 0.060};
    return calibration;
}

/// The third of them on an open board, whose firmware is built for it.
inline engine::Calibration open_machine() {
    engine::Calibration machine = emulated_calibration("gen3");
    machine.haply.reset();
    machine.board = engine::OpenWiring{};
    return machine;
}

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

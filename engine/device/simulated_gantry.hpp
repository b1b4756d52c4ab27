#pragma once

#include "engine/device/device.hpp"
#include "engine/device/hand_path.hpp"
#include "engine/device/simulated_pantograph.hpp"

namespace palpate::engine {

/// How a simulated hand means to explore a patch of a surface about the origin. It knows where the
/// patch is and how large, never how it is curved.
struct SurfaceExploration {
    Vec3 start{0.0, 0.0, 0.030};  ///< m
    double radius = 0.025;        ///< m, of the strokes about the middle
    double speed = 0.08;          ///< m/s along the path
    double press_depth = 0.008;   ///< m below the level of the middle that the hand aims for
    int strokes = 8;              ///< across the middle, each in a direction of its own
    double turn = 0.0;            ///< rad, of the first one
    double tremor = 0.00005;      ///< m, amplitude of the 9 Hz tremor of a healthy hand
    double tremor_phase = 0.0;    ///< rad
    bool returns = false;         ///< to the start, when it is done
};

/// Numbers of a machine with three straight axes that move by themselves, each with a motor and an
/// encoder, and of the hand that holds it.
struct GantryModel {
    double mass = 0.120;        ///< kg moved by each motor, handle included
    double damping = 3.0;       ///< N s/m of each axis
    double friction = 0.0;      ///< N, dry, of each axis
    double weight = 0.0;        ///< N that pull the handle down, less what a counterweight holds
    double force_limit = 12.0;  ///< N of each motor
    double current_time = 0.15e-3;  ///< s, time constant of the motors' current; 0: at once
    HandModel hand{};
};

/// The motion of three straight axes x, y, z and of the hand that holds their handle.
///
/// On each axis a mass with damping and dry friction, pulled by motor, weight and hand: the kick of
/// a step takes both dampers by the trapezoidal rule, the friction implicitly, in steps of at most
/// 250 us; deterministic to the bit.
class GantryPlant {
public:
    /// @throws std::invalid_argument for a number outside its range
    explicit GantryPlant(const GantryModel& model);

    /// Puts the handle at the start of a new exploration, at rest, motors off.
    void begin(const SurfaceExploration& plan);
    /// What the motors are asked to give from now on, N.
    void set_force(const Vec3& force) noexcept { command_ = force; }
    /// From now on it rubs and weighs so much. @throws std::invalid_argument for a number outside
    /// its range
    void burden(double friction, double weight);
    /// @param seconds  > 0
    void advance(double seconds) noexcept;
    /// m
    [[nodiscard]] const Vec3& position() const noexcept { return position_; }
    /// True once the hand has done all its strokes and left the object.
    [[nodiscard]] bool hand_is_done() const noexcept { return time_ >= way_.duration(); }
    /// Seconds that the exploration takes.
    [[nodiscard]] double duration() const noexcept { return way_.duration(); }
    [[nodiscard]] const GantryModel& model() const noexcept { return model_; }

private:
    GantryModel model_;
    SurfaceExploration plan_{};
    TimedWay<3> way_;
    Vec3 position_{};  ///< m
    Vec3 velocity_{};  ///< m/s
    Vec3 command_{};   ///< N, acts now
    Vec3 current_{};   ///< N that the motors give
    double time_ = 0.0;
};

/// Three straight axes x, y, z and the hand that holds their handle, as one device on a virtual
/// clock.
///
/// A GantryPlant whose encoders count micrometres; motors take codes of 1 mN, and what is commanded
/// at one tick acts from the next one on, held over it.
class SimulatedGantry : public Device {
public:
    /// @param period  s between ticks, > 0
    /// @throws std::invalid_argument for a number outside its range
    SimulatedGantry(const GantryModel& model, double period);

    /// Puts the handle at the start of a new exploration, at rest, motors off.
    void begin(const SurfaceExploration& plan);
    /// True once the hand has done all its strokes and left the object.
    [[nodiscard]] bool hand_is_done() const noexcept { return plant_.hand_is_done(); }
    /// Seconds that the exploration takes.
    [[nodiscard]] double duration() const noexcept { return plant_.duration(); }

    [[nodiscard]] Reading read() noexcept override;
    AppliedForce write(const Vec3& force) noexcept override;
    [[nodiscard]] std::string name() const override { return "simulated gantry"; }
    [[nodiscard]] DeviceTraits traits() const noexcept override { return traits_; }
    [[nodiscard]] std::optional<double> weakest_force(const Vec3& /*hip*/) const noexcept override {
        return plant_.model().force_limit;
    }
    [[nodiscard]] std::optional<double> reading_error(const Vec3& hip) const noexcept override;

private:
    GantryPlant plant_;
    double period_;
    DeviceTraits traits_{};
    Vec3 waiting_{};  ///< N, acts from the next write on
    bool first_ = true;
};

}  // namespace palpate::engine

#pragma once

#include "engine/device/emulator/port_board.hpp"
#include "engine/device/gantry_plant.hpp"

namespace palpate::engine {

/// The handle of an emulated machine of three straight axes, on a board: held by a hand, or free.
///
/// The hand brings the handle home whenever the board is set up; it rests there, explores the patch about the
/// origin, comes home, and so on. It gives way as the hand of a SimulatedGantry does.
class GantryHand : public BoardPlant {
public:
    static constexpr double kRest = 3.0;    ///< s at home
    static constexpr double kSettle = 0.5;  ///< s, after the way home

    /// @param machine  with a gantry
    /// @param held     false: nobody holds the handle, and motors move it
    /// @throws std::invalid_argument for a machine without a gantry
    explicit GantryHand(const Calibration& machine, bool held = true);

    /// Somebody brings the free handle there and lets go, m. @throws std::invalid_argument outside the workspace
    void bring(const Vec3& place);
    /// From now on its motors give `gain` times what they are told to.
    void strengthen(double gain) noexcept { gain_ = gain; }

    void set_torque(const Vec2& newton_metres) noexcept override;
    void set_torque_3(double newton_metres) noexcept override;
    void advance(double seconds) noexcept override;
    /// rad from home
    [[nodiscard]] JointAngles angles() const noexcept override { return {angle(0), angle(1)}; }
    [[nodiscard]] double angle_3() const noexcept override { return angle(2); }
    void before_set_up() noexcept override;

    /// Where the handle truly is, object frame, m.
    [[nodiscard]] const Vec3& hip() const noexcept { return plant_.position(); }

private:
    [[nodiscard]] double angle(std::size_t axis) const noexcept;

    GantrySpec machine_;
    bool held_;
    GantryPlant plant_;
    Vec3 force_{};  ///< N, of the motors
    double gain_ = 1.0;
    double rested_ = 0.0;   ///< s at home
    double settled_ = 0.0;  ///< s after the way home
    bool explores_ = false;
};

}  // namespace palpate::engine

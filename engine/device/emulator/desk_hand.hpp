#pragma once

#include "engine/device/emulator/haply_board.hpp"
#include "engine/device/hand_path.hpp"
#include "engine/device/pantograph.hpp"

namespace palpate::engine {

/// A firm hand on the handle of an emulated machine that stands on a desk: no torque moves it.
/// Whenever a board is set up it has brought the handle home; it rests there, goes over to the
/// start, explores the object, comes home, and so on. It moves without jumps, and rests nowhere but
/// at home, so that a driver that waits for a resting handle finds it there.
class DeskHand : public BoardPlant {
public:
    static constexpr double kRest = 3.0;   ///< s at home
    static constexpr double kGlide = 1.5;  ///< s from home to the start, or back

    /// Home is Calibration::home, and without one the pose of count 0.
    /// @throws std::invalid_argument if the linkage cannot be there, or cannot reach the start
    explicit DeskHand(const Calibration& machine, const Exploration& plan = {});

    void set_torque(const Vec3& newton_metres) noexcept override { torque_ = newton_metres; }
    void advance(double seconds) noexcept override;
    [[nodiscard]] double angle(std::size_t axis) const noexcept override { return angles_[axis]; }
    void before_set_up() noexcept override;

    /// Where the handle truly is, object frame, m.
    [[nodiscard]] Vec2 hip() const noexcept;
    [[nodiscard]] const JointAngles& angles() const noexcept { return angles_; }
    [[nodiscard]] Vec3 torque() const noexcept { return torque_; }

private:
    enum class Act : std::uint8_t { waits, rests, goes, explores, comes };

    void turn_to(Act act) noexcept;
    void glide(const JointAngles& to) noexcept;

    Pantograph pantograph_;
    HandPath path_;
    JointAngles home_{};
    JointAngles start_{};
    JointAngles angles_{};
    JointAngles from_{};  ///< where the present act began
    Vec3 torque_{};
    Act act_ = Act::waits;
    double time_ = 0.0;  ///< s in the present act
};

}  // namespace palpate::engine

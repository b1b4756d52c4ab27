#pragma once

#include "engine/device/emulator/haply_board.hpp"
#include "engine/device/pantograph.hpp"
#include "engine/device/pantograph_plant.hpp"

namespace palpate::engine {

/// `plant` without a hand on its handle.
[[nodiscard]] inline PlantModel nobody_holds(PlantModel plant) {
    plant.hand = {.mass = 0.0, .stiffness = 0.0, .damping = 0.0, .strength = 0.0};
    return plant;
}

/// The handle of an emulated machine on a desk that nobody holds, so that motors move it and
/// friction stops it, until a hand takes it.
///
/// A hand that explores takes the handle over to the start, rests there, strokes over the object
/// and gives way as the hand of a SimulatedPantograph does, comes back to the start, and so on. It
/// moves without jumps.
class FreeHandle : public BoardPlant {
public:
    static constexpr double kRest = 3.0;   ///< s at the start
    static constexpr double kGlide = 1.5;  ///< s from where it is to the start

    /// At rest at `place`. @throws std::invalid_argument if it is out of reach
    FreeHandle(const PlantModel& plant, const Vec2& place);

    /// Somebody brings it there and lets go; a hand that holds it does so on a way without a jump.
    /// @throws std::invalid_argument if it is out of reach
    void bring(const Vec2& place);
    /// From now on a hand holds it where it is, or nobody does.
    void hold(bool held);
    /// A hand takes it where it is, and explores. @throws std::invalid_argument for a start out of
    /// reach
    void explore(const Exploration& plan);

    /// From now on its motors give `gain` times what they are asked for.
    void strengthen(double gain) noexcept { gain_ = Vec2(gain); }
    /// The same of one motor. @param motor  0 or 1
    void strengthen(std::size_t motor, double gain) noexcept {
        gain_[static_cast<int>(motor)] = gain;
    }

    void set_torque(const Vec3& newton_metres) noexcept override;
    void advance(double seconds) noexcept override;
    [[nodiscard]] double angle(std::size_t axis) const noexcept override { return angles_[axis]; }
    [[nodiscard]] const JointAngles& angles() const noexcept { return angles_; }

private:
    enum class Act : std::uint8_t { free, held, brings, comes, rests, strokes };

    void let_go(const Vec2& place);
    [[nodiscard]] Vec2 place_now() const noexcept;
    void turn_to(Act act) noexcept;
    void glide() noexcept;

    PantographPlant plant_;   ///< nobody's
    PantographPlant stroke_;  ///< with a hand
    Pantograph machine_;
    Exploration plan_{};
    JointAngles angles_{};
    JointAngles from_{};  ///< where the hand set off
    JointAngles aim_{};   ///< where to
    Vec2 place_{};        ///< the same in the plane, where it lets go
    Vec2 gain_{1.0};
    Vec2 torque_{};
    Act act_ = Act::free;
    double time_ = 0.0;  ///< s in the present act
};

}  // namespace palpate::engine

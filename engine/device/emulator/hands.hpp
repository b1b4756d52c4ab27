#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <utility>

#include "engine/device/emulator/haply_board.hpp"
#include "engine/device/emulator/port_board.hpp"
#include "engine/device/hand_path.hpp"
#include "engine/device/pantograph.hpp"
#include "engine/device/simulated_gantry.hpp"
#include "engine/device/simulated_pantograph.hpp"

namespace palpate::engine {

/// A hand that takes the handle of an emulated five-bar machine from place to place, without jumps.
class GlidingHand : public BoardPlant {
public:
    static constexpr double kRest = 3.0;   ///< s at home, or at the start
    static constexpr double kGlide = 1.5;  ///< s from where it is to there

    [[nodiscard]] double angle(std::size_t axis) const noexcept override { return angles_[axis]; }
    [[nodiscard]] const JointAngles& angles() const noexcept { return angles_; }

protected:
    /// A new act begins here and now.
    void set_off() noexcept;
    /// At rest at both ends. @return it is there
    bool glide(const JointAngles& to, double seconds = kGlide) noexcept;
    /// Where the handle truly is, object frame, m; (0, 0) where its angles are of no pose.
    [[nodiscard]] static Vec2 place_of(const Pantograph& machine,
                                       const JointAngles& angles) noexcept;

    JointAngles angles_{};
    double time_ = 0.0;  ///< s in the present act

private:
    JointAngles from_{};  ///< where it began
};

/// A firm hand on the handle of an emulated machine that stands on a desk: no torque moves it.
/// Whenever a board is set up it has brought the handle home; it rests there, goes over to the
/// start, explores the object, comes home, and so on. It rests nowhere but at home, so that a
/// driver that waits for a resting handle finds it there.
class DeskHand : public GlidingHand {
public:
    /// Home is Calibration::home, and without one the pose of count 0.
    /// @throws std::invalid_argument if the linkage cannot be there, or cannot reach the start
    explicit DeskHand(const Calibration& machine, const Exploration& plan = {});

    void set_torque(const Vec3& newton_metres) noexcept override { torque_ = newton_metres; }
    void advance(double seconds) noexcept override;
    void before_set_up() noexcept override;

    /// Where the handle truly is, object frame, m.
    [[nodiscard]] Vec2 hip() const noexcept { return place_of(pantograph_, angles_); }
    [[nodiscard]] Vec3 torque() const noexcept { return torque_; }

private:
    enum class Act : std::uint8_t { waits, rests, goes, explores, comes };

    void turn_to(Act act) noexcept;

    Pantograph pantograph_;
    HandPath path_;
    JointAngles home_{};
    JointAngles start_{};
    Vec3 torque_{};
    Act act_ = Act::waits;
};

/// `plant` with this hand on its handle.
[[nodiscard]] inline PlantModel held_by(PlantModel plant, const HandModel& hand) {
    plant.hand = hand;
    return plant;
}

/// The handle of an emulated machine on a desk that nobody holds, so that motors move it and
/// friction stops it, until a hand takes it.
///
/// A hand that explores takes the handle over to the start, rests there, strokes over the object
/// and gives way as the hand of a SimulatedPantograph does, comes back to the start, and so on.
class FreeHandle : public GlidingHand {
public:
    /// At rest at `place`. @throws std::invalid_argument if it is out of reach
    FreeHandle(const PlantModel& plant, const Vec2& place);

    static constexpr double kBring = 0.4;  ///< s of a hand that brings it somewhere

    /// Somebody brings it there, on a way without a jump, and lets go.
    /// @throws std::invalid_argument if it is out of reach
    void bring(const Vec2& place);
    /// The same at once: it lies there. For who watches no way.
    void put(const Vec2& place);
    [[nodiscard]] bool on_its_way() const noexcept { return act_ == Act::brings; }
    /// From now on a hand holds it where it is, or nobody does.
    void hold(bool held);
    /// A hand takes it where it is, and explores. @throws std::invalid_argument for a start out of
    /// reach
    void explore(const Exploration& plan);

    /// What its motors give from now on, times what they are asked for; of each.
    [[nodiscard]] Vec2& gain() noexcept { return gain_; }

    void set_torque(const Vec3& newton_metres) noexcept override;
    void advance(double seconds) noexcept override;

private:
    enum class Act : std::uint8_t { free, held, brings, comes, rests, strokes };

    void turn_to(Act act) noexcept;

    PantographPlant plant_;   ///< nobody's
    PantographPlant stroke_;  ///< with a hand
    Pantograph machine_;
    Exploration plan_{};
    JointAngles aim_{};  ///< where the hand takes it
    Vec2 place_{};       ///< the same in the plane, where it lets go
    Vec2 gain_{1.0};
    Vec2 torque_{};
    Act act_ = Act::free;
};

/// The handle of an emulated machine of three straight axes, on a board: held by a hand, or free.
///
/// The hand brings the handle home whenever the board is set up; it rests there, explores the patch
/// about the origin, comes home, and so on. It gives way as the hand of a SimulatedGantry does.
class GantryHand : public BoardPlant {
public:
    static constexpr double kRest = 3.0;    ///< s at home
    static constexpr double kSettle = 0.5;  ///< s, after the way home
    static constexpr double kSpeed = 0.4;   ///< m/s on a way without strokes, 0.6 midway

    /// @param machine  with a gantry
    /// @param held     false: nobody holds the handle, and motors move it
    /// @throws std::invalid_argument for a machine without a gantry
    explicit GantryHand(const Calibration& machine, bool held = true);

    /// Somebody brings the handle there and lets go, m, or where a hand holds it keeps it there.
    /// Takes 0.1 s for 40 mm. @throws std::invalid_argument outside the workspace
    void bring(const Vec3& place);
    [[nodiscard]] bool on_its_way() const noexcept { return aim_.has_value(); }
    /// What its motors give from now on, times what they are asked for; of each.
    [[nodiscard]] Vec3& gain() noexcept { return gain_; }
    /// The cables of two motors change places. @param one, other  below 3
    void swap_motors(std::size_t one, std::size_t other) noexcept {
        std::swap(moves_[one], moves_[other]);
    }
    /// It rubs and weighs so much from now on, N. @throws std::invalid_argument as
    /// GantryPlant::burden
    void burden(double friction, double weight) { plant_.burden(friction, weight); }
    [[nodiscard]] const GantryModel& model() const noexcept { return plant_.model(); }
    /// From now on a hand holds it where it is, until the board is set up again, or nobody does.
    void hold(bool held);
    /// A hand takes it home, and explores.
    void explore();

    void set_torque(const Vec3& newton_metres) noexcept override;
    void advance(double seconds) noexcept override;
    /// rad from home
    [[nodiscard]] double angle(std::size_t axis) const noexcept override;
    void before_set_up() noexcept override;

    /// Where the handle truly is, object frame, m.
    [[nodiscard]] const Vec3& hip() const noexcept { return aim_ ? place_ : plant_.position(); }

private:
    void glide_to(const Vec3& place) noexcept;
    void glide(double seconds) noexcept;
    void put(const Vec3& place) noexcept;

    GantrySpec machine_;
    bool held_;
    GantryPlant plant_;
    Vec3 force_{};  ///< N, of the motors
    Vec3 gain_{1.0};
    std::array<std::size_t, 3> moves_{0, 1, 2};  ///< which axis each motor moves
    double rested_ = 0.0;                        ///< s at home
    double settled_ = 0.0;                       ///< s after the way home
    bool explores_ = false;
    bool keeps_ = false;         ///< the hand that holds it stands still
    std::optional<Vec3> aim_{};  ///< a hand brings it there
    Vec3 from_{};
    Vec3 place_{};       ///< on that way
    double time_ = 0.0;  ///< s since it set off
};

}  // namespace palpate::engine

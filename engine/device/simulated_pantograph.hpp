#pragma once

#include <optional>

#include "engine/device/calibration.hpp"
#include "engine/device/device.hpp"
#include "engine/device/hand_path.hpp"
#include "engine/device/pantograph.hpp"

namespace palpate::engine {

/// The hand that holds the handle: a mass on the handle, and spring and damper to where it means to
/// be.
struct HandModel {
    double mass = 0.100;       ///< kg that move with the handle
    double stiffness = 300.0;  ///< N/m towards the intention
    double damping = 8.0;      ///< N s/m
    double strength = 4.0;     ///< N, the most that the spring pulls: it explores gently
};

/// On a handle that is free.
inline constexpr HandModel kNobody{.mass = 0.0, .stiffness = 0.0, .damping = 0.0, .strength = 0.0};

/// Numbers of a machine that moves. The defaults are of the Mk-II's class.
struct PlantModel {
    PantographSpec machine{};       ///< linkage, frame and torque limits; its encoders are not used
    Vec2 inertia{1.0e-4, 1.0e-4};   ///< kg m^2 of each driven link with its motor, > 0
    Vec2 damping{14e-3, 14e-3};     ///< N m s/rad at each motor, >= 0
    Vec2 coulomb{1.0e-3, 1.0e-3};   ///< N m of dry friction at each motor, >= 0
    double current_time = 0.15e-3;  ///< s, time constant of the motor current; 0: at once
    double handle_mass = 0.060;     ///< kg, handle and free links lumped at the handle, >= 0
    double handle_damping = 0.0;    ///< N s/m at the handle: a plate, a sleeve, air, >= 0
    double handle_friction = 0.0;   ///< N of dry friction at the handle, against its way, >= 0
    HandModel hand{};
};

/// A five-bar linkage with motors, friction and a hand, in continuous time: torque in, angles out.
///
/// In joint angles q:
///
///     (I + m J^T J) q'' = tau - B q' - f_c sgn q' + J^T (F_hand - b v - f v/|v| - m c),   v = J q'
///     tau' = (clamped command - tau) / current_time
///
/// exact for driven links of inertia I and a point mass m at the handle; c is the handle's
/// acceleration at q'' = 0, from the second derivative of the links' lengths. Sub-steps of at most
/// 250 us: half a drift, a kick, half a drift. The kick takes damping by the trapezoidal rule, c by
/// Kahan's, and dry friction implicitly: a joint that the other torques cannot break loose stands
/// still exactly. The current is exact. Second order, and the same numbers at every tick rate of
/// which 250 us is a whole part. Deterministic to the bit.
class PantographPlant {
public:
    /// Holds the handle at the start of the default exploration, or at home where that is out of
    /// reach. @throws std::invalid_argument for a number outside its range
    explicit PantographPlant(const PlantModel& model);

    /// Puts the handle at the start of a new exploration, at rest, motors off.
    /// @throws std::invalid_argument if the linkage cannot reach the start
    void begin(const Exploration& plan);

    /// Commands both motors; holds until the next command. Each is clamped to its limit; what is
    /// not a number is 0.
    void set_torque(const Vec2& newton_metres) noexcept;
    /// Lets time pass: nothing for 0, less, or what is not a number; at most 1 s a call.
    void advance(double seconds) noexcept;

    [[nodiscard]] JointAngles angles() const noexcept { return angles_; }  ///< rad
    [[nodiscard]] Vec2 rates() const noexcept { return rates_; }           ///< rad/s
    /// Torque of the motors now, N m, after their current has followed.
    [[nodiscard]] Vec2 torque() const noexcept { return torque_; }
    /// The hand has done all its sweeps and left the object.
    [[nodiscard]] bool hand_is_done() const noexcept { return time_ >= path_.duration(); }
    /// The linkage came to a singular pose: it stands still from then on.
    [[nodiscard]] bool lost() const noexcept { return lost_; }
    /// Seconds that the exploration takes.
    [[nodiscard]] double duration() const noexcept { return path_.duration(); }
    /// The model as it was given.
    [[nodiscard]] const PlantModel& model() const noexcept { return model_; }

private:
    [[nodiscard]] bool rests() const noexcept;
    void step(const Vec2& torque, const HandPath::Intention& aim) noexcept;
    void follow(const HandPath::Intention& aim) noexcept;
    void take_steps() noexcept;

    /// How a span is cut into steps, and what is the same in each.
    struct Steps {
        Steps(double span, const PlantModel& model) noexcept;

        double span;  ///< s
        int count;
        double h;           ///< s, of one
        double half;        ///< of it
        double left = 0.0;  ///< of the current's distance to the command after a step
        double mean = 0.0;  ///< of it, during the step
        double turning;     ///< h m, m handle and hand together
        double less;        ///< m - b h / 2
        double more;        ///< m + b h / 2
        Vec2 less_turned;   ///< I - B h / 2
        Vec2 more_turned;   ///< I + B h / 2
        Vec2 rub;           ///< h f_c
    };

    PlantModel model_;
    Steps steps_;  ///< of the last span
    ObjectFrame frame_;
    HandPath path_;
    JointAngles angles_{};
    Vec2 rates_{};
    Vec2 command_{};
    Vec2 torque_{};
    double time_ = 0.0;  ///< s of the exploration
    bool lost_ = false;
};

/// Numbers of the simulated machine and hand.
struct PantographModel {
    PlantModel plant{};
    int delay_ticks = 1;  ///< 0 or 1: a torque written at one tick acts from the next one on
};

/// A five-bar pantograph and the hand that holds it, as one device on a virtual clock.
///
/// What a real one would do between two ticks: the torques are rounded to DAC codes and limited,
/// act a tick late, are held over the tick (zero-order hold) and filtered by the motors' current;
/// HIP is what the rounded encoder counts say. See engine/device/simulated_pantograph.hpp for the
/// mechanics.
class SimulatedPantograph : public Device {
public:
    /// @param period  s between ticks, > 0
    /// @throws std::invalid_argument for a number outside its range
    SimulatedPantograph(const PantographModel& model, double period);

    /// Puts the handle at the start of a new exploration, at rest.
    /// @throws std::invalid_argument if the linkage cannot reach the start
    void begin(const Exploration& plan);
    /// True once the hand has done all its sweeps and left the object.
    [[nodiscard]] bool hand_is_done() const noexcept { return plant_.hand_is_done(); }
    /// Seconds that the exploration takes.
    [[nodiscard]] double duration() const noexcept { return plant_.duration(); }

    [[nodiscard]] Reading read() noexcept override;
    AppliedForce write(const Vec3& force) noexcept override;
    [[nodiscard]] std::string name() const override { return "simulated pantograph"; }
    /// The damping is of the joints alone: dry friction and hand come on top.
    [[nodiscard]] DeviceTraits traits() const noexcept override { return traits_; }
    [[nodiscard]] std::optional<double> weakest_force(const Vec3& hip) const noexcept override {
        return machine_.weakest_force(Vec2(hip));
    }
    [[nodiscard]] std::optional<double> reading_error(const Vec3& hip) const noexcept override {
        return machine_.reading_error(Vec2(hip));
    }

private:
    Pantograph machine_;
    PantographPlant plant_;
    double period_;
    bool delayed_;
    DeviceTraits traits_{};
    std::optional<Pantograph::Fix> fix_;  ///< of the last reading
    Vec2 waiting_{};                      ///< N m, acts from the next write on
    bool first_ = true;
};

/// The least damping at the handle that its own and that of the joints give, N s/m: the smallest
/// eigenvalue of b + J^-T B J^-1 on a grid of 5 mm over the study's 80 x 60 mm, as far as they can
/// be reached.
[[nodiscard]] double min_handle_damping(const PlantModel& model);

}  // namespace palpate::engine

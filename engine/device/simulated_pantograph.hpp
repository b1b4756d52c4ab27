#pragma once

#include "engine/device/device.hpp"
#include "engine/device/five_bar.hpp"
#include "engine/device/hand_path.hpp"

namespace palpate::engine {

/// Numbers of the simulated machine and hand. Mk-II class: 65,536 counts a turn, about 10 N.
struct PantographModel {
    FiveBar linkage{};
    Vec2 origin{0.0125, 0.050};  ///< the object frame's origin in the linkage's frame, m
    double counts_per_turn = 65536.0;
    double torque_limit = 0.6;          ///< N m at each motor
    double codes_full_scale = 32767.0;  ///< DAC code of the torque limit
    double link_inertia = 1.0e-4;       ///< kg m^2 of each driven link with its motor
    double joint_damping = 3.0e-3;      ///< N m s/rad; about 0.8 N s/m at the handle, above K T / 2
    double handle_mass = 0.060;         ///< kg, handle and free links lumped at the handle
    double hand_mass = 0.100;           ///< kg of the hand that moves with the handle
    double hand_stiffness = 300.0;      ///< N/m towards the intention
    double hand_damping = 8.0;          ///< N s/m
    double hand_strength =
        4.0;  ///< N, the most the hand pulls towards its intention: it explores gently
};

/// A five-bar pantograph and the hand that holds it, as one device on a virtual clock.
///
/// In joint angles q:  (I + m J^T J) q'' = tau - b q' + J^T (F_hand - m J' q'), exact for driven links
/// of inertia I and a point mass m at the handle; J' q' by a backward difference over the sub-step.
/// Semi-implicit Euler in 10 sub-steps a tick. The torque is held over the tick (zero-order hold),
/// rounded to DAC codes and limited; HIP is what the rounded encoder counts say.
class SimulatedPantograph : public Device {
public:
    /// @param period  s between ticks, > 0
    SimulatedPantograph(const PantographModel& model, double period);

    /// Puts the handle at the start of a new exploration, at rest.
    /// @throws std::invalid_argument if the linkage cannot reach the start
    void begin(const Exploration& plan);
    /// True once the hand has done all its sweeps and left the object.
    [[nodiscard]] bool hand_is_done() const noexcept;
    /// Seconds that the exploration takes.
    [[nodiscard]] double duration() const noexcept { return path_.duration(); }

    [[nodiscard]] Reading read() noexcept override;
    Applied write(const Vec2& force) noexcept override;
    [[nodiscard]] std::string name() const override { return "simulated pantograph"; }

private:
    [[nodiscard]] JointAngles measured() const noexcept;
    void integrate(double dt) noexcept;

    PantographModel model_;
    double period_;
    HandPath path_;
    JointAngles angles_{};
    Vec2 rates_{};   ///< rad/s
    Vec2 torque_{};  ///< N m, as held since the last write
    Jacobian last_jacobian_{};
    double time_ = 0.0;  ///< s of the exploration
    bool first_ = true;
    bool lost_ = false;  ///< the linkage came to a singular pose: reads fail from then on
};

}  // namespace palpate::engine

#pragma once

#include <optional>

#include "engine/device/device.hpp"
#include "engine/device/pantograph.hpp"
#include "engine/device/pantograph_plant.hpp"

namespace palpate::engine {

/// Numbers of the simulated machine and hand.
struct PantographModel {
    PlantModel plant{};
    int delay_ticks = 1;  ///< 0 or 1: a torque written at one tick acts from the next one on
};

/// A five-bar pantograph and the hand that holds it, as one device on a virtual clock.
///
/// What a real one would do between two ticks: the torques are rounded to DAC codes and limited,
/// act a tick late, are held over the tick (zero-order hold) and filtered by the motors' current;
/// HIP is what the rounded encoder counts say. See engine/device/pantograph_plant.hpp for the
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

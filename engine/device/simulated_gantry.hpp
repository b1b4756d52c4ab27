#pragma once

#include "engine/device/device.hpp"
#include "engine/device/gantry_plant.hpp"

namespace palpate::engine {

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

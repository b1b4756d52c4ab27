#pragma once

#include "engine/device/emulator/haply_board.hpp"
#include "engine/device/pantograph_plant.hpp"

namespace palpate::engine {

/// `plant` without a hand on its handle.
[[nodiscard]] inline PlantModel nobody_holds(PlantModel plant) {
    plant.hand = {.mass = 0.0, .stiffness = 0.0, .damping = 0.0, .strength = 0.0};
    return plant;
}

/// The handle of an emulated machine on a desk that nobody holds: motors move it, friction stops it.
class FreeHandle : public BoardPlant {
public:
    /// At rest at `place`. @throws std::invalid_argument if it is out of reach
    FreeHandle(const PlantModel& plant, const Vec2& place) : plant_(nobody_holds(plant)) {
        bring(place);
    }

    /// Somebody brings it there and lets go. @throws std::invalid_argument if it is out of reach
    void bring(const Vec2& place) { plant_.begin({.start = place, .tremor = 0.0}); }

    /// From now on its motors give `gain` times what they are told to.
    void strengthen(double gain) noexcept { gain_ = gain; }

    void set_torque(const Vec2& newton_metres) noexcept override {
        plant_.set_torque(gain_ * newton_metres);
    }
    void advance(double seconds) noexcept override { plant_.advance(seconds); }
    [[nodiscard]] JointAngles angles() const noexcept override { return plant_.angles(); }

private:
    PantographPlant plant_;
    double gain_ = 1.0;
};

}  // namespace palpate::engine

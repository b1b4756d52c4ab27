#include "protocols/running/emulated_haply_apparatus.hpp"

#include "engine/device/simulated_pantograph.hpp"

namespace palpate::protocols {
namespace {

engine::PlantModel plant_of(const engine::Calibration& machine) {
    engine::PlantModel plant;
    plant.machine = machine.pantograph;
    return plant;
}

/// The machine as its driver knows it: the simulated hand holds the handle where explorations start when
/// the board is set up, and by how much the emulated joints damp is known.
engine::Calibration as_emulated(engine::Calibration machine) {
    machine.home = engine::Exploration{}.start;
    machine.pantograph.damping = least_handle_damping(plant_of(machine));
    return machine;
}

engine::MakeHand hand_on(const engine::Calibration& machine) {
    return [plant = plant_of(machine)] {
        return std::make_unique<engine::HandOf<engine::PantographPlant>>(plant);
    };
}

}  // namespace

EmulatedHaplyApparatus::EmulatedHaplyApparatus(const Protocol& protocol,
                                               DrawnHand hand,
                                               const engine::Calibration& machine,
                                               double spin_share)
    : hand_(std::move(hand)),
      haply_(as_emulated(machine), hand_on(machine), {.period = 1.0 / protocol.apparatus.rate_hz}),
      servo_(haply_.device(), servo_spec(protocol, haply_.device(), spin_share)) {}

void EmulatedHaplyApparatus::begin(const engine::Scene& scene, const PlannedTrial& planned) {
    servo_.park();  // the handle is put at its start: no reading of ours may fall in between
    haply_.begin(hand_.at(planned.position));
    servo_.begin(scene);
}

std::string EmulatedHaplyApparatus::device_name() const {
    return "emulated " + haply_.device().name();
}

}  // namespace palpate::protocols

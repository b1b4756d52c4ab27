#include "protocols/trial/emulated_haply_apparatus.hpp"

#include <limits>

#include "engine/device/simulated_pantograph.hpp"

namespace palpate::protocols {
namespace {

engine::PlantModel plant_of(const engine::Calibration& machine) {
    engine::PlantModel plant;
    plant.machine = machine.pantograph;
    return plant;
}

/// The machine as its driver knows it: the simulated hand holds the handle where explorations start
/// when the board is set up, and by how much the emulated joints damp is known.
engine::Calibration as_emulated(engine::Calibration machine) {
    machine.home = engine::Exploration{}.start;
    machine.pantograph.damping = min_handle_damping(plant_of(machine));
    return machine;
}

/// An emulated board runs when the system lets it, and hurts nobody: a machine that is busy makes
/// ticks late and readings stale, which are counted, and does not spoil trials.
constexpr double kBoardSilence = 5.0;  // s
constexpr engine::GuardTiming kGuard{.wait_ms = 5, .patience = 1000, .alive_ms = 5000};

engine::ServoSpec patient(engine::ServoSpec spec) {
    spec.limits.late_run = 0;
    spec.limits.late_share = 0;
    spec.limits.quiet_run = 0;
    spec.limits.silent_run = 0;  // the driver's own silence is left
    spec.limits.spare_delay = std::numeric_limits<double>::infinity();
    spec.limits.screen_silence = std::numeric_limits<double>::infinity();
    return spec;
}

engine::MakeHand hand_on(const engine::Calibration& machine) {
    return [plant = plant_of(machine)] {
        return std::make_unique<engine::HandOf<engine::PantographPlant>>(plant);
    };
}

}  // namespace

engine::EmulatedHaply emulated_haply(const engine::Calibration& machine,
                                     double period,
                                     const std::string& link) {
    return {as_emulated(machine),
            hand_on(machine),
            {.period = period, .silence = kBoardSilence},
            kGuard,
            link};
}

EmulatedHaplyApparatus::EmulatedHaplyApparatus(const Protocol& protocol,
                                               DrawnHand hand,
                                               const engine::Calibration& machine,
                                               double spin_share,
                                               const std::string& link)
    : ServoApparatus(servo_),
      hand_(std::move(hand)),
      haply_(emulated_haply(machine, 1.0 / protocol.apparatus.rate_hz, link)),
      servo_(haply_.device(), patient(servo_spec(protocol, haply_.device(), spin_share))) {}

void EmulatedHaplyApparatus::begin(const engine::SceneView& scene,
                                   std::size_t position,
                                   std::size_t interval) {
    servo_.park();  // the handle is put at its start: no reading of ours may fall in between
    haply_.begin(hand_.at(position, interval));
    servo_.begin(scene);
}

}  // namespace palpate::protocols

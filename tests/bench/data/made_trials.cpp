#include "tests/bench/data/made_trials.hpp"

#include "protocols/design/session_plan.hpp"
#include "protocols/file/protocol_file.hpp"
#include "protocols/library/shipped.hpp"
#include "protocols/trial/servo_apparatus.hpp"
#include "protocols/trial/trial_scene.hpp"

namespace palpate::bench {
namespace {

constexpr double kMeanLateness = 8000.0;  // ns

void pop_all(engine::TickRing& ring, std::vector<engine::TickRecord>& ticks) {
    std::array<engine::TickRecord, 256> buffer{};
    while (const std::size_t n = ring.pop(buffer)) {
        ticks.insert(ticks.end(), buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(n));
    }
}

}  // namespace

MadeStudy made_study() {
    MadeStudy study;
    for (const protocols::ShippedProtocol& shipped : protocols::shipped_protocols()) {
        if (shipped.name == "shape_friction") {
            study.protocol = protocols::parse_protocol(shipped.text, "shape_friction");
        }
    }
    study.hash = protocols::protocol_hash(study.protocol);
    study.key = {.participant = "bench", .secret = std::string(32, 'b')};
    study.plan = make_plan(study.protocol, study.hash, study.key, study.protocol.seed);
    return study;
}

std::vector<engine::TickRecord> made_trial(const MadeStudy& study,
                                           std::size_t position,
                                           double seconds) {
    const protocols::Protocol& protocol = study.protocol;
    const protocols::PlannedTrial& planned = study.plan.trials.at(position);
    engine::SimulatedPantograph device({}, 1.0 / protocol.apparatus.rate_hz);
    engine::VirtualServo servo(device, protocols::servo_spec(protocol, device));
    engine::Exploration hand =
        protocols::DrawnHand(protocol, study.hash, study.key, protocol.seed).at(position);
    hand.sweeps = static_cast<int>(seconds);  // each takes more than a second
    const engine::Scene scene = make_scene(protocol, planned.condition);
    device.begin(hand);
    servo.begin(scene);
    std::vector<engine::TickRecord> ticks;
    while (servo.elapsed_s() < seconds && servo.advance() == engine::ServoStatus::running) {
        pop_all(servo.ring(), ticks);
    }
    servo.end();
    pop_all(servo.ring(), ticks);
    Pcg32 random = protocols::stream({.protocol_hash = study.hash,
                                      .participant = "bench",
                                      .block = position,
                                      .purpose = "lateness",
                                      .seed = 1});
    for (engine::TickRecord& tick : ticks) {
        const double share = (static_cast<double>(random.next()) + 0.5) * 0x1p-32;
        tick.lateness_us = static_cast<float>(std::floor(-kMeanLateness * std::log(share)) * 1e-3);
    }
    return ticks;
}

}  // namespace palpate::bench

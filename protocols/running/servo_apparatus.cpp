#include "protocols/running/servo_apparatus.hpp"

#include <stdexcept>

#include "engine/math/elementary.hpp"
#include "protocols/design/streams.hpp"

namespace palpate::protocols {
namespace {

/// Uniform in [0, 1) with 32 bits: exact in double.
double unit(Pcg32& random) {
    return static_cast<double>(random.next()) * 0x1p-32;
}

}  // namespace

engine::ServoSpec servo_spec(const ApparatusSpec& apparatus) {
    return {
        .rate_hz = apparatus.rate_hz,
        .limits = {.most = apparatus.force_limit,
                   .ramp_step = engine::ramp_step(apparatus.force_ramp, 1.0 / apparatus.rate_hz)}};
}

SimulatedApparatus::SimulatedApparatus(const Protocol& protocol,
                                       std::string protocol_hash,
                                       SessionKey key,
                                       std::uint64_t seed,
                                       double pace)
    : protocol_(protocol),
      protocol_hash_(std::move(protocol_hash)),
      key_(std::move(key)),
      seed_(seed),
      device_(engine::PantographModel{}, 1.0 / protocol.apparatus.rate_hz),
      servo_(device_, servo_spec(protocol.apparatus), pace) {}

engine::Exploration SimulatedApparatus::exploration(const PlannedTrial& planned) const {
    Pcg32 random = stream({.protocol_hash = protocol_hash_,
                           .participant = key_.participant,
                           .session = key_.session,
                           .block = planned.position,
                           .purpose = "hand",
                           .seed = seed_});
    engine::Exploration plan{.start = protocol_.apparatus.start,
                             .a = protocol_.outline.a,
                             .vertex = protocol_.outline.vertex,
                             .b = protocol_.outline.b};
    plan.speed = 0.065 + 0.030 * unit(random);          // 65 to 95 mm/s
    plan.press_depth = 0.0085 + 0.0015 * unit(random);  // 8.5 to 10 mm: reaches into every object
    plan.sweeps = 3 + static_cast<int>(random.bounded(3));
    plan.tremor_phase = 2.0 * engine::kPi * unit(random);
    return plan;
}

void SimulatedApparatus::begin(const engine::Scene& scene, const PlannedTrial& planned) {
    device_.begin(exploration(planned));
    servo_.begin(scene);
}

ReplayApparatus::ReplayApparatus(const Protocol& protocol,
                                 std::vector<Recording> recordings,
                                 std::string source,
                                 double pace)
    : recordings_(std::move(recordings)),
      source_(std::move(source)),
      servo_(device_, servo_spec(protocol.apparatus), pace) {
    if (recordings_.empty()) {
        throw std::invalid_argument(source_ + " holds no recorded trial to replay");
    }
    for (const Recording& recording : recordings_) {
        if (recording.empty()) {
            throw std::invalid_argument(source_ +
                                        " holds a trial without ticks: name another trial");
        }
    }
}

void ReplayApparatus::begin(const engine::Scene& scene, const PlannedTrial& planned) {
    device_.begin(recordings_[planned.position % recordings_.size()]);
    servo_.begin(scene);
}

bool ReplayApparatus::exhausted() const noexcept {
    // The recording's last ticks are its ramp out: leave them for ours.
    return static_cast<std::int64_t>(device_.left()) <= servo_.ramp_ticks();
}

PointerApparatus::PointerApparatus(const Protocol& protocol)
    : servo_(device_, servo_spec(protocol.apparatus)) {
    device_.publish(protocol.apparatus.start);
}

void PointerApparatus::begin(const engine::Scene& scene, const PlannedTrial& /*planned*/) {
    servo_.begin(scene);
}

}  // namespace palpate::protocols

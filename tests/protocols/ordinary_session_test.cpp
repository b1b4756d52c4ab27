#include "protocols/file/protocol_file.hpp"
#include "protocols/library/shipped.hpp"
#include "protocols/trial/servo_apparatus.hpp"
#include "protocols/trial/trial_scene.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"
#include "tests/support/scenes.hpp"

using namespace palpate::protocols;

namespace {

struct Seen {
    std::int64_t ticks = 0;
    std::int64_t contact = 0;
    std::int64_t slewed = 0;
    engine::Trip trip = engine::Trip::none;
    double max_energy = 0.0;  ///< J
};

/// A trial of the simulated hand of `speed` m/s, with all limits of the protocol for a device that
/// gives force. The ticks go through a second chain, to see its energy.
Seen feel(const Protocol& protocol, const Condition& condition, double speed, Random& random) {
    const double period = 1.0 / protocol.apparatus.rate_hz;
    engine::SimulatedPantograph device({}, period);
    device.begin({.start = protocol.apparatus.start,
                  .a = protocol.outline.a,
                  .vertex = protocol.outline.vertex,
                  .b = protocol.outline.b,
                  .speed = speed,
                  .press_depth = random.in(0.0085, 0.010),
                  .sweeps = 5,
                  .tremor_phase = random.in(0.0, 2.0 * engine::kPi)});
    engine::ServoSpec spec = servo_spec(protocol, device);
    spec.limits.speed = protocol.safety.speed_limit;  // also where the device counts as harmless
    spec.limits.energy = protocol.safety.energy_limit;
    spec.limits.watch_encoders = true;
    spec.limits.watch_runaway = true;
    spec.limits.watch_buzz = true;
    const engine::Scene scene = make_scene(protocol, condition);
    engine::TickLoop loop(device, spec.limits);
    loop.begin(scene);
    engine::SafetyState second;
    Seen seen;
    for (std::int64_t k = 0; !device.hand_is_done() && loop.trip() == engine::Trip::none; ++k) {
        const auto tick = loop.tick(
            {.time_ns = static_cast<std::int64_t>(static_cast<double>(k) * period * 1e9)});
        const bool free = tick.mode == engine::Mode::free;
        static_cast<void>(
            make_safe(second, spec.limits,
                      {.force = tick.force,
                       .spring = free ? engine::Vec3{} : tick.go - tick.hip,
                       .depth = free ? 0.0 : tick.normal_force / protocol.apparatus.stiffness,
                       .hip = tick.hip,
                       .counts = tick.counts,
                       .time_ns = tick.time_ns}));
        ++seen.ticks;
        seen.contact += free ? 0 : 1;
        seen.slewed += (tick.flags & engine::tick_force_slew) != 0 ? 1 : 0;
        seen.max_energy = std::max(seen.max_energy, second.energy.energy);
    }
    seen.trip = loop.trip();
    return seen;
}

}  // namespace

TEST_CASE("ordinary exploration of the shipped studies trips nothing and is hardly ever slewed") {
    const auto& shipped = GENERATE(from_range(shipped_protocols()));
    const double speed = GENERATE(0.065, 0.2, 0.4);
    CAPTURE(shipped.name, speed);
    const Protocol protocol = parse_protocol(shipped.text, "shipped");
    if (protocol.surface) {
        return;  // its scenes are in space, and this machine is not
    }
    Random random(7);
    Seen all;
    for (std::size_t object = 0; object < protocol.objects.size(); ++object) {
        for (std::size_t friction = 0; friction < protocol.frictions.size(); ++friction) {
            CAPTURE(object, friction);
            const Seen seen = feel(protocol, {object, friction}, speed, random);
            CHECK((seen.trip == engine::Trip::none));
            all.ticks += seen.ticks;
            all.contact += seen.contact;
            all.slewed += seen.slewed;
            all.max_energy = std::max(all.max_energy, seen.max_energy);
        }
    }
    CHECK(all.contact > all.ticks / 10);
    // Measured: none in 398,000 ticks of contact, and 7.5 mJ of the 100 allowed. The stress test,
    // which is no study, drops friction to a fifth at once: 0.6 % of its ticks.
    const double max = shipped.name == "stress" ? 1e-2 : 1e-3;
    CHECK(static_cast<double>(all.slewed) < max * static_cast<double>(all.contact));
    CHECK(all.max_energy < 0.1 * protocol.safety.energy_limit);
}

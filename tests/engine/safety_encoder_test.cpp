#include "engine/device/pantograph.hpp"
#include "tests/engine/chain.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

namespace {

/// A small classroom pantograph: links of 70 and 90 mm, 4,880 counts a turn, 0.1 mm a count.
Pantograph coarse() {
    PantographSpec spec;
    spec.linkage = {
        .driven_1 = 0.07, .driven_2 = 0.07, .free_1 = 0.09, .free_2 = 0.09, .base = 0.038};
    spec.axes[0].counts_per_turn = 4880.0;
    spec.axes[1].counts_per_turn = 4880.0;
    spec.origin = {0.019, 0.095};
    return Pantograph(spec);
}

/// The part of its workspace that hands explore here, object frame, m.
constexpr Vec2 kLow{-0.025, -0.015};
constexpr Vec2 kHigh{0.025, 0.020};

/// What its encoders say with the handle at `hip`.
Pantograph::Counts counts_at(const Pantograph& device, const Vec2& hip) {
    return device.counts(device.reach(hip).value());
}

/// What the chain is told with the handle at `hip`.
SafetyInput input_at(const Pantograph& device, const Vec2& hip) {
    const auto counts = counts_at(device, hip);
    return {.hip = Vec3(device.locate(device.angles(counts)).value().hip, 0.0), .counts = counts};
}

/// A slow hand that follows a circle of `radius` about `middle`, to and fro, with the tremor of a
/// healthy hand (tens of micrometres at 9 Hz).
Vec2 on_arc(const Vec2& middle, double radius, double from, double to, double t) {
    const double angle =
        from + (to - from) * 0.5 * (1.0 - std::cos(2.0 * std::numbers::pi * 0.1 * t));
    const double tremor = 3e-5 * std::sin(2.0 * std::numbers::pi * 9.0 * t);
    return middle + (radius + tremor) * Vec2{std::cos(angle), std::sin(angle)};
}

}  // namespace

TEST_CASE("coarse encoders under a slow hand are never taken for stuck") {
    SEEDED(random, std::uint64_t{30});
    const Pantograph device = coarse();
    Chain chain{{.ramp_step = 1.0, .watch_encoders = true}};
    // 20 s at 1 kHz, at 1 to 100 % of an ordinary hand's speed.
    const double period = 1e-3 * random.decade(-2.0, 0.0);
    for (const Vec2& hip : random_hand(seed, 20000, kLow, kHigh, period)) {
        chain(input_at(device, hip));
    }
    CHECK((chain.state.trip == Trip::none));
}

TEST_CASE("a hand led along an arc is not taken for a stuck encoder") {
    SEEDED(random, std::uint64_t{30});
    const Pantograph device = coarse();
    Chain chain{{.ramp_step = 1.0, .watch_encoders = true}};
    const double radius = random.in(0.05, 0.2);  // 90 mm would be a free link's circle
    const Vec2 foot{random.in(-0.01, 0.01), random.in(-0.015, 0.005)};
    const double outward = random.in(0.0, 2.0 * std::numbers::pi);
    const Vec2 middle = foot - radius * Vec2{std::cos(outward), std::sin(outward)};
    const double half = 0.025 / radius;  // 50 mm to and fro
    for (int k = 0; k < 20000; ++k) {
        const Vec2 hip = on_arc(middle, radius, outward - half, outward + half, k * 1e-3);
        chain(input_at(device, hip));
    }
    CHECK((chain.state.trip == Trip::none));
}

TEST_CASE("an encoder that stands still trips within 80 mm of the hand's strokes") {
    const auto seed = GENERATE(seeds(std::uint64_t{20}));
    const std::size_t axis = GENERATE(0U, 1U);
    CAPTURE(seed, axis);
    Random random(seed);
    const Pantograph device = coarse();
    Chain chain{{.ramp_step = 1.0, .watch_encoders = true}};
    const auto when = static_cast<std::size_t>(random.in(100.0, 10000.0));
    const auto hand = random_hand(seed, 60000, kLow, kHigh, 1e-3);
    const std::int32_t kept = counts_at(device, hand[when])[axis];
    Vec2 from{};  // of a stroke
    double way = 0.0;
    for (std::size_t k = 0; k < hand.size() && way < 0.08; ++k) {
        auto counts = counts_at(device, hand[k]);
        counts[axis] = k >= when ? kept : counts[axis];
        const auto fix = device.locate(device.angles(counts));
        if (!fix) {
            return;  // no pose: the device itself says so
        }
        const double stroke = glm::length(fix->hip - from);
        if (k < when || stroke > kStroke) {
            way += k < when ? 0.0 : stroke;
            from = fix->hip;
        }
        const Trip trip = chain.trip({.hip = Vec3(fix->hip, 0.0), .counts = counts});
        if (trip != Trip::none) {
            CHECK((trip == Trip::stuck_encoder));
            CHECK(k > when);
            return;
        }
    }
    CHECK(way < 0.08);
}

TEST_CASE("a finger that scrubs to and fro on a spot is not taken for a stuck encoder") {
    Chain chain{{.ramp_step = 1.0, .watch_encoders = true}};
    for (int k = 0; k < 100000; ++k) {  // 8 mm to and fro, one axis alone: a tangent of its circle
        const std::int32_t other = 40 - std::abs(k % 160 - 80);
        chain({.hip = {1e-4 * other, 0.0, 0.0}, .counts = {7, other}});
    }
    CHECK((chain.state.trip == Trip::none));
}

TEST_CASE("encoders that all stand still under a force end it within 0.3 s, whatever the force") {
    SEEDED(random, std::uint64_t{40});
    const int axes = random.coin() ? 2 : 3;
    Chain chain{{.ramp_step = random.decade(-3.0, 0.0), .watch_encoders = true, .axes = axes}};
    const auto dead = static_cast<int>(random.in(100.0, 3000.0));
    const Vec3 force = random.in(1.01 * kStillForce, 9.0) * glm::normalize(Vec3(1.0, -2.0, 0.5));
    int pressed = 0;  // ticks since the force was above what counts, or since the encoders died
    for (int k = 0; k < 8000; ++k) {
        const std::int32_t count = std::min(k, dead) / 20;  // 50 counts a second until then
        const Command command = chain({.force = force, .counts = {7, count, -3}});
        const bool strong = glm::length(command.force) > kStillForce;
        pressed = k > dead && (strong || pressed > 0) ? pressed + 1 : 0;
        if (command.trip != Trip::none) {
            CHECK((command.trip == Trip::stuck_encoder));
            CHECK(k > dead);
            return;
        }
        REQUIRE(pressed <= 301);
    }
    FAIL("the force never ended");
}

TEST_CASE("a hand that rests within a count keeps its force, which eases until it moves one") {
    SEEDED(random, std::uint64_t{60});
    const Pantograph device = coarse();
    Chain chain{{.ramp_step = random.decade(-2.3, 0.0), .watch_encoders = true}};
    const double stiffness = random.decade(2.0, 3.0);  // of the hand, N/m, without any tremor
    const double angle = random.in(0.0, 2.0 * std::numbers::pi);
    const Vec3 force =
        random.in(1.1 * kStillForce, 5.0) * Vec3{std::cos(angle), std::sin(angle), 0.0};
    const Vec2 rest{random.in(-0.02, 0.02), random.in(-0.01, 0.015)};
    Vec2 hip = rest;
    int full = 0;
    for (int k = 0; k < 10000; ++k) {
        SafetyInput input = input_at(device, hip);
        input.force = force;
        const Command command = chain(input);
        REQUIRE((command.trip == Trip::none));
        full += command.force == force ? 1 : 0;
        hip += 0.1 * (rest + Vec2(command.force) / stiffness - hip);  // 10 ms to give way
    }
    CHECK(full > 4000);
}

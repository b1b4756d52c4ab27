#include "engine/realtime/thread_servo.hpp"
#include "engine/rendering/scene.hpp"
#include "engine/safety/motion_watch.hpp"
#include "stimuli/two_curve.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/child.hpp"

// While nothing is felt a handle is watched as in a trial: what no hand does is kept, and the next
// trial gives no force for it.

using namespace palpate::engine;

namespace {

constexpr SafetyLimits kLimits{.speed = 1.5, .jump = 0.010};
constexpr std::int64_t kTick = 1'000'000;

/// Readings at ticks of a millisecond.
class Rest {
public:
    Trip at(double x, bool fresh = true, DeviceFault fault = DeviceFault::none) {
        return took(x, 0, fresh, fault);
    }
    Trip took(double x, std::int64_t ns, bool fresh = true, DeviceFault fault = DeviceFault::none) {
        now_ += kTick;
        Reading reading{.hip = {x, 0.06, 0.0}};
        reading.fresh = fresh;
        reading.fault = fault;
        return watch_rest(watch_, kLimits, reading, now_, now_ + ns);
    }
    void pass(std::int64_t ticks) { now_ += ticks * kTick; }

private:
    RestWatch watch_;
    std::int64_t now_ = 77;
};

/// A handle that lies where it is put.
class Lying : public Device {
public:
    Reading read() noexcept override {
        ++reads;
        return {.hip = {x.load(), 0.06, 0.0}};
    }
    AppliedForce write(const Vec3& force) noexcept override {
        forces += force == Vec3{} ? 0 : 1;
        return {};
    }
    std::string name() const override { return "lying"; }

    std::atomic<double> x{0.0};
    std::atomic<int> reads{0};
    std::atomic<int> forces{0};
};

}  // namespace

TEST_CASE("while nothing is felt a jump and a speed that no hand has are found, and no hand is") {
    Rest hand;  // 1.4 m/s
    for (int i = 0; i < 1000; ++i) {
        REQUIRE(hand.at(1.4e-3 * i) == Trip::none);
    }
    CHECK(hand.at(1.4 + 0.0105) == Trip::jump);
    CHECK(hand.at(1.4 + 0.0105) == Trip::none);  // once

    Rest slides;
    Trip found = Trip::none;
    for (int i = 0; i < 30 && found == Trip::none; ++i) {
        found = slides.at(2e-3 * i);
    }
    CHECK(found == Trip::over_speed);
}

TEST_CASE("where a hand went unseen it may have gone at its speed, and a rest begins where it is") {
    Rest rest;
    for (int i = 0; i < 20; ++i) {  // what was read before the rest is given again
        REQUIRE(rest.at(-0.1, false) == Trip::none);
    }
    CHECK(rest.at(0.0) == Trip::none);
    const DeviceFault fault = GENERATE(DeviceFault::none, DeviceFault::unreachable);
    for (int i = 0; i < 30; ++i) {
        REQUIRE(rest.at(0.0, fault != DeviceFault::none, fault) == Trip::none);
    }
    CHECK(rest.at(0.040) == Trip::none);  // 1.3 m/s
    for (int i = 0; i < 30; ++i) {
        REQUIRE(rest.at(0.040) == Trip::none);
    }
    // Kept from its turn while it read, the thread does not know when that was.
    CHECK(rest.took(0.040, 20 * kTick) == Trip::none);
    rest.pass(1);
    CHECK(rest.took(0.055, 40 * kTick) == Trip::none);
    CHECK(rest.at(0.070) == Trip::none);
    CHECK(rest.at(0.081) == Trip::jump);
}

TEST_CASE(
    "an encoder that jumps between trials ends the next one in its first tick, with no force") {
    Lying device;
    ThreadServo servo(device, {.limits = {.ramp_step = 1.0, .speed = 1.5, .jump = 0.010},
                               .realtime = RealtimeWish::nothing()});
    const Scene scene(palpate::stimuli::make_outline({.curvature = 5.0}), {.stiffness = 200.0});
    const auto reads = [&](int more) {
        return eventually([&, from = device.reads.load()] { return device.reads > from + more; });
    };
    servo.unpark();
    REQUIRE(reads(30));
    servo.park();
    device.x = 0.05;  // somebody brought it there, and nobody looked
    servo.unpark();
    REQUIRE(reads(30));
    CHECK(servo.moved() == Trip::none);
    device.x = 0.08;
    CHECK(eventually([&] { return servo.moved() == Trip::jump; }));

    servo.begin(scene);
    CHECK(eventually([&] { return servo.advance() == ServoStatus::faulted; }));
    servo.end();
    CHECK(servo.trip() == Trip::jump);
    CHECK(servo.moved() == Trip::none);  // it was said
    CHECK(device.forces == 0);
    servo.begin(scene);
    REQUIRE(reads(30));
    CHECK(servo.advance() == ServoStatus::running);
    servo.end();
    REQUIRE(reads(30));

    device.x = 0.02;
    CHECK(eventually([&] { return servo.moved() == Trip::jump; }));
    servo.forget_move();
    REQUIRE(reads(30));
    CHECK(servo.moved() == Trip::none);
}

#include "engine/device/simulated_pantograph.hpp"
#include "engine/realtime/thread_servo.hpp"
#include "engine/rendering/scene.hpp"
#include "stimuli/two_curve.hpp"
#include "tests/support/catch.hpp"

using namespace palpate::engine;

namespace {

/// A hundred times what the motors bear for ever, from a hand at rest.
class Pressed : public Device {
public:
    Reading read() noexcept override { return {.hip = {-0.021, 0.017, 0.0}}; }
    AppliedForce write(const Vec3& /*force*/) noexcept override {
        return {.load = {100.0, 30.0, 0.0}};
    }
    [[nodiscard]] std::string name() const override { return "pressed"; }
};

Scene rest_scene() {
    return {stimuli::make_outline({.curvature = 5.0}), {}};
}

/// 1 ms of a thermal time constant of 1000 s: theta grows by 100^2 / 1e6 a tick, cold motors last
/// 100 ticks.
constexpr double kHeatStep = 1e-6;
constexpr std::size_t kColdTicks = 100;

ServoSpec spec() {
    return {.limits = {.ramp_step = 1.0, .heat_step = kHeatStep},
            .realtime = RealtimeWish::nothing()};
}

/// Ticks of a trial up to its trip.
std::size_t ticks_to_the_trip(Servo& servo, const Scene& felt) {
    servo.begin(felt);
    std::size_t ticks = 0;
    std::array<TickRecord, 64> buffer;
    const auto take = [&] {
        while (const std::size_t n = servo.ring().pop(buffer)) {
            ticks += n;
        }
    };
    while (servo.advance() == ServoStatus::running) {
        take();
    }
    servo.end();
    take();
    CHECK(servo.trip() == Trip::overheated);
    return ticks;
}

}  // namespace

TEST_CASE("motors that tripped by heat are still hot in the next trial of a real-time servo") {
    Pressed device;
    ThreadServo servo(device, spec());
    const Scene felt = rest_scene();
    CHECK(ticks_to_the_trip(servo, felt) >= kColdTicks);
    for (int trial = 0; trial < 3; ++trial) {  // to cool by half takes 690 s
        CHECK(ticks_to_the_trip(servo, felt) < kColdTicks / 2);
    }
}

TEST_CASE("parking and reading between trials cool no motor faster than time does") {
    Pressed device;
    ThreadServo servo(device, spec());
    const Scene felt = rest_scene();
    CHECK(ticks_to_the_trip(servo, felt) >= kColdTicks);
    servo.park();
    servo.unpark();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    servo.park();
    CHECK(ticks_to_the_trip(servo, felt) < kColdTicks / 2);
}

TEST_CASE(
    "on the virtual clock every trial begins cold, so that a resumed session gives the same") {
    Pressed device;
    VirtualServo servo(device, spec());
    const Scene felt = rest_scene();
    const std::size_t first = ticks_to_the_trip(servo, felt);
    CHECK(first >= kColdTicks);
    CHECK(ticks_to_the_trip(servo, felt) == first);
}

TEST_CASE("a ring gives back what was pushed, in order, between two threads") {
    SpscRing<int> ring(64);
    CHECK_THROWS_WITH(SpscRing<int>(48), Has("power of two", "48"));
    constexpr int kCount = 200'000;
    std::thread producer([&] {
        for (int i = 0; i < kCount;) {
            i += ring.push(i) ? 1 : 0;
        }
    });
    std::array<int, 17> buffer{};
    int next = 0;
    while (next < kCount) {
        const std::size_t n = ring.pop(buffer);
        for (std::size_t k = 0; k < n; ++k) {
            REQUIRE(buffer[k] == next++);
        }
    }
    producer.join();
    for (int i = 0; i < 64; ++i) {
        CHECK(ring.push(i));
    }
    CHECK_FALSE(ring.push(64));
}

TEST_CASE("a servo rate outside 1 to 10 kHz is refused with the value") {
    SimulatedPantograph device({}, 1e-3);
    CHECK_THROWS_WITH(VirtualServo(device, {.rate_hz = 500.0}), Has("500", "1000 to 10000"));
}

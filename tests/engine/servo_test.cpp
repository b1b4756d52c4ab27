#include <cstring>

#include "engine/device/simulated_pantograph.hpp"
#include "engine/realtime/thread_servo.hpp"
#include "engine/rendering/scene.hpp"
#include "stimuli/two_curve.hpp"
#include "tests/support/allocations.hpp"
#include "tests/support/catch.hpp"

using namespace palpate;
using namespace palpate::engine;

namespace {

Scene scene() {
    return {stimuli::make_outline({.curvature = 5.0}),
            {.friction = {.mu_s = 0.7, .mu_d = 0.5, .tau_slip = 0.02, .tau_heal = 0.1},
             .slew = {.speed = 0.2, .radius = 0.003}}};
}

std::vector<TickRecord> drain(TickRing& ring) {
    std::vector<TickRecord> all;
    std::array<TickRecord, 100> buffer;
    while (const std::size_t n = ring.pop(buffer)) {
        all.insert(all.end(), buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(n));
    }
    return all;
}

std::vector<TickRecord> simulated_trial() {
    SimulatedPantograph device({}, 1e-3);
    VirtualServo servo(device, {.limits = {.max_force = 10.0, .ramp_step = ramp_step(0.2, 1e-3)}});
    const Scene felt = scene();
    device.begin({});
    servo.begin(felt);
    std::vector<TickRecord> all;
    const auto take = [&] {
        const std::vector<TickRecord> some = drain(servo.ring());
        all.insert(all.end(), some.begin(), some.end());
    };
    while (!device.hand_is_done()) {
        REQUIRE(servo.advance() == ServoStatus::running);
        take();
    }
    servo.end();
    take();
    CHECK(servo.dropped() == 0);
    return all;
}

class BrokenDevice : public Device {
public:
    Reading read() noexcept override {
        return {.hip = {0.0, 0.03, 0.0},
                .fault = ++reads_ < 50 ? DeviceFault::none : DeviceFault::lost};
    }
    AppliedForce write(const Vec3& force) noexcept override {
        last_ = force;
        return {};
    }
    std::string name() const override { return "broken"; }
    Vec3 last_{};

private:
    int reads_ = 0;
};

}  // namespace

TEST_CASE("ticks come in order, without gaps, and a simulated trial repeats to the bit",
          "[servo][law]") {
    const std::vector<TickRecord> first = simulated_trial();
    const std::vector<TickRecord> second = simulated_trial();
    REQUIRE(first.size() > 4000);
    REQUIRE(first.size() == second.size());
    for (std::size_t i = 0; i < first.size(); ++i) {
        REQUIRE(first[i].tick == static_cast<std::int64_t>(i));
        REQUIRE(first[i].time_ns == static_cast<std::int64_t>(i) * 1'000'000);
        REQUIRE(std::memcmp(&first[i].force, &second[i].force, sizeof(Vec2)) == 0);
        REQUIRE(first[i].counts == second[i].counts);
    }
    CHECK(glm::length(first.back().command) < 1e-12);  // ramped out
}

TEST_CASE("the recorded forces come back to the bit from the recorded HIP alone", "[servo][law]") {
    const std::vector<TickRecord> trace = simulated_trial();
    const Scene felt = scene();
    ContactState state;
    for (const TickRecord& tick : trace) {
        const Contact c = felt.tick(state, Vec2(tick.hip));
        REQUIRE(std::memcmp(&c.force, &tick.force, sizeof(Vec2)) == 0);
        REQUIRE(std::memcmp(&c.go, &tick.go, sizeof(Vec2)) == 0);
        REQUIRE(c.mode == tick.mode);
    }
}

TEST_CASE("a device that fails faults the servo: zero force, latched", "[servo][law]") {
    BrokenDevice device;
    VirtualServo servo(device, {.limits = {.ramp_step = 1.0}});
    const Scene felt = scene();
    servo.begin(felt);
    ServoStatus status = ServoStatus::running;
    for (int i = 0; i < 20 && status == ServoStatus::running; ++i) {
        status = servo.advance();
    }
    CHECK(status == ServoStatus::faulted);
    CHECK(device.last_ == Vec3{});
    servo.end();
    const std::vector<TickRecord> all = drain(servo.ring());
    CHECK((all.back().flags & tick_fault) != 0);
    CHECK(all.back().command == Vec3{});
    servo.begin(felt);  // the next trial starts clean
    CHECK((servo.advance() == ServoStatus::faulted));
}

TEST_CASE("the servo's tick allocates nothing", "[servo][law]") {
    SimulatedPantograph device({}, 1e-3);
    TickLoop loop(device, {});
    const Scene felt = scene();
    loop.begin(felt);
    const std::size_t before = tests::allocations();
    for (std::int64_t k = 0; k < 5000; ++k) {
        static_cast<void>(loop.tick({.time_ns = k * 1'000'000}));
    }
    CHECK(tests::allocations() == before);
}

TEST_CASE("the real-time servo runs on its own thread, keeps order and ends with zero force",
          "[servo]") {
    class Steady : public Device {
    public:
        Reading read() noexcept override { return {.hip = {-0.021, 0.017, 0.0}}; }
        AppliedForce write(const Vec3& force) noexcept override {
            last_ = force;
            return {};
        }
        std::string name() const override { return "steady"; }
        Vec3 last_{1.0};
    } steady;
    ThreadServo servo(steady, {.limits = {.ramp_step = ramp_step(0.02, 1e-3)},
                               .realtime = RealtimeWish::nothing()});
    const Scene felt = scene();
    std::int64_t ticks = 0;
    for (int trial = 0; trial < 2; ++trial) {
        servo.begin(felt);
        while (servo.elapsed_s() < 0.1) {
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
            REQUIRE(servo.advance() == ServoStatus::running);
        }
        servo.end();
        servo.park();  // the device is this thread's now
        CHECK(steady.last_ == Vec3{});
        const std::vector<TickRecord> all = drain(servo.ring());
        for (std::size_t i = 0; i < all.size(); ++i) {
            REQUIRE(all[i].tick == static_cast<std::int64_t>(i));
        }
        ticks += static_cast<std::int64_t>(all.size());
    }
    CHECK(ticks > 0);
}

TEST_CASE("a ring gives back what was pushed, in order, between two threads", "[servo][law]") {
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

TEST_CASE("a servo rate outside 1 to 10 kHz is refused with the value", "[servo]") {
    SimulatedPantograph device({}, 1e-3);
    CHECK_THROWS_WITH(VirtualServo(device, {.rate_hz = 500.0}), Has("500", "1000 to 10000"));
}

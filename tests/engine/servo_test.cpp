#include "engine/device/simulated_pantograph.hpp"
#include "engine/realtime/thread_servo.hpp"
#include "tests/support/catch.hpp"

using namespace palpate::engine;

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

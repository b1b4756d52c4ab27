#include "engine/device/pointer_device.hpp"
#include "engine/device/replay_device.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

TEST_CASE("a pointer is read where it was published, to 5 nm") {
    PointerDevice device;
    Random random(1);
    for (int i = 0; i < 1000; ++i) {
        const Vec2 p = random.point(-2.0, 2.0);
        device.publish(p);
        CHECK(glm::length(Vec2(device.read().hip) - p) < 1e-8);
    }
    CHECK(device.read().ok());
}

TEST_CASE("a pointer read while it moves is never half old and half new") {
    PointerDevice device;
    std::atomic<bool> stop{false};
    std::thread window([&] {
        for (int i = 0; !stop.load(); ++i) {
            const double v = (i % 1000) * 1e-4;
            device.publish({v, -v});
        }
    });
    for (int i = 0; i < 200'000; ++i) {
        const Vec3 hip = device.read().hip;
        REQUIRE(hip.x == -hip.y);
    }
    stop = true;
    window.join();
}

TEST_CASE("a replay gives back the readings, then rests") {
    ReplayDevice device;
    CHECK_FALSE(device.read().ok());
    device.begin({{.hip = {1.0, 0.0, 0.0}}, {.hip = {2.0, 0.0, 0.0}, .counts = {3, 4}}});
    CHECK(device.left() == 2);
    CHECK(device.read().hip.x == 1.0);
    CHECK(device.read().counts[1] == 4);
    CHECK(device.at_end());
    CHECK(device.read().hip.x == 2.0);
    CHECK(device.read().ok());
}

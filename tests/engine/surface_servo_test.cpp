#include <cstring>

#include "engine/realtime/felt_scene.hpp"
#include "engine/realtime/servo.hpp"
#include "engine/surface/surface_scene.hpp"
#include "tests/support/catch.hpp"

using namespace palpate::engine;

namespace {

/// A hand that goes where it is sent; what it is pressed by is kept.
class ScriptedHand : public Device {
public:
    std::vector<Vec3> way;
    std::vector<Vec3> pressed;

    [[nodiscard]] Reading read() noexcept override {
        return {.hip = way[std::min(next_++, way.size() - 1)]};
    }
    AppliedForce write(const Vec3& force) noexcept override {
        pressed.push_back(force);
        return {};
    }
    [[nodiscard]] std::string name() const override { return "sent hand"; }

private:
    std::size_t next_ = 0;
};

/// A plane at height 0, 200 mm wide, in two spans along u.
SurfaceScene wall(double stiffness, const Friction& friction) {
    const std::vector<std::vector<Vec3>> points{{{-0.1, -0.1, 0.0}, {-0.1, 0.1, 0.0}},
                                                {{0.02, -0.1, 0.0}, {0.02, 0.1, 0.0}},
                                                {{0.1, -0.1, 0.0}, {0.1, 0.1, 0.0}}};
    const auto surface = std::make_shared<const NurbsSurface>(
        1, 1, std::vector<double>{0, 0, 1, 2, 2}, std::vector<double>{0, 0, 1, 1}, points);
    return {surface, SceneSpec{.stiffness = stiffness, .friction = friction}};
}

/// Strokes of some mm at random, down to 4 mm below the wall.
std::vector<Vec3> strokes(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> side{-0.03, 0.03};
    std::uniform_real_distribution<double> height{-0.004, 0.002};
    std::vector<Vec3> way{{0.0, 0.0, 0.002}};
    for (int leg = 0; leg < 12; ++leg) {
        const Vec3 from = way.back();
        const Vec3 to(side(random), side(random), height(random));
        const int ticks = 1 + static_cast<int>(glm::length(to - from) / 2e-4);
        for (int k = 1; k <= ticks; ++k) {
            way.push_back(from + (to - from) * (static_cast<double>(k) / ticks));
        }
    }
    return way;
}

SafetyLimits limits_of(double max, double slew) {
    return {.max_force = max, .ramp_step = 1.0, .slew = slew, .speed = 1.0, .jump = 0.01};
}

}  // namespace

TEST_CASE(
    "in space the force is K times the depth, within the limit and its slew in all three "
    "coordinates, and every tick is computed again from HIP alone",
    "[servo][surface][law]") {
    const auto seed = GENERATE(palpate::tests::seeds(30U));
    CAPTURE(seed);
    const Friction friction = seed % 2 == 0 ? Friction{} : Friction{0.6, 0.4, 0.02, 0.1};
    const SurfaceScene scene = wall(1000.0, friction);
    const double max = seed % 3 == 0 ? 2.0 : 10.0;
    const double slew =  // the strokes change a force by 0.2 N a tick
        seed % 5 == 0 ? 0.05 : std::numeric_limits<double>::infinity();
    ScriptedHand hand;
    hand.way = strokes(seed);
    TickLoop loop(hand, limits_of(max, slew));
    loop.begin(scene);
    std::vector<TickRecord> ticks;
    for (std::size_t k = 0; k < hand.way.size(); ++k) {
        ticks.push_back(loop.tick({.time_ns = static_cast<std::int64_t>(k) * 1'000'000}));
    }
    REQUIRE(loop.trip() == Trip::none);
    REQUIRE(hand.pressed.size() == ticks.size());
    Vec3 last{};
    double hardest = 0.0;
    for (std::size_t k = 0; k < ticks.size(); ++k) {
        const TickRecord& tick = ticks[k];
        const Vec3 hip = hand.way[k];
        REQUIRE(tick.hip == hip);
        // The wall's own law: the spring along z, friction within its cone.
        REQUIRE(std::fabs(tick.force.z - 1000.0 * std::fmax(0.0, -hip.z)) < 1e-9);
        REQUIRE(glm::length(Vec2(tick.force)) <= tick.mu * tick.force.z + 1e-9);
        REQUIRE((friction.none() ? glm::length(Vec2(tick.force)) < 1e-9 : true));
        const Vec3& command = tick.command;
        REQUIRE(command == hand.pressed[k]);
        REQUIRE(glm::length(command) <= max * (1.0 + 1e-12));
        REQUIRE(glm::length(command - last) <= slew * (1.0 + 1e-9));
        const double strength = glm::length(tick.force);
        REQUIRE((slew < 1.0 || glm::length(command - tick.force * (strength > max ? max / strength
                                                                                  : 1.0)) < 1e-12));
        last = command;
        hardest = std::fmax(hardest, tick.force.z);
    }
    CHECK(hardest > 1.0);
    std::vector<TickRecord> again(ticks.size());
    for (std::size_t k = 0; k < ticks.size(); ++k) {
        again[k] = ticks[k];
        again[k].go = again[k].force = Vec3{};
        again[k].u = again[k].v = again[k].mu = 0.0;
        again[k].normal_force = again[k].tangential_force = 0.0;
        again[k].mode = Mode::free;
    }
    FeltState state;
    set_contacts(again, scene, state);
    for (std::size_t k = 0; k < ticks.size(); ++k) {
        REQUIRE(std::memcmp(&again[k], &ticks[k], sizeof(TickRecord)) == 0);
    }
}

TEST_CASE("up counts as much as to the side: what is too fast, jumps or is no number trips",
          "[servo][surface][safety]") {
    const SurfaceScene scene = wall(1000.0, {});
    const auto trip_of = [&](double from, double to, std::size_t ticks) {
        ScriptedHand hand;
        for (std::size_t k = 0; k < 200; ++k) {
            const double share =
                static_cast<double>(std::min(k, ticks)) / static_cast<double>(ticks);
            hand.way.emplace_back(0.0, 0.0, from + (to - from) * share);
        }
        TickLoop loop(hand, limits_of(10.0, 5.0));
        loop.begin(scene);
        for (std::size_t k = 0; k < hand.way.size(); ++k) {
            const TickRecord tick =
                loop.tick({.time_ns = static_cast<std::int64_t>(k) * 1'000'000});
            if (loop.trip() != Trip::none) {
                CHECK(hand.pressed.back() == Vec3{});
                CHECK(tick.command.z == 0.0);
                CHECK(std::isfinite(tick.hip.z));
            }
        }
        return loop.trip();
    };
    CHECK(trip_of(0.05, 0.01, 100) == Trip::none);        // 0.4 m/s
    CHECK(trip_of(0.20, 0.05, 100) == Trip::over_speed);  // 1.5 m/s
    CHECK(trip_of(0.05, 0.02, 1) == Trip::jump);
    CHECK(trip_of(0.05, std::numeric_limits<double>::quiet_NaN(), 1) == Trip::device_garbage);
}

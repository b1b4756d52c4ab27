#include "tests/support/catch.hpp"
#include "tests/support/pressed_wall.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

namespace {

using Machine = std::array<Vec2, 2>;

/// What a 2DIY of the third generation at 135 and 20 degrees makes of a force when its motors get
/// the torques of `wrong`: F' = J^-T W J^T F. J: the table of published kinematics, m/rad.
Machine miswired(const Machine& wrong) {
    constexpr double a = -0.046895835131;
    constexpr double b = -0.024700450478;
    constexpr double c = -0.056329734687;
    constexpr double d = 0.064866749038;
    const double det = a * d - b * c;
    const auto felt = [&](const Vec2& force) {
        const Vec2 torque{a * force.x + c * force.y, b * force.x + d * force.y};
        const Vec2 got = torque.x * wrong[0] + torque.y * wrong[1];
        return Vec2{(d * got.x - c * got.y) / det, (a * got.y - b * got.x) / det};
    };
    return {felt({1.0, 0.0}), felt({0.0, 1.0})};
}

const Machine kBoth = miswired({Vec2{-1.0, 0.0}, Vec2{0.0, -1.0}});
const Machine kFirst = miswired({Vec2{-1.0, 0.0}, Vec2{0.0, 1.0}});
const Machine kSecond = miswired({Vec2{1.0, 0.0}, Vec2{0.0, -1.0}});
const Machine kSwapped = miswired({Vec2{0.0, 1.0}, Vec2{1.0, 0.0}});
const double kHalf = std::sqrt(0.5);

PressedWall pressed(const Machine& machine, const Vec2& side, double hand, double press) {
    return {.hand_k = hand,
            .hand_b = hand / 40.0,
            .press = press,
            .normal = side,
            .machine = machine,
            .limits = {.max_force = 1.5, .ramp_step = 0.005, .watch_runaway = true}};
}

}  // namespace

TEST_CASE("motors that pull the wrong way end the force within 50 ms once it is full",
          "[safety][law]") {
    SEEDED(random, std::uint64_t{40});
    // Of a light hand to one that just gives way: 200 N/m pull against it.
    const double hand = seed == 0 ? 60.0 : random.in(50.0, 180.0);
    const double press = random.in(0.008, 0.012);
    for (const Vec2& side : {Vec2{-kHalf, kHalf}, Vec2{kHalf, kHalf}}) {
        const auto course = pressed(kBoth, side, hand, press).run(3.0);
        CHECK((course.trip == Trip::runaway));
        CHECK(course.tripped_s - course.full_s <= 0.050);
        CHECK(course.command == 0.0);
    }
}

TEST_CASE("a reversed or swapped motor is found on one side of an object at least",
          "[safety][law]") {
    SEEDED(random, std::uint64_t{40});
    const double hand = seed == 0 ? 60.0 : random.in(50.0, 120.0);
    for (const Machine& machine : {kFirst, kSecond, kSwapped}) {
        int found = 0;
        for (const Vec2& side : {Vec2{-kHalf, kHalf}, Vec2{kHalf, kHalf}}) {
            const auto course = pressed(machine, side, hand, 0.016).run(3.0);
            found += course.trip == Trip::runaway ? 1 : 0;
        }
        CHECK(found >= 1);
    }
}

TEST_CASE("on a right machine no hand that keeps its pace trips it, however hard it presses",
          "[safety][law]") {
    SEEDED(random, std::uint64_t{60});
    PressedWall wall = pressed(Machine{Vec2{1.0, 0.0}, Vec2{0.0, 1.0}}, {0.0, 1.0},
                               random.in(60.0, 600.0), random.in(0.0, 0.04));
    wall.approach = random.in(0.02, 0.4);
    wall.stiffness = random.in(100.0, 400.0);
    CHECK((wall.run(3.0).trip == Trip::none));
}

namespace {

/// Whether a handle trips that comes at `came` m/s and from `at` m on goes on at `on` m/s, by a
/// command that is full from there on or never, read once a ms in steps of 0.1 mm.
bool trips(double came, double on, double at, bool full = true) {
    RunawayWatch watch;
    double y = 0.05;
    for (int k = 0; k < 3000 && y > -0.1; ++k) {
        y -= 1e-3 * (y > -at ? came : on);
        const double read = std::floor(y / 1e-4 + 0.5) * 1e-4;
        const double depth = std::fmax(0.0, -read);
        if (runs_away(watch, full && depth >= at, depth, {0.0, read, 0.0}, 1e-3 * k)) {
            return true;
        }
    }
    return false;
}

}  // namespace

TEST_CASE("what is faster than it came, by the share and the speed that count, is a runaway",
          "[safety][law]") {
    SEEDED(random, std::uint64_t{100});
    const double came = random.in(0.03, 0.5);
    const double count = 0.0002 / kRunawayStretch;  // of either end, m/s
    const double least = std::fmax(kRunawaySpeed, kRunawayShare * came) + 2.5 * count;
    const double at = random.in(0.002, 0.010);
    CHECK(trips(came, least + random.in(0.0, 0.5), at));
    CHECK_FALSE(trips(came, std::fmax(0.02, random.in(0.0, 1.0) * (least - 5.0 * count)), at));
    CHECK_FALSE(trips(came, least + 0.5, at, false));
}

#include "engine/safety/safety_chain.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

namespace {

/// A handle that a hand presses against a flat wall through the origin, rendered without friction
/// and kept safe by the chain: what a commanded force does is what the machine makes of it, a tick
/// later.
struct PressedWall {
    double stiffness = 200.0;  ///< K, N/m
    double handle = 0.12;      ///< kg, with what of the hand moves with it
    double hand_k = 300.0;     ///< N/m to where the hand means to be
    double hand_b = 4.0;       ///< N s/m
    double press = 0.008;      ///< m inside of the wall that it means to be
    double approach = 0.06;    ///< m/s
    Vec2 normal{0.0, 1.0};
    double tap_hz = 0.0;   ///< the hand goes up and down as well
    double tap = 0.0;      ///< m, amplitude
    double step = 0.0001;  ///< m, in which HIP is read
    /// Columns of the matrix from commanded to true force; a right machine's is 1.
    std::array<Vec2, 2> machine{Vec2{1.0, 0.0}, Vec2{0.0, 1.0}};
    SafetyLimits limits{.max_force = 1.5, .ramp_step = 0.005};

    struct Course {
        Trip trip = Trip::none;
        double touched_s = -1.0;  ///< first contact
        double full_s = -1.0;     ///< first command at the limit
        double tripped_s = -1.0;
        double deepest = 0.0;  ///< m
        double command = 0.0;  ///< N, the strongest after a trip
    };

    /// @param seconds  of a trial
    [[nodiscard]] Course run(double seconds) const {
        constexpr double kAway = 0.02;  // m from the wall at the start
        constexpr int kParts = 20;
        SafetyLimits chain = limits;
        chain.stiffness = stiffness;
        SafetyState state;
        Course course;
        Vec2 at = kAway * normal;
        Vec2 velocity{};
        Vec2 waiting{};
        const double period = chain.period;
        for (int k = 0; k * period < seconds; ++k) {
            const double now = k * period;
            const Vec2 hip{std::floor(at.x / step + 0.5) * step,
                           std::floor(at.y / step + 0.5) * step};
            const double depth = std::fmax(0.0, -glm::dot(hip, normal));
            const Vec2 force = stiffness * depth * normal;
            const Command command = make_safe(state, chain,
                                              {.force = Vec3(force, 0.0),
                                               .spring = Vec3(depth * normal, 0.0),
                                               .depth = depth,
                                               .hip = Vec3(hip, 0.0)});
            note(course, command, depth, now, chain.max_force);
            const Vec2 means = intention(now, kAway);
            for (int i = 0; i < kParts; ++i) {
                const Vec2 pull = waiting + hand_k * (means - at) - hand_b * velocity;
                velocity += period / kParts / handle * pull;
                at += period / kParts * velocity;
            }
            waiting = command.force.x * machine[0] + command.force.y * machine[1];
        }
        return course;
    }

private:
    [[nodiscard]] Vec2 intention(double now, double away) const {
        const double down = std::fmin(away + press, approach * std::fmax(0.0, now - 0.1));
        const double swing = tap * std::sin(6.283185307179586 * tap_hz * now);
        return (away - down + swing) * normal;
    }
    static void note(
        Course& course, const Command& command, double depth, double now, double limit) {
        course.deepest = std::fmax(course.deepest, depth);
        course.touched_s = course.touched_s < 0.0 && depth > 0.0 ? now : course.touched_s;
        const double strength = glm::length(command.force);
        course.full_s = course.full_s < 0.0 && strength > 0.999 * limit ? now : course.full_s;
        if (command.trip != Trip::none) {
            course.tripped_s = course.trip == Trip::none ? now : course.tripped_s;
            course.command = std::fmax(course.command, strength);
        }
        course.trip = command.trip;
    }
};

/// When a depth that swings by `swing` m at `hz` for 2 s is called a buzz, s; none: it is not.
double found_at(double hz, double swing, double phase, double period, double step) {
    BuzzWatch watch;
    for (int k = 0; k * period < 2.0; ++k) {
        const double now = k * period;
        const double depth =
            0.5 * swing * (1.0 + std::sin(2.0 * std::numbers::pi * hz * now + phase));
        if (buzzes(watch, std::floor(depth / step + 0.5) * step, now)) {
            return now;
        }
    }
    return -1.0;
}

PressedWall light_hand(double stiffness) {
    return {.stiffness = stiffness,
            .handle = 0.05,
            .hand_k = 100.0,
            .hand_b = 0.5,
            .press = 0.006,
            .limits = {.max_force = 10.0, .ramp_step = 0.005, .watch_buzz = true}};
}

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

TEST_CASE("a swing that is quick and wide enough buzzes within seven periods, a slower one never") {
    SEEDED(random, std::uint64_t{200});
    const double phase = random.in(0.0, 6.28);
    const double period = 1e-3 / (1 + random.below(4));
    const double step = random.decade(-7.0, -4.6);
    const double hz = random.in(kBuzzFrequency + 1.0, 60.0);
    const double swing = 2.0 * step + 1.2 * std::fmax(kBuzzSwing, 0.5 * kBuzzSpeed / hz);
    const double at = found_at(hz, swing, phase, period, step);
    CHECK(at > (kBuzzCycles - 1) / hz);
    CHECK(at <= (kBuzzCycles + 2.0) / hz);
    CHECK(found_at(random.in(0.5, kBuzzFrequency - 1.0), random.in(0.0, 0.02), phase, period,
                   step) < 0.0);
    CHECK(found_at(hz, 0.9 * kBuzzSwing - 2.0 * step, phase, period, step) < 0.0);
}

TEST_CASE("tremor and taps of a hand are no buzz") {
    CHECK(found_at(12.0, 0.0003, 0.0, 1e-3, 1e-5) < 0.0);  // the widest tremor
    CHECK(found_at(8.0, 0.010, 0.0, 1e-3, 1e-4) < 0.0);    // the quickest taps
    CHECK(found_at(18.0, 0.0035, 0.0, 1e-3, 1e-4) > 0.0);  // 0.14 m/s rms: seen on a bench
}

TEST_CASE("a stiff wall under a light hand on a light handle is ended within half a second") {
    SEEDED(random, std::uint64_t{40});
    PressedWall wall = light_hand(1000.0);
    if (seed > 0) {  // the bench's own case, and what is near it
        wall.handle = random.in(0.035, 0.055);
        wall.hand_k = random.in(90.0, 150.0);
        wall.hand_b = random.in(0.2, 0.6);
        wall.press = random.in(0.005, 0.008);
    }
    const auto course = wall.run(3.0);
    CHECK((course.trip == Trip::buzz));
    CHECK(course.tripped_s - course.touched_s <= 0.5);
    CHECK(course.command == 0.0);
}

TEST_CASE("a press at 200 N/m never buzzes, however the handle is held") {
    SEEDED(random, std::uint64_t{60});
    PressedWall wall = light_hand(200.0);
    if (seed > 0) {
        wall.handle = random.in(0.05, 0.3);
        wall.hand_k = random.in(50.0, 500.0);
        wall.hand_b = random.in(0.5, 8.0);
        wall.press = random.in(0.001, 0.015);
        wall.approach = random.in(0.02, 0.4);
        wall.tap_hz = random.in(0.0, 12.0);
        wall.tap = wall.tap_hz < 8.0 ? random.in(0.0, 0.004) : random.in(0.0, 0.00015);
    }
    CHECK((wall.run(3.0).trip == Trip::none));
}

TEST_CASE("a wall that is damped enough rings when it is struck, and is let be") {
    SEEDED(random, std::uint64_t{60});
    PressedWall wall = light_hand(1000.0);
    wall.handle = random.in(0.05, 0.3);
    wall.hand_b = random.in(2.5, 8.0);  // K T (1/2 + d) is 1.5 N s/m
    wall.hand_k = random.in(50.0, 500.0);
    wall.approach = random.in(0.02, 0.4);
    CHECK((wall.run(3.0).trip == Trip::none));
}

TEST_CASE("motors that pull the wrong way end the force within 50 ms once it is full") {
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

TEST_CASE("a reversed or swapped motor is found on one side of an object at least") {
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

TEST_CASE("on a right machine no hand that keeps its pace trips it, however hard it presses") {
    SEEDED(random, std::uint64_t{60});
    PressedWall wall = pressed(Machine{Vec2{1.0, 0.0}, Vec2{0.0, 1.0}}, {0.0, 1.0},
                               random.in(60.0, 600.0), random.in(0.0, 0.04));
    wall.approach = random.in(0.02, 0.4);
    wall.stiffness = random.in(100.0, 400.0);
    CHECK((wall.run(3.0).trip == Trip::none));
}

TEST_CASE("what is faster than it came, by the share and the speed that count, is a runaway") {
    SEEDED(random, std::uint64_t{100});
    const double came = random.in(0.03, 0.5);
    const double count = 0.0002 / kRunawayStretch;  // of either end, m/s
    const double least = std::fmax(kRunawaySpeed, kRunawayShare * came) + 2.5 * count;
    const double at = random.in(0.002, 0.010);
    CHECK(trips(came, least + random.in(0.0, 0.5), at));
    CHECK_FALSE(trips(came, std::fmax(0.02, random.in(0.0, 1.0) * (least - 5.0 * count)), at));
    CHECK_FALSE(trips(came, least + 0.5, at, false));
}

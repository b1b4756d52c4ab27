#include <glm/vec4.hpp>

#include "engine/device/dry_friction.hpp"
#include "engine/device/simulated_pantograph.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"
#include "tests/support/runge_kutta.hpp"

using namespace palpate::engine;

namespace {

constexpr Exploration kStill{.start = {0.010, 0.030}, .speed = 1e-12, .tremor = 0.0};

/// No friction, no lag, nobody at the handle.
PlantModel bare() {
    PlantModel model;
    model.damping = Vec2{};
    model.coulomb = Vec2{};
    model.current_time = 0.0;
    model.handle_mass = 0.16;
    model.hand = {.mass = 0.0, .stiffness = 0.0, .damping = 0.0};
    return model;
}

/// The same machine by Lagrange's equation, from nothing but the handle's place: the kinetic
/// energy's derivatives are differences.
class Lagrangian {
public:
    Lagrangian(const PlantModel& model, const JointAngles& q, const Vec2& aim)
        : model_(model), state_{q[0], q[1], 0.0, 0.0}, aim_(aim) {}

    void advance(double dt, const Vec2& command) {
        const Vec2 away = torque_ - command;  // dies away with the current's time constant
        const auto at = [&](double t) {
            const double left =
                model_.current_time > 0.0 ? std::exp(-t / model_.current_time) : 0.0;
            return command + left * away;
        };
        state_ = palpate::tests::runge_kutta(
            state_, dt, [&](const State& s, double t) { return slope(s, at(t)); });
        torque_ = at(dt);
    }
    [[nodiscard]] double angle(std::size_t i) const { return state_[static_cast<int>(i)]; }

private:
    using State = glm::dvec4;  // both angles, both rates

    /// Intersection of two circles about the elbows.
    [[nodiscard]] Vec2 handle(double q1, double q2) const {
        const FiveBar& link = model_.machine.linkage;
        const Vec2 a{link.driven_1 * std::cos(q1), link.driven_1 * std::sin(q1)};
        const Vec2 b{link.base + link.driven_2 * std::cos(q2), link.driven_2 * std::sin(q2)};
        const double d = std::hypot(b.x - a.x, b.y - a.y);
        const double bearing = std::atan2(b.y - a.y, b.x - a.x);
        const double inner =
            std::acos((link.free_1 * link.free_1 + d * d - link.free_2 * link.free_2) /
                      (2 * link.free_1 * d));
        return {a.x + link.free_1 * std::cos(bearing + inner),
                a.y + link.free_1 * std::sin(bearing + inner)};
    }

    struct Mass {
        double m11, m12, m22;
    };
    [[nodiscard]] Mass mass(double q1, double q2) const {
        const double e = 1e-5;
        const Vec2 d1 = (handle(q1 + e, q2) - handle(q1 - e, q2)) / (2 * e);
        const Vec2 d2 = (handle(q1, q2 + e) - handle(q1, q2 - e)) / (2 * e);
        const double m = model_.handle_mass + model_.hand.mass;
        return {model_.inertia.x + m * glm::dot(d1, d1), m * glm::dot(d1, d2),
                model_.inertia.y + m * glm::dot(d2, d2)};
    }
    [[nodiscard]] double energy(double q1, double q2, const Vec2& v) const {
        const Mass m = mass(q1, q2);
        return 0.5 * (m.m11 * v.x * v.x + 2 * m.m12 * v.x * v.y + m.m22 * v.y * v.y);
    }

    [[nodiscard]] State slope(const State& s, const Vec2& torque) const {
        const double e = 1e-5;
        const Vec2 v{s[2], s[3]};
        const Mass m = mass(s[0], s[1]);
        const Mass up = mass(s[0] + e * v.x, s[1] + e * v.y);
        const Mass down = mass(s[0] - e * v.x, s[1] - e * v.y);
        const Vec2 dm{(up.m11 - down.m11) * v.x + (up.m12 - down.m12) * v.y,
                      (up.m12 - down.m12) * v.x + (up.m22 - down.m22) * v.y};  // times 2 e
        const Vec2 dt{energy(s[0] + e, s[1], v) - energy(s[0] - e, s[1], v),
                      energy(s[0], s[1] + e, v) - energy(s[0], s[1] - e, v)};
        const Vec2 d1 = (handle(s[0] + e, s[1]) - handle(s[0] - e, s[1])) / (2 * e);
        const Vec2 d2 = (handle(s[0], s[1] + e) - handle(s[0], s[1] - e)) / (2 * e);
        const Vec2 pull = model_.hand.stiffness * (aim_ - handle(s[0], s[1])) -
                          model_.hand.damping * (d1 * v.x + d2 * v.y);
        const Vec2 force = torque - model_.damping * v + (dt - dm) / (2 * e) +
                           Vec2{glm::dot(d1, pull), glm::dot(d2, pull)};
        const double det = m.m11 * m.m22 - m.m12 * m.m12;
        return {v.x, v.y, (m.m22 * force.x - m.m12 * force.y) / det,
                (m.m11 * force.y - m.m12 * force.x) / det};
    }

    PlantModel model_;
    State state_;
    Vec2 aim_;
    Vec2 torque_{};
};

/// Of links, handle and hand, J.
double kinetic_energy(const PantographPlant& plant) {
    const PlantModel& model = plant.model();
    const FiveBar& linkage = model.machine.linkage;
    const Vec2 velocity =
        linkage.jacobian(linkage.forward(plant.angles()).value()).value() * plant.rates();
    return 0.5 * (glm::dot(model.inertia * plant.rates(), plant.rates()) +
                  (model.handle_mass + model.hand.mass) * glm::dot(velocity, velocity));
}

}  // namespace

TEST_CASE("the plant moves as Lagrange's equation says") {
    SEEDED(random, std::uint64_t{20});
    PlantModel model = bare();
    FiveBar& linkage = model.machine.linkage;
    linkage = {.driven_1 = random.in(0.055, 0.070),
               .driven_2 = random.in(0.055, 0.070),
               .free_1 = random.in(0.070, 0.085),
               .free_2 = random.in(0.070, 0.085),
               .base = random.in(0.0, 0.030)};
    model.inertia = Vec2{random.in(0.5e-4, 2e-4), random.in(0.5e-4, 2e-4)};
    model.damping = random.point(0.0, 5e-3);
    model.current_time = random.coin() ? random.in(0.2e-3, 2e-3) : 0.0;
    model.hand = {.mass = 0.1, .stiffness = 200.0, .damping = 3.0, .strength = 100.0};
    PantographPlant plant(model);
    plant.begin(kStill);
    Lagrangian truth(model, plant.angles(), kStill.start + model.machine.origin);
    double worst = 0.0;
    double moved = 0.0;
    const JointAngles start = plant.angles();
    for (int tick = 0; tick < 200; ++tick) {
        const Vec2 torque = random.point(-0.3, 0.3);
        plant.set_torque(torque);
        plant.advance(1e-3);
        for (int i = 0; i < 4; ++i) {
            truth.advance(0.25e-3, torque);
        }
        for (std::size_t i = 0; i < 2; ++i) {
            worst = std::max(worst, std::fabs(plant.angles()[i] - truth.angle(i)));
            moved = std::max(moved, std::fabs(plant.angles()[i] - start[i]));
        }
    }
    CHECK_FALSE(plant.lost());
    CHECK(moved > 0.02);
    CHECK(worst < 1e-4 * moved);
}

TEST_CASE("without friction and hand the plant keeps its energy, and gains what the motors give") {
    SEEDED(random, std::uint64_t{30});
    PantographPlant plant(bare());
    plant.begin(kStill);
    plant.set_torque(random.point(-0.1, 0.1));
    double work = 0.0;
    for (int i = 0; i < 200; ++i) {
        const JointAngles before = plant.angles();
        plant.advance(1e-4);
        const JointAngles after = plant.angles();
        work +=
            plant.torque().x * (after[0] - before[0]) + plant.torque().y * (after[1] - before[1]);
    }
    const double energy = kinetic_energy(plant);
    CHECK(std::fabs(work - energy) < 1e-5 * energy);
    plant.set_torque(Vec2{});
    for (int i = 0; i < 60; ++i) {
        plant.advance(1e-3);
        REQUIRE_FALSE(plant.lost());
        CHECK(std::fabs(kinetic_energy(plant) / energy - 1.0) < 1e-4);
    }
}

TEST_CASE("a joint that its motor cannot break loose stands still to the last bit") {
    PlantModel model = bare();
    model.coulomb = Vec2{5e-3, 8e-3};
    PantographPlant plant(model);
    const double rate = GENERATE(1000.0, 3333.0, 10000.0);
    const double share = GENERATE(0.5, 0.999, 1.001, 1.5);
    const double way = GENERATE(1.0, -1.0);
    plant.begin(kStill);
    const JointAngles start = plant.angles();
    plant.set_torque(way * share * model.coulomb);
    for (int i = 0; i < 100; ++i) {
        plant.advance(1.0 / rate);
    }
    CHECK((plant.angles() == start) == (share < 1.0));
    CHECK((plant.rates() == Vec2{}) == (share < 1.0));
    // A joint set in motion comes to rest, and rests.
    plant.set_torque(way * 10.0 * model.coulomb);
    plant.advance(5e-3);
    CHECK(plant.rates() != Vec2{});
    plant.set_torque(way * 0.5 * model.coulomb);
    plant.advance(1.0);
    CHECK(plant.rates() == Vec2{});
    const JointAngles rest = plant.angles();
    plant.advance(1.0);
    CHECK(plant.angles() == rest);
}

TEST_CASE("what nobody holds rests and moves to the bit as in a hand without strength") {
    SEEDED(random, std::uint64_t{40});
    PlantModel model = bare();
    model.coulomb = random.coin() ? random.point(0.0, 2e-3) : Vec2{};
    model.current_time = random.coin() ? 0.15e-3 : 0.0;
    model.handle_friction = random.coin() ? random.in(0.0, 0.02) : 0.0;
    PantographPlant alone(model);
    model.hand = {.mass = 0.0, .stiffness = 1.0, .damping = 0.0, .strength = 0.0};
    PantographPlant weak(model);  // its every step is computed
    alone.begin(kStill);
    weak.begin(kStill);
    for (int i = 0; i < 60; ++i) {
        const Vec2 torque = random.coin() ? random.point(-3e-3, 3e-3) : Vec2{};
        alone.set_torque(torque);
        weak.set_torque(torque);
        alone.advance(0.01);
        weak.advance(0.01);
        CHECK(alone.angles() == weak.angles());
    }
}

TEST_CASE("dry friction opposes every turning joint fully, and a resting one by what it needs") {
    for (std::uint64_t seed = 0; seed < 20000; ++seed) {
        Random random(seed);
        const double a = random.decade(-5.0, -2.0);
        const double b = random.decade(-5.0, -2.0);
        const double c = random.in(-0.999, 0.999) * std::sqrt(a * b);
        const Vec2 right = random.point(-1e-4, 1e-4);
        const Vec2 max{random.coin() ? random.in(0.0, 1e-4) : 0.0, random.in(0.0, 1e-4)};
        const Vec2 rates = after_dry_friction({a, c}, {c, b}, right, max, random.point(-1.0, 1.0));
        const Vec2 friction = Vec2{a * rates.x + c * rates.y, c * rates.x + b * rates.y} - right;
        for (int i = 0; i < 2; ++i) {
            CAPTURE(seed, i, rates[i], friction[i], max[i]);
            const double rounding = 1e-12 * (std::fabs(right.x) + std::fabs(right.y) + 1e-4);
            REQUIRE(std::fabs(friction[i]) <= max[i] + rounding);
            if (rates[i] != 0.0) {
                REQUIRE(std::fabs(friction[i] + std::copysign(max[i], rates[i])) <= rounding);
            }
        }
    }
}

TEST_CASE("the current follows its command as exp(-t / tau), however time is cut") {
    PlantModel model = bare();
    model.current_time = GENERATE(1e-6, 0.15e-3, 2e-3, 0.5);
    PantographPlant plant(model);
    plant.begin(kStill);
    const Vec2 command{0.02, -0.01};
    plant.set_torque(command);
    Random random(1);
    double time = 0.0;
    for (int i = 0; i < 40; ++i) {
        const double step = random.decade(-5.0, -3.0);
        plant.advance(step);
        time += step;
        const double closed = -std::expm1(-time / model.current_time);
        CHECK(std::fabs(plant.torque().x - command.x * closed) < 1e-14);
        CHECK(std::fabs(plant.torque().y - command.y * closed) < 1e-14);
    }
}

TEST_CASE("the plant is the same machine at 1, 2 and 4 kHz") {
    PantographPlant slow({});
    slow.begin({.start = {0.0, 0.060}, .press_depth = 0.002});
    PantographPlant fast = slow;
    const int cuts = GENERATE(2, 4);
    double worst = 0.0;
    for (int tick = 0; tick < 3000; ++tick) {
        const Vec2 torque{0.02 * ((tick / 50) % 3 - 1), 0.03 * ((tick / 70) % 2)};
        slow.set_torque(torque);
        fast.set_torque(torque);
        slow.advance(1e-3);
        for (int i = 0; i < cuts; ++i) {
            fast.advance(1e-3 / cuts);
        }
        worst = std::max({worst, std::fabs(slow.angles()[0] - fast.angles()[0]),
                          std::fabs(slow.angles()[1] - fast.angles()[1])});
    }
    CHECK_FALSE(slow.lost());
    CHECK(worst < 1e-10);  // cut elsewhere than at 250 us it would be 1e-4
}

TEST_CASE("whatever is commanded, the plant stays finite and within its torque limit") {
    PantographPlant plant({});
    const double limit = plant.model().machine.axes[0].torque_limit;
    const double odd[] = {std::nan(""), std::numeric_limits<double>::infinity(), 1e300, -1e300, 0.0,
                          1e-300};
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        Random random(seed);
        plant.begin({});
        for (int i = 0; i < 300; ++i) {
            const auto pick = [&] {
                return random.below(4) == 0 ? odd[random.below(6)] : random.in(-2.0, 2.0);
            };
            const double one = pick();
            plant.set_torque({one, pick()});
            plant.advance(random.below(10) == 0 ? odd[random.below(6)] * 1e-290
                                                : random.decade(-6.0, -2.0));
            REQUIRE(std::isfinite(plant.angles()[0] + plant.angles()[1]));
            REQUIRE(std::isfinite(plant.rates().x + plant.rates().y));
            REQUIRE(std::fabs(plant.torque().x) <= limit);
            REQUIRE(std::fabs(plant.torque().y) <= limit);
        }
    }
}

TEST_CASE("a plant that cannot be is refused with its number") {
    PlantModel model;
    model.inertia.y = 0.0;
    CHECK_THROWS_WITH(PantographPlant(model), Has("inertia"));
    model = {};
    model.coulomb.x = std::nan("");
    CHECK_THROWS_WITH(PantographPlant(model), Has("nan"));
    model = {};
    model.machine.linkage.free_1 = -0.07;
    CHECK_THROWS_WITH(PantographPlant(model), Has("free link 1 is -0.07"));
}

TEST_CASE("friction at the handle stops it as a mass on a plate is stopped") {
    EACH(damping, 0.0, 0.5);
    EACH(force, 0.03, 0.1, 0.25);  // N; up to 0.04 it stands
    constexpr double kMass = 0.1;
    constexpr double kFriction = 0.04;
    PlantModel model;
    model.inertia = {1e-8, 1e-8};
    model.damping = model.coulomb = {};
    model.current_time = 0.0;
    model.handle_mass = kMass;
    model.handle_damping = damping;
    model.handle_friction = kFriction;
    model.hand = kNobody;
    PantographPlant plant(model);
    plant.begin({.start = {0.0, 0.050}, .tremor = 0.0});
    const Pantograph machine(model.machine);
    const Vec2 from = machine.locate(plant.angles())->hip;
    const double time = 0.05;
    for (int i = 0; i < 500; ++i) {
        plant.set_torque(machine.locate(plant.angles())->jacobian.transposed({force, 0.0}));
        plant.advance(time / 500);
    }
    const Vec2 way = machine.locate(plant.angles())->hip - from;
    const double push = std::max(force - kFriction, 0.0);
    const double lag = damping / kMass;  // 1/s; m x'' = push - b x'
    const double expected = damping > 0.0
                              ? push / damping * (time - (1.0 - std::exp(-lag * time)) / lag)
                              : 0.5 * push / kMass * time * time;
    CHECK(way.x == Approx(expected).epsilon(0.01).margin(1e-6));
    CHECK(std::fabs(way.y) < 1e-5 + 0.02 * expected);
}

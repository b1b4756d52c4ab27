#include "engine/deformation/dnurbs.hpp"
#include "engine/device/replay_device.hpp"
#include "engine/realtime/tick_loop.hpp"
#include "engine/rendering/energy_ledger.hpp"
#include "stimuli/two_curve.hpp"
#include "tests/support/allocations.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/frame.hpp"
#include "tests/support/outlines.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

namespace {

/// Friction that holds whatever hand comes here.
constexpr Friction kGlue{.mu_s = 1e6, .mu_d = 1e6};

std::shared_ptr<const Outline> arcs(double curvature) {
    return stimuli::make_outline({.curvature = curvature});
}

/// The curves A-V-B as the thesis has them, of tension 1/2c and a rigidity of 1/400 of it.
Dnurbs curves(double compliance) {
    DnurbsSpec spec{.knots = {0.0, 0.0, 0.0, 0.0, 0.2, 0.4, 0.6, 0.8, 1.0, 1.0, 1.0, 1.2, 1.4, 1.6,
                              1.8, 2.0, 2.0, 2.0, 2.0}};
    for (int i = 0; i < 15; ++i) {
        spec.points.push_back({0.01 * i, 0.001 * i * i});
    }
    spec.alpha = 1.0 / (2.0 * compliance);
    spec.beta = spec.alpha / 400.0;
    spec.fixed = {0, 14};
    return Dnurbs(spec);
}

/// A hand that goes from place to place through the surface, in a sixth of a second or so, and
/// trembles.
class RoamingHand {
public:
    explicit RoamingHand(Random& random)
        : random_(random), hurry_(random.decade(-3.0, -1.8)), tremor_(random.decade(-7.0, -4.5)) {}
    Vec2 next() {
        if (tick_++ % 120 == 0) {
            goal_ = {random_.in(-0.045, 0.045), random_.in(-0.005, 0.055)};
        }
        speed_ = 0.9 * speed_ + hurry_ * (goal_ - at_) + tremor_ * random_.point(-1.0, 1.0);
        return at_ += speed_;
    }

private:
    Random& random_;
    double hurry_;
    double tremor_;
    int tick_ = 0;
    Vec2 at_{0.0, 0.06};
    Vec2 goal_{};
    Vec2 speed_{};
};

SceneSpec soft_spec(Random& random) {
    const double mu_d = random.in(0.0, 1.0);
    return {.stiffness = random.decade(2.0, 4.3),
            .period = random.coin() ? 1e-3 : 1e-4,
            .friction = random.coin() ? Friction{}
                                      : Friction{.mu_s = mu_d + random.in(0.0, 0.5),
                                                 .mu_d = mu_d,
                                                 .tau_slip = random.coin() ? 0.0 : 0.02,
                                                 .tau_heal = 0.1},
            .compliance = random.decade(-6.0, std::log10(kMaxCompliance))};
}

struct Episodes {
    std::int64_t count = 0;
    double worst = -std::numeric_limits<double>::infinity();  ///< J
};

/// What a hand gets out of one object, from each rest on. Every tick is held to the friction cone.
Episodes episodes(unsigned seed, int ticks) {
    Random random(seed);
    const SceneSpec spec = soft_spec(random);
    const Scene scene(arcs(random.in(-20.0, 30.0)), spec);
    RoamingHand hand(random);
    ContactState state;
    Episodes all;
    EnergyLedger<2> ledger(spec.stiffness, true);
    const auto note = [&] {
        if (ledger.episodes() > 0) {
            all = {all.count + ledger.episodes(), std::max(all.worst, ledger.worst())};
        }
    };
    for (int i = 0; i < ticks; ++i) {
        const Vec2 hip = hand.next();
        const Contact c = scene.tick(state, hip);
        const bool touching = c.mode != Mode::free;
        ledger.add(hip, c.force, touching);
        if (!touching && !state.soft.moving) {
            note();
            ledger = EnergyLedger<2>(spec.stiffness, true);
            ledger.add(hip, {}, false);
        }
        REQUIRE_FALSE(c.unproven);
        REQUIRE_FALSE(c.outside_cone);
        REQUIRE(std::isfinite(c.force.x + c.force.y));
        const Vec2 pull = touching ? c.force - spec.stiffness * (c.go - hip) : c.force;
        REQUIRE(glm::length(pull) == 0.0);
        // In a concave vertex two normals carry, and the cone is that between them.
        const double cone = c.mu * c.normal_force + 1e-9 * spec.stiffness;
        REQUIRE((!touching || c.place.on_seam || std::fabs(c.tangential_force) <= cone));
    }
    note();
    return all;
}

/// HIP from its start to `to`, and there for two seconds.
Contact pressed(const Scene& scene, ContactState& state, const Vec2& from, const Vec2& to) {
    for (int i = 0; i < 100; ++i) {
        static_cast<void>(scene.tick(state, from + (i / 100.0) * (to - from)));
    }
    Contact contact;
    for (int i = 0; i < 2000; ++i) {
        contact = scene.tick(state, to);
    }
    return contact;
}

}  // namespace

TEST_CASE(
    "a soft contact at rest gives way by 1 / K and the curve's own compliance, in any direction") {
    SEEDED(random, 20U);
    const double k = random.decade(2.3, 4.0);
    const double c = random.decade(-5.0, -2.7);
    const auto outline = arcs(random.in(-10.0, 20.0));
    const Scene scene(outline, {.stiffness = k, .friction = kGlue, .compliance = c});
    const std::size_t side = random.coin() ? 1 : 0;
    const Frame at = frame_at(outline->spans()[side], random.in(0.1, 0.9));
    ContactState state;
    const Vec2 way = -random.in(0.001, 0.004) * at.normal + random.in(-0.001, 0.001) * at.tangent;
    const Vec2 start = at.point - 1e-5 * at.normal;
    static_cast<void>(scene.tick(state, start));
    const Place held = state.go.place;
    REQUIRE(held.index == side);
    const Contact contact = pressed(scene, state, start, at.point + way);
    REQUIRE(contact.mode == Mode::stuck);
    CHECK(state.go.place.parameter == held.parameter);

    const Dnurbs curve = curves(c);
    const double u = static_cast<double>(side) + held.parameter;
    const std::vector<Vec2> rest = curve.equilibrium(u, -contact.force);
    for (std::size_t i = 0; i < rest.size(); ++i) {
        CHECK(glm::length(state.soft.q[i] - rest[i]) <= 1e-9);
    }
    const BasisAt basis = curve.basis(u);
    Vec2 own{};  // of a force of 1 N along x
    for (std::size_t i = 0; i < basis.value.size(); ++i) {
        own += basis.value[i] * curve.equilibrium(u, {1.0, 0.0})[basis.first + i];
    }
    const Vec2 stretch = outline->spans()[side].at(held.parameter).point - (at.point + way);
    const Vec2 expected = stretch * (1.0 / (1.0 / k + own.x));
    CHECK(glm::length(contact.force - expected) <= 1e-8 * glm::length(expected));
    CHECK(scene.soft()->compliance_at({side, held.parameter}) == Approx(own.x).epsilon(1e-12));
    CHECK(scene.soft()->compliance_at({0, 1.0}) == Approx(c).epsilon(1e-12));
    CHECK(scene.soft()->compliance_at({1, 0.0}) == Approx(c).epsilon(1e-12));
}

TEST_CASE("a symmetric soft object answers mirrored hands with mirrored forces") {
    SEEDED(random, 20U);
    const Scene scene(arcs(random.in(-10.0, 20.0)), soft_spec(random));
    const double x = random.decade(-12.0, -4.0);  // beside the vertex
    const double speed = random.in(1e-6, 2e-5);   // m a tick
    ContactState left;
    ContactState right;
    double worst = 0.0;
    for (int i = 0; i < 400; ++i) {
        const double y = 0.0401 - speed * i;
        const Vec2 a = scene.tick(left, {-x, y}).force;
        const Vec2 b = scene.tick(right, {x, y}).force;
        worst = std::max(worst, glm::length(Vec2{-a.x, a.y} - b));
    }
    CHECK(worst <= 1e-9 * scene.spec().stiffness * 400.0 * speed);
}

TEST_CASE("from its rest on a soft object gives no more energy than sampling leaks") {
    SEED(40U);
    const Episodes all = episodes(seed, 4000);
    CHECK(all.count > 0);
    CHECK(all.worst <= 1e-12);
}

TEST_CASE("10,000 episodes of soft contact give no more energy than sampling leaks",
          "[.soft-long]") {
    Episodes all;
    for (unsigned seed = 1000; all.count < 10'000; ++seed) {
        CAPTURE(seed);
        const Episodes one = episodes(seed, 20'000);
        CHECK(one.worst <= 1e-12);
        all = {all.count + one.count, std::max(all.worst, one.worst)};
    }
    WARN(all.count << " episodes, the most beyond the bound " << all.worst << " J");
}

TEST_CASE(
    "while the hand rests, spring and curves together only lose energy, also where they meet") {
    int met = 0;
    for (unsigned seed = 0; seed < 60; ++seed) {
        CAPTURE(seed);
        Random random(seed);
        SceneSpec spec = soft_spec(random);
        spec.stiffness = random.decade(2.5, 4.3);
        spec.compliance = random.decade(-4.0, std::log10(kMaxCompliance));
        const auto outline = arcs(random.in(-10.0, 20.0));
        const Scene scene(outline, spec);
        const Frame at = frame_at(outline->spans()[0], random.in(0.2, 0.95));
        ContactState state;
        const Vec2 deep = at.point - random.in(0.002, 0.008) * at.normal;
        static_cast<void>(pressed(scene, state, at.point + 0.001 * at.normal, deep));
        // Back at once, out of the dent and yet below the rest: the surface comes after.
        const Vec2 still = at.point - random.in(0.0, 0.0004) * at.normal;
        double before = std::numeric_limits<double>::infinity();
        bool was_free = false;
        for (int i = 0; i < 2000; ++i) {
            const Contact c = scene.tick(state, still);
            const bool touching = c.mode != Mode::free;
            const Vec2 spring = touching ? c.go - still : Vec2{};
            const double all =
                0.5 * spec.stiffness * glm::dot(spring, spring) + scene.soft()->energy(state.soft);
            REQUIRE(all <= before * (1.0 + 1e-12) + 1e-18);
            before = all;
            met += was_free && touching ? 1 : 0;
            was_free = !touching;
        }
    }
    CHECK(met > 20);
}

TEST_CASE("a soft object that is let go comes back to its rest, and feels as new") {
    SEEDED(random, 10U);
    SceneSpec spec = soft_spec(random);
    spec.period = 1e-3;
    const Scene scene(arcs(5.0), spec);
    const Vec2 out{0.0, 0.06};
    const Vec2 in{random.in(-0.02, 0.02), 0.012};
    ContactState state;
    std::vector<Vec2> first;
    for (int turn = 0; turn < 2; ++turn) {
        for (int i = 0; i < 300; ++i) {
            const Contact c = scene.tick(state, out + (i / 299.0) * (in - out));
            if (turn == 0) {
                first.push_back(c.force);
            } else {
                REQUIRE(c.force == first[static_cast<std::size_t>(i)]);
            }
        }
        REQUIRE(state.touching);
        Contact c;
        for (int i = 0; i < 3000; ++i) {
            c = scene.tick(state, out);
        }
        CHECK_FALSE(state.soft.moving);
        CHECK(scene.soft()->energy(state.soft) == 0.0);
        CHECK(c.skipped);
        CHECK_FALSE(c.outside_cone);
        state.go = {};
    }
}

TEST_CASE(
    "the softer the object, the less it presses at the same depth, and the hardest is all but "
    "rigid") {
    const auto outline = arcs(5.0);
    const Frame at = frame_at(outline->spans()[0], 0.6);
    const Vec2 start = at.point + 0.002 * at.normal;
    const Vec2 end = at.point - 0.004 * at.normal;
    ContactState rigid;
    const Vec2 hard = pressed(Scene(outline, {}), rigid, start, end).force;
    double before = glm::length(hard);
    for (const double c : {1e-9, 1e-5, 1e-4, 3e-4, 1e-3, 3e-3}) {
        ContactState state;
        const Contact contact = pressed(Scene(outline, {.compliance = c}), state, start, end);
        const double force = glm::length(contact.force);
        CHECK(force < before);
        before = force;
        if (c == 1e-9) {
            CHECK(glm::length(contact.force - hard) <= 1e-5);
        }
    }
}

TEST_CASE("ticks of a soft object allocate nothing, and what follows is in the state alone") {
    Random random(7);
    const Scene scene(arcs(5.0), {.friction = {.mu_s = 0.7, .mu_d = 0.5}, .compliance = 1e-3});
    RoamingHand hand(random);
    std::vector<Vec2> path;
    for (int i = 0; i < 3000; ++i) {
        path.push_back(hand.next());
    }
    ContactState state;
    ContactState half;
    std::vector<Vec2> forces(path.size());
    const std::size_t before = tests::allocations();
    for (std::size_t i = 0; i < path.size(); ++i) {
        forces[i] = scene.tick(state, path[i]).force;
        if (i == 1400) {
            half = state;
        }
    }
    CHECK(tests::allocations() == before);
    const Scene again(arcs(5.0), {.friction = {.mu_s = 0.7, .mu_d = 0.5}, .compliance = 1e-3});
    for (std::size_t i = 1401; i < path.size(); ++i) {
        REQUIRE(again.tick(half, path[i]).force == forces[i]);
    }
}

TEST_CASE("whatever hand comes, a soft object stays within its depth and its numbers finite") {
    Random random(3);
    const Scene scene(arcs(5.0), {.stiffness = 20'000.0, .compliance = kMaxCompliance});
    const double deepest = scene.soft()->deepest();
    CHECK(deepest == Approx(0.25 * std::hypot(0.04, 0.04)));
    ContactState state;
    Vec2 hip{0.0, 0.05};
    double max = 0.0;
    for (int i = 0; i < 20'000; ++i) {
        hip.y -= i < 10'000 ? 1e-5 : 0.0;
        if (i >= 10'000) {
            hip = random.below(50) == 0
                    ? Vec2{std::numeric_limits<double>::quiet_NaN(), 0.0}
                    : random.decade(-3.0, random.below(20)) * random.point(-1.0, 1.0);
        }
        const Contact c = scene.tick(state, hip);
        REQUIRE((c.refused || std::isfinite(c.force.x + c.force.y)));
        for (const Vec2& q : state.soft.q) {
            max = std::max(max, glm::length(q));
        }
    }
    CHECK(max <= deepest);
    CHECK(max > 0.99 * deepest);  // it was there
}

TEST_CASE("every trial begins with the soft object at rest") {
    const Scene scene(arcs(5.0), {.compliance = 1e-3});
    std::vector<Reading> readings;
    for (int i = 0; i < 60; ++i) {
        readings.push_back({.hip = {0.005, 0.045 - 0.0004 * i, 0.0}});
    }
    std::array<std::vector<TickRecord>, 2> trials;
    ReplayDevice device;
    TickLoop loop(device, {});
    for (std::vector<TickRecord>& trial : trials) {
        device.begin(readings);
        loop.begin(scene);
        while (!device.at_end()) {
            const auto tick = static_cast<std::int64_t>(trial.size());
            trial.push_back(loop.tick({.time_ns = tick * 1'000'000}));
        }
    }
    REQUIRE(trials[0].back().mode != Mode::free);
    for (std::size_t i = 0; i < trials[0].size(); ++i) {
        REQUIRE(trials[1][i].force == trials[0][i].force);
    }
}

TEST_CASE("the energy observer sees a soft contact as the spring that stores as much") {
    const Scene scene(arcs(5.0), {.stiffness = 800.0, .compliance = 2e-3});
    ContactState state;
    const Vec2 end{0.005, 0.027};
    const Contact c = pressed(scene, state, {0.005, 0.045}, end);
    const Vec2 spring = scene.spring(state, c, end);
    const double alone = 400.0 * glm::dot(c.go - end, c.go - end);
    CHECK(scene.soft()->energy(state.soft) > alone);
    CHECK(400.0 * glm::dot(spring, spring) ==
          Approx(alone + scene.soft()->energy(state.soft)).epsilon(1e-6));
}

TEST_CASE("a compliance that cannot be rendered is refused with the remedy") {
    const auto says = [](const SceneSpec& spec, const std::shared_ptr<const Outline>& outline) {
        return refusal_of<std::invalid_argument>([&] { return Scene(outline, spec); });
    };
    const auto two = arcs(5.0);
    CHECK(says({.compliance = 0.005}, two) == "accepted");
    CHECK(says({.compliance = 0.006}, two) ==
          "compliance is 0.006: give m/N above 0, at most 0.005");
    CHECK(says({.compliance = -1.0}, two) == "compliance is -1: give m/N, 0 for a rigid object");
    CHECK(says({.damping = 0.5, .compliance = 1e-3}, two) ==
          "damping is 0.5: give 0 N s/m with a compliance: the object has a damping of its own");
    CHECK(says({.slew = {.speed = 0.2, .radius = 0.003}, .compliance = 1e-3}, two) ==
          "vertex slew is 0.2: give 0 m/s with a compliance: the vertex yields");
    CHECK_THAT(says({.friction = {.mu_s = 0.5, .mu_d = 0.5},
                     .law = {.traits = law_named("lugre")},
                     .compliance = 1e-3},
                    two),
               Catch::StartsWith("an object with a compliance takes friction \"frictionless\""));
    const auto triangle = polyline({{0.0, 0.0}, {0.02, 0.03}, {0.03, 0.03}, {0.04, 0.0}}, true);
    CHECK_THAT(says({.compliance = 1e-3}, triangle),
               Catch::StartsWith("a compliance is for two curves on a base line"));
}

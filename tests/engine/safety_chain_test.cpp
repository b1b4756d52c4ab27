#include "tests/engine/chain.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

TEST_CASE("no command is stronger than the limit, and its direction is kept") {
    SEEDED(random, std::uint64_t{100});
    const SafetyLimits limits{.max_force = random.in(0.5, 10.0), .ramp_step = 1.0};
    Chain chain{limits};
    for (int i = 0; i < 200; ++i) {
        const double size = random.decade(-3.0, 4.0);
        const Vec3 force(random.point(-size, size), random.in(-size, size));
        const Command c = chain({.force = force, .enable = true});
        REQUIRE(glm::length(c.force) <= limits.max_force * (1.0 + 1e-15));
        REQUIRE(glm::length(glm::cross(c.force, force)) <=
                1e-12 * glm::length(force) * limits.max_force);
        REQUIRE(glm::dot(c.force, force) >= 0.0);
        REQUIRE(c.saturated == (glm::length(force) > limits.max_force));
        if (!c.saturated) {
            REQUIRE(c.force == force);
        }
    }
}

TEST_CASE("the ramp takes as long as asked, on and off, and never jumps") {
    Chain chain{{.max_force = 10.0, .ramp_step = ramp_step(0.2, 1e-3)}};
    const Vec3 force{3.0, -4.0, 0.0};
    double last = 0.0;
    for (int k = 1; k <= 250; ++k) {
        const Command c = chain({.force = force, .enable = true});
        CHECK(std::fabs(glm::length(c.force) - 5.0 * std::min(1.0, k / 200.0)) < 1e-9);
        CHECK(c.ramped == (k < 200));
        CHECK(glm::length(c.force) - last <= 5.0 / 200.0 + 1e-12);
        last = glm::length(c.force);
    }
    for (int k = 1; k <= 200; ++k) {
        const Command c = chain({.force = force, .enable = false});
        CHECK(std::fabs(glm::length(c.force) - 5.0 * (1.0 - k / 200.0)) < 1e-9);
    }
    CHECK(glm::length(chain({.force = force, .enable = false}).force) < 1e-12);
}

TEST_CASE("a trial that starts inside the object feels no kick") {
    SEEDED(random, std::uint64_t{50});
    const SafetyLimits limits{.max_force = random.in(1.0, 10.0),
                              .ramp_step = random.in(0.001, 0.1)};
    Chain chain{limits};
    const Vec3 force(random.point(-30.0, 30.0), random.in(-30.0, 30.0));
    for (int k = 1; k <= 300; ++k) {
        const Command c = chain({.force = force});
        REQUIRE(glm::length(c.force) <= k * limits.ramp_step * limits.max_force * (1.0 + 1e-12));
    }
}

TEST_CASE("a command changes no faster than the slew limit, within the force limit") {
    SEEDED(random, std::uint64_t{100});
    const SafetyLimits limits{.max_force = random.in(1.0, 10.0),
                              .ramp_step = random.in(0.001, 1.0),
                              .slew = random.in(0.05, 3.0)};
    Chain chain{limits};
    Vec3 last{};
    Vec3 force{};
    for (int k = 0; k < 400; ++k) {
        if (random.below(7) == 0) {
            force = Vec3(random.point(-15.0, 15.0), random.in(-15.0, 15.0));
        }
        const Command c = chain({.force = force, .enable = random.below(9) != 0});
        REQUIRE(glm::length(c.force - last) <= limits.slew * (1.0 + 1e-12));
        REQUIRE(glm::length(c.force) <= limits.max_force * (1.0 + 1e-12));
        if (!c.force_slew && !c.saturated && !c.ramped) {
            REQUIRE(c.force == force);  // untouched where nothing is said of it
        }
        last = c.force;
    }
}

TEST_CASE("a step of the force arrives at the pace of the slew limit and says so") {
    Chain chain{{.ramp_step = 1.0, .slew = 2.0}};
    for (const double expected : {2.0, 4.0, 5.0, 5.0}) {
        const Command c = chain({.force = {3.0, -4.0, 0.0}});
        CHECK(glm::length(c.force - expected * Vec3{0.6, -0.8, 0.0}) < 1e-12);
        CHECK(c.force_slew == (expected < 5.0));
    }
}

TEST_CASE("a force that is not finite latches with zero from then on") {
    const double bad =
        GENERATE(std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                 -std::numeric_limits<double>::infinity(), 1e200);
    const int where = GENERATE(range(0, 4));
    CAPTURE(bad, where);
    Chain chain{{.ramp_step = 1.0}};
    CHECK(chain({.force = {1.0, 0.0, 0.0}}).force.x == 1.0);
    SafetyInput input{.force = {1.0, 0.0, 0.0}};
    const std::array<Vec3*, 4> parts{&input.force, &input.spring, &input.hip, &input.load};
    parts[static_cast<std::size_t>(where)]->y = bad;
    const Command c = chain(input);
    CHECK((c.trip == Trip::not_finite));
    CHECK(c.force == Vec3{});
    const Command later = chain({.force = {1.0, 0.0, 0.0}});
    CHECK((later.trip == Trip::not_finite));
    CHECK(later.force == Vec3{});
}

TEST_CASE("what device or scene report switches off in the same tick, with that cause") {
    const Trip found = GENERATE(Trip::scene_refused, Trip::device_lost, Trip::device_silent,
                                Trip::device_garbage, Trip::out_of_workspace);
    Chain chain{{.ramp_step = 1.0}};
    CHECK(chain({.force = {1.0, 0.0, 0.0}}).force.x == 1.0);
    const Command c = chain({.force = {1.0, 0.0, 0.0}, .found = found});
    CHECK((c.trip == found));
    CHECK(c.force == Vec3{});
}

TEST_CASE("a trip keeps its first cause and gives zero until the next trial") {
    SEEDED(random, std::uint64_t{60});
    Chain chain{{.ramp_step = 1.0, .dead_man = true}};
    Trip first = Trip::none;
    int zero = 0;
    for (int k = 0; k < 300; ++k) {
        const SafetyInput input{.force = Vec3(random.point(1.0, 5.0), 0.0),
                                .found = random.below(150) == 0 ? Trip::device_lost : Trip::none,
                                .held = random.below(150) != 0,
                                .stop = random.below(150) == 0 ? Trip::stopped : Trip::none};
        const Command c = chain(input);
        if (first == Trip::none) {
            first = input.found != Trip::none ? input.found
                  : input.stop != Trip::none  ? input.stop
                  : !input.held               ? Trip::let_go
                                              : Trip::none;
        }
        REQUIRE((c.trip == first));
        REQUIRE((glm::length(c.force) == 0.0) == (first != Trip::none));
        zero += first != Trip::none ? 1 : 0;
    }
    CHECK(zero > 0);
    chain.state = fresh_state(chain.state, chain.limits, 0.0);
    CHECK((chain.trip({.force = {1.0, 0.0, 0.0}}) == Trip::none));
}

TEST_CASE("letting go switches off, where a dead-man switch is asked for") {
    const bool asked = GENERATE(false, true);
    Chain chain{{.ramp_step = 1.0, .dead_man = asked}};
    CHECK(chain({.force = {1.0, 0.0, 0.0}}).force.x == 1.0);
    const Command c = chain({.force = {1.0, 0.0, 0.0}, .held = false});
    CHECK((c.trip == (asked ? Trip::let_go : Trip::none)));
    CHECK(c.force.x == (asked ? 0.0 : 1.0));
}

TEST_CASE("a stop by hand and a window without the keyboard switch off at once, with their cause") {
    const Trip why = GENERATE(Trip::stopped, Trip::focus_lost);
    const bool enable = GENERATE(true, false);  // also in the ramp out
    Chain chain{{.ramp_step = 1.0, .dead_man = true}};
    CHECK(chain({.force = {1.0, 0.0, 0.0}}).force.x == 1.0);
    const Command c =
        chain({.force = {1.0, 0.0, 0.0}, .enable = enable, .held = false, .stop = why});
    CHECK((c.trip == why));
    CHECK(c.force == Vec3{});
}

TEST_CASE("a device without a new reading trips after the ticks allowed, not before") {
    EACH(run, 1, 2, 10, 100);
    Chain chain{{.ramp_step = 1.0, .silent_run = run}};
    for (int round = 0; round < 5; ++round) {  // one fresh reading starts the count again
        CHECK((chain.trip() == Trip::none));
        REQUIRE((chain.trip({.fresh = false}, run - 1) == Trip::none));
    }
    CHECK((chain.trip() == Trip::none));
    REQUIRE((chain.trip({.fresh = false}, run - 1) == Trip::none));
    CHECK((chain.trip({.fresh = false}) == Trip::device_silent));
}

TEST_CASE("where no new reading comes there is no force until one does, and then it ramps in") {
    Random random(static_cast<std::uint64_t>(GENERATE(range(1, 20))));
    const std::int32_t quiet = 1 + random.below(20);
    const double step = random.in(0.01, 1.0);
    Chain chain{{.ramp_step = step,
                 .slew = random.coin() ? 0.05 : 10.0,
                 .quiet_run = quiet,
                 .silent_run = quiet + 200,
                 .spare_delay = 2.0}};
    const SafetyInput pressed{.force = {1.0, 0.0, 0.0}};
    for (int round = 0; round < 5; ++round) {
        double last = 0.0;
        for (int k = 1; k <= 400; ++k) {
            const Command c = chain(pressed);
            REQUIRE(c.force.x <= std::min(1.0, k * step) + 1e-12);
            REQUIRE(c.force.x <= last + chain.limits.slew + 1e-12);
            last = c.force.x;
        }
        CHECK(last == 1.0);
        const int gap = 1 + random.below(100);
        for (int k = 1; k <= gap; ++k) {
            const double age = k;  // beyond what may be borne, were there a force
            const Command c = chain({.force = {1.0, 0.0, 0.0}, .fresh = false, .behind = age});
            REQUIRE((c.trip == Trip::none));
            REQUIRE(c.force.x == (k < quiet ? 1.0 : 0.0));
            REQUIRE(c.ramped == (k >= quiet));
        }
        if (gap < quiet) {
            CHECK(chain(pressed).force.x == 1.0);
        }
        chain.state.gain = gap < quiet ? 0.0 : chain.state.gain;
        chain.state.command = {};
    }
}

TEST_CASE("whatever comes in, the command is finite and keeps all bounds at once") {
    SEEDED(random, std::uint64_t{400});
    const auto perhaps = [&](double value) {
        return random.coin() ? value : std::numeric_limits<double>::infinity();
    };
    const SafetyLimits limits{.period = random.coin() ? 1e-3 : 1e-4,
                              .max_force = random.in(0.5, 10.0),
                              .ramp_step = random.in(0.001, 1.0),
                              .slew = perhaps(random.in(0.1, 3.0)),
                              .speed = perhaps(random.in(0.5, 3.0)),
                              .jump = perhaps(0.01),
                              .late_run = random.below(30),
                              .late_share = random.below(100),
                              .quiet_run = random.below(10),
                              .silent_run = random.below(20),
                              .energy = perhaps(random.in(0.01, 1.0)),
                              .stiffness = random.in(100.0, 4000.0),
                              .damping = random.in(0.0, 2.0),
                              .delay_ticks = random.in(0.0, 20.0),
                              .heat_step = random.coin() ? 0.0 : random.decade(-5.0, 2.0),
                              .watch_encoders = random.coin(),
                              .dead_man = random.coin()};
    Chain chain{limits};
    const double wild = random.decade(-2.0, 200.0);
    const auto number = [&](double usual) {
        switch (random.below(3000)) {
            case 0:
                return std::numeric_limits<double>::quiet_NaN();
            case 1:
                return -std::numeric_limits<double>::infinity();
            case 2:
                return random.in(-wild, wild);
            default:
                return random.in(-usual, usual);
        }
    };
    const auto vector = [&](double usual) {
        const double x = number(usual);
        const double y = number(usual);
        return Vec3{x, y, number(usual)};
    };
    Command last;
    std::int32_t unheard = 0;
    for (int k = 0; k < 500; ++k) {
        const SafetyInput input{.force = vector(12.0),
                                .spring = vector(0.01),
                                .hip = vector(0.002),
                                .counts = {random.below(3), random.below(3)},
                                .found = random.below(2000) == 0 ? Trip::device_lost : Trip::none,
                                .fresh = random.below(10) != 0,
                                .time_ns = random.below(100) * std::int64_t{1'000'000},
                                .lateness_ns = random.below(20) == 0 ? 3'000'000 : 0,
                                .load = vector(1.0),
                                .enable = random.below(20) != 0,
                                .held = random.below(2000) != 0,
                                .stop = random.below(2000) == 0 ? Trip::stopped : Trip::none};
        const Command c = chain(input);
        REQUIRE(std::isfinite(glm::length(c.force)));
        REQUIRE(glm::length(c.force) <= limits.max_force * (1.0 + 1e-12));
        REQUIRE(glm::length(c.force) <=
                (k + 1) * limits.ramp_step * limits.max_force * (1.0 + 1e-12));
        unheard = input.fresh ? 0 : unheard + 1;
        if (c.trip == Trip::none && (limits.quiet_run == 0 || unheard < limits.quiet_run)) {
            REQUIRE(glm::length(c.force - last.force) <= limits.slew * (1.0 + 1e-12));
        } else {
            REQUIRE(c.force == Vec3{});
            REQUIRE((last.trip == Trip::none || c.trip == last.trip));
        }
        REQUIRE((last.trip == Trip::none || c.trip != Trip::none));
        last = c;
    }
}

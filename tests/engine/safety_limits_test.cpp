#include "tests/engine/chain.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

namespace {

constexpr std::int64_t kTick = 1'000'000;  // ns

Trip late_by(Chain& chain, double periods, int ticks = 1) {
    return chain.trip({.lateness_ns = static_cast<std::int64_t>(periods * kTick)}, ticks);
}

/// Ticks that follow a stall of `periods`, as a servo on absolute deadlines makes them.
Trip stall(Chain& chain, int periods) {
    Trip trip = Trip::none;
    for (int left = periods; left > 0; --left) {
        trip = late_by(chain, left);
    }
    return trip;
}

double rounded_to(double value, double step) {
    return std::floor(value / step + 0.5) * step;
}

/// First tick that trips a hand of `speed` m/s, read in steps of `count` m; -1: none in `ticks`.
int trips_at(const SafetyLimits& limits, double speed, double angle, double count, int ticks) {
    Chain chain{limits};
    for (int k = 0; k < ticks; ++k) {
        const double way = speed * k * limits.period;
        const Vec2 hip{rounded_to(way * std::cos(angle), count),
                       rounded_to(way * std::sin(angle), count)};
        const Trip trip = chain.trip({.hip = Vec3(hip, 0.0)});
        if (trip != Trip::none) {
            return trip == Trip::over_speed ? k : -2;
        }
    }
    return -1;
}

}  // namespace

TEST_CASE("late ticks in a row trip at the number allowed, not before") {
    EACH(run, 1, 2, 20);
    EACH(lateness, 0.51, 1.0, 1.4);
    Chain chain{{.ramp_step = 1.0, .late_run = run}};
    for (int round = 0; round < 10; ++round) {
        REQUIRE((late_by(chain, lateness, run - 1) == Trip::none));
        REQUIRE((late_by(chain, 0.5) == Trip::none));  // half a period is on time
        REQUIRE((late_by(chain, 0.0) == Trip::none));
    }
    REQUIRE((late_by(chain, lateness, run - 1) == Trip::none));
    CHECK((late_by(chain, lateness) == Trip::late));
}

TEST_CASE("a tick that is late by k periods counts as k, and catching up counts as nothing more") {
    const SafetyLimits limits{.ramp_step = 1.0, .late_run = 20};
    for (int periods = 1; periods < 40; ++periods) {
        CAPTURE(periods);
        Chain chain{limits};
        CHECK((late_by(chain, 0.0) == Trip::none));
        CHECK((late_by(chain, periods) == (periods < 20 ? Trip::none : Trip::late)));
    }
    for (int periods = 1; periods < 40; ++periods) {
        CAPTURE(periods);
        Chain chain{limits};
        CHECK((late_by(chain, 0.0) == Trip::none));
        CHECK((stall(chain, periods) == (periods < 20 ? Trip::none : Trip::late)));
    }
}

TEST_CASE("late ticks among the last hundred trip at the share allowed, not before") {
    SEEDED(random, std::uint64_t{60});
    Chain chain{{.ramp_step = 1.0, .late_share = 1 + random.below(60)}};
    const double rate = random.in(0.0, 1.0);
    std::vector<int> history;  // by hand: 1 for each late tick
    for (int k = 0; k < 1000; ++k) {
        const bool late = random.in(0.0, 1.0) < rate * 0.6;
        history.push_back(late ? 1 : 0);
        int share = 0;
        for (std::size_t i = history.size() < 100 ? 0 : history.size() - 100; i < history.size();
             ++i) {
            share += history[i];
        }
        const Trip trip = late_by(chain, late ? 0.9 : 0.1);
        REQUIRE((trip == (share >= chain.limits.late_share ? Trip::late : Trip::none)));
        if (trip != Trip::none) {
            break;
        }
    }
}

TEST_CASE("a wake-up of any lateness is some periods between none and the window") {
    CHECK(periods_late(0, 1e-3) == 0);
    CHECK(periods_late(500'000, 1e-3) == 0);
    CHECK(periods_late(510'000, 1e-3) == 1);
    CHECK(periods_late(1'499'000, 1e-3) == 1);
    CHECK(periods_late(1'501'000, 1e-3) == 2);
    CHECK(periods_late(1'501'000, 1e-4) == 15);
    CHECK(periods_late(INT64_MAX, 1e-4) == LateTicks::kWindow);
    CHECK(periods_late(INT64_MIN, 1e-4) == 0);
}

TEST_CASE("readings that became older than the stiffness allows trip when the mean says so") {
    SEEDED(random, std::uint64_t{60});
    const double period = random.coin() ? 1e-3 : 2.5e-4;
    const double behind = 1.0 + random.below(5);
    const double spare = behind * random.in(0.05, 1.2);
    Chain chain{{.period = period, .ramp_step = 1.0, .spare_delay = spare}};
    REQUIRE((chain.trip({.force = {1.0, 0.0, 0.0}}, 300) == Trip::none));
    // behind (1 - (1 - T / window)^n) > spare, for n ticks in a row
    const double n = std::log(1.0 - std::fmin(spare / behind, 1.0)) / std::log1p(-period / 0.25);
    const int all = spare < behind ? static_cast<int>(std::floor(n)) : 20000;
    const SafetyInput old{.force = {1.0, 0.0, 0.0}, .behind = behind};
    REQUIRE((chain.trip(old, all) == Trip::none));
    if (spare < behind) {
        chain(old);
        const Command c = chain(old);
        CHECK((c.trip == Trip::delayed));
        CHECK(c.force == Vec3{});
    }
}

TEST_CASE("answers that a busy machine keeps back now and then are no delay") {
    SEEDED(random, std::uint64_t{20});
    Chain chain{{.ramp_step = 1.0, .spare_delay = 0.5}};
    for (int round = 0; round < 40; ++round) {
        const int kept = 1 + random.below(9);  // ticks, 10 of them are silence
        for (int k = 1; k <= kept; ++k) {
            REQUIRE((chain.trip({.behind = 1.0 * k}) == Trip::none));
        }
        REQUIRE((chain.trip({}, 130) == Trip::none));
    }
}

TEST_CASE("a hand above the speed limit trips within the window, and one below it never") {
    SEEDED(random, std::uint64_t{100});
    const SafetyLimits limits{
        .period = 1e-3 / (1 + random.below(10)), .ramp_step = 1.0, .speed = random.in(0.3, 2.0)};
    const double count = random.in(1e-6, 1e-4);
    const double angle = random.in(0.0, 2.0 * std::numbers::pi);
    const int window = static_cast<int>(window_ticks(limits.period));
    // One count of either end, in both axes, over 20 ms.
    const double slack = std::numbers::sqrt2 * count / kSpeedWindow;
    CHECK(trips_at(limits, limits.speed - slack - 1e-9, angle, count, 2000) == -1);
    const int at = trips_at(limits, (limits.speed + slack) * 1.001, angle, count, 2000);
    CHECK(at >= 0);
    CHECK(at <= window);
}

TEST_CASE("a count of 0.1 mm a tick trips no speed limit of 0.05 m/s") {
    Chain chain{{.ramp_step = 1.0, .speed = 0.05, .jump = 0.01}};
    for (int k = 0; k < 500; ++k) {  // dithers by a count: 0.1 m/s from tick to tick
        REQUIRE((chain.trip({.hip = {1e-4 * (k % 2), 0.0, 0.0}}) == Trip::none));
    }
}

TEST_CASE("a jump between two fresh readings trips at once") {
    SEEDED(random, std::uint64_t{100});
    const SafetyLimits limits{.ramp_step = 1.0, .jump = random.in(0.001, 0.02)};
    Chain chain{limits};
    Vec2 hip = random.point(-0.05, 0.05);
    const auto moved_by = [&](double length) {
        const double angle = random.in(0.0, 2.0 * std::numbers::pi);
        hip += length * Vec2{std::cos(angle), std::sin(angle)};
    };
    for (int k = 0; k < 50; ++k) {
        moved_by(limits.jump * random.in(0.0, 0.999));
        REQUIRE((chain.trip({.force = {1.0, 0.0, 0.0}, .hip = Vec3(hip, 0.0)}) == Trip::none));
    }
    moved_by(limits.jump * random.in(1.001, 3.0));
    const Command c = chain({.force = {1.0, 0.0, 0.0}, .hip = Vec3(hip, 0.0)});
    CHECK((c.trip == Trip::jump));
    CHECK(c.force == Vec3{});
}

TEST_CASE("old readings and late ticks give the hand the time it really had") {
    SEEDED(random, std::uint64_t{200});
    Chain chain{{.ramp_step = 1.0, .speed = 1.0, .jump = 0.0015}};
    const double speed = 0.95;  // below both limits at any moment
    Vec2 hip{};
    double stall = 0.0;  // s still to be caught up
    for (int k = 0; k < 3000; ++k) {
        const double more = random.below(100) == 0 ? random.in(0.0, 0.008) : 0.0;
        stall = std::fmax(more, stall - 1e-3);  // time never runs back
        const double now = k * 1e-3 + stall;
        const bool fresh = k == 0 || random.below(4) != 0;
        if (fresh) {
            hip = {speed * now, 0.0};
        }
        const auto time_ns = static_cast<std::int64_t>(now * 1e9);
        REQUIRE((chain.trip({.hip = Vec3(hip, 0.0), .fresh = fresh, .time_ns = time_ns}) ==
                 Trip::none));
    }
}

TEST_CASE("a trial that begins with an old reading takes its way from the first fresh one") {
    SEEDED(random, std::uint64_t{100});
    Chain chain{{.ramp_step = 1.0, .speed = 1.0, .jump = 0.01}};
    const Vec2 before = random.point(-0.05, 0.05);  // where the hand was read before the rest
    Vec2 hip = random.point(-0.05, 0.05);
    REQUIRE((chain.trip({.hip = Vec3(before, 0.0), .fresh = false}, 1 + random.below(8)) ==
             Trip::none));
    for (int k = 0; k < 50; ++k) {
        hip += Vec2{9e-4, 0.0};
        REQUIRE((chain.trip({.hip = Vec3(hip, 0.0)}) == Trip::none));
    }
    hip += Vec2{0.011, 0.0};
    CHECK((chain.trip({.hip = Vec3(hip, 0.0)}) == Trip::jump));
}

TEST_CASE("motors trip when the first-order model says so") {
    // theta(t) = load^2 (1 - exp(-t / tau)) reaches 1 at t = -tau ln(1 - 1 / load^2).
    EACH(load, 1.05, 1.2, 2.0, 5.0);
    EACH(step, 1e-4, 1e-3, 1e-2);
    EACH(motor, 0, 1);
    Chain chain{{.ramp_step = 1.0, .heat_step = step}};
    const Vec3 loads = motor == 0 ? Vec3{load, 0.0, 0.0} : Vec3{0.0, load, 0.0};
    const double expected = -std::log(1.0 - 1.0 / (load * load)) / step;
    int ticks = 1;
    while (chain.trip({.load = loads}) == Trip::none && ticks < 1'000'000) {
        ++ticks;
    }
    CHECK((chain.state.trip == Trip::overheated));
    CHECK(std::fabs(ticks - expected) <= 1.0 + 1e-3 * expected);
}

TEST_CASE("a load that the motors can bear for ever never trips") {
    SEEDED(random, std::uint64_t{50});
    Chain chain{{.ramp_step = 1.0, .heat_step = random.decade(-4.0, 3.0)}};
    for (int k = 0; k < 20000; ++k) {
        const Vec2 load = random.below(3) == 0 ? random.point(0.0, 1.0) : Vec2{1.0, 1.0};
        REQUIRE((chain.trip({.load = Vec3(load, 0.0)}) == Trip::none));
        REQUIRE(chain.state.heat.x <= 1.0);
    }
}

TEST_CASE("the heat model is the exponential to third order, and stable for any step") {
    for (double step = 1e-6; step < 1e6; step *= 2.0) {
        CAPTURE(step);
        const Vec3 heat = heated({0.8, 0.0, 0.0}, {0.0, 1.0, 0.0}, step);
        CHECK(heat.x >= 0.0);
        CHECK(heat.y <= 1.0);
        CHECK(std::fabs(heat.x - 0.8 * std::exp(-step)) <= step * step * step / 6.0 + 1e-15);
    }
}

TEST_CASE("motors stay warm from trial to trial and cool in between") {
    const SafetyLimits limits{.ramp_step = 1.0, .heat_step = 1e-3};  // tau = 1 s
    Chain chain{limits};
    while (chain.trip({.load = {2.0, 0.0, 0.0}}) == Trip::none) {
    }
    const SafetyState& state = chain.state;
    const double hot = state.heat.x;
    CHECK((fresh_state(state, limits, 0.0).trip == Trip::none));
    CHECK(fresh_state(state, limits, 0.0).heat.x == hot);
    // It cools at least as slowly as exp(-1).
    CHECK(fresh_state(state, limits, 1.0).heat.x >= hot * std::exp(-1.0));
    CHECK(fresh_state(state, limits, 1.0).heat.x <= 0.41 * hot);
    CHECK(fresh_state(state, limits, INFINITY).heat.x == 0.0);
    CHECK(fresh_state(state, {}, INFINITY).heat.x == 0.0);
}

TEST_CASE("a screen without a sign of life for longer than allowed switches off, not before") {
    SEEDED(random, std::uint64_t{40});
    const SafetyLimits limits{.ramp_step = 1.0, .screen_silence = random.in(0.05, 1.0)};
    Chain chain{limits};
    for (int k = 0; k < 50; ++k) {
        const double age = limits.screen_silence * random.in(0.0, 1.0);
        REQUIRE(chain({.force = {1.0, 0.0, 0.0}, .screen_age = age}).force.x == 1.0);
    }
    // The ramp out asks nobody.
    CHECK((chain.trip({.screen_age = 2.0, .enable = false}) == Trip::none));
    const Command c =
        chain({.force = {1.0, 0.0, 0.0}, .screen_age = 1.001 * limits.screen_silence});
    CHECK((c.trip == Trip::screen_silent));
    CHECK(c.force == Vec3{});
}

TEST_CASE(
    "the force ends with its time by the servo's own count, and a ramp out may end after it") {
    SEEDED(random, std::uint64_t{20});
    const double period = random.coin() ? 1e-3 : 2.5e-4;
    const int ticks = 20 + random.below(400);
    Chain chain{{.period = period, .ramp_step = 1.0, .time_limit = (ticks - 0.5) * period}};
    REQUIRE((chain.trip({.force = {1.0, 0.0, 0.0}}, ticks) == Trip::none));  // tick k at k periods
    CHECK((chain.trip({.enable = false}) == Trip::none));
    const Command c = chain({.force = {1.0, 0.0, 0.0}});
    CHECK((c.trip == Trip::time_limit));
    CHECK(c.force == Vec3{});
}

TEST_CASE("every trip says what happened and what to do") {
    for (int i = 1; i <= static_cast<int>(Trip::stopped); ++i) {
        const auto trip = static_cast<Trip>(i);
        CAPTURE(to_string(trip));
        CHECK((to_string(trip) != "none"));
        const std::string_view text = explanation(trip);
        const std::size_t colon = text.find(": ");
        CHECK(colon != std::string_view::npos);
        CHECK(text.size() > colon + 12);
        CHECK(text.back() != '.');
    }
}

#include "tests/engine/chain.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

// In space the third coordinate counts as much as the first, whose laws the other tests state.

namespace {

/// What a trial does along one axis.
enum class Act {
    presses,
    jumps,
    speeds,
    overheats,
    gives_energy,
    runs_away,
    is_no_number,
    stands_still
};

struct Moment {
    double hip = 0.0;
    double force = 0.0;
    double spring = 0.0;
    double depth = 0.0;
    double load = 0.0;
    double side = 0.0;  ///< of HIP across the axis, m
};

Moment moment_of(Act act, int k, Random& random) {
    const double t = 1e-3 * k;
    Moment now{.hip = 0.01 * std::sin(4.0 * t), .side = 0.02 * std::sin(3.0 * t)};
    now.depth = std::fmax(0.0, -now.hip);
    now.spring = now.depth;
    now.force = 1000.0 * now.depth + random.in(-0.5, 0.5);
    switch (act) {
        case Act::presses:
        case Act::stands_still:
            break;
        case Act::jumps:
            now.hip += k >= 700 ? 0.03 : 0.0;
            break;
        case Act::speeds:
            now.hip += 2.0 * std::fmax(0.0, t - 0.5);
            break;
        case Act::overheats:
            now.load = 2.0;
            break;
        case Act::gives_energy:
            now.spring = 0.005 * std::cos(4.0 * t);  // it pulls where the hand goes
            now.force = 1000.0 * now.spring;
            break;
        case Act::runs_away:
            now.hip = -0.05 * t - (t > 0.5 ? 0.35 * (t - 0.5) : 0.0);
            now.depth = now.spring = -now.hip;
            now.force = 1000.0 * now.depth;
            break;
        case Act::is_no_number:
            now.force = k == 900 ? std::numeric_limits<double>::quiet_NaN() : now.force;
            break;
    }
    return now;
}

SafetyLimits limits_of(Act act) {
    SafetyLimits limits{.max_force = 6.0, .ramp_step = 0.005, .slew = 0.2};
    limits.speed = 1.0;
    limits.jump = 0.01;
    limits.heat_step = act == Act::overheats ? 1e-3 : 0.0;
    limits.energy = act == Act::gives_energy ? 0.01 : std::numeric_limits<double>::infinity();
    limits.watch_runaway = act == Act::runs_away;
    return limits;
}

/// Along x, or along z with the side still along y.
SafetyInput input_of(const Moment& now, bool up) {
    const auto along = [up](double value, double side) {
        return up ? Vec3{0.0, side, value} : Vec3{value, side, 0.0};
    };
    return {.force = along(now.force, 0.0),
            .spring = along(now.spring, 0.0),
            .depth = now.depth,
            .hip = along(now.hip, now.side),
            .load = along(now.load, 0.0)};
}

}  // namespace

TEST_CASE(
    "what is up is held to what is to the side: the same command and the same trip in the same "
    "tick") {
    const auto [act, cause] = GENERATE(table<Act, Trip>({{Act::presses, Trip::none},
                                                         {Act::jumps, Trip::jump},
                                                         {Act::speeds, Trip::over_speed},
                                                         {Act::overheats, Trip::overheated},
                                                         {Act::gives_energy, Trip::energy},
                                                         {Act::runs_away, Trip::runaway},
                                                         {Act::is_no_number, Trip::not_finite}}));
    const auto seed = GENERATE(palpate::tests::seeds(10U));
    CAPTURE(static_cast<int>(act), seed);
    Random one(seed);
    Random other(seed);
    Chain across{limits_of(act)};
    Chain up{limits_of(act)};
    double strongest = 0.0;
    for (int k = 0; k < 3000; ++k) {
        const Command level = across(input_of(moment_of(act, k, one), false));
        const Command raised = up(input_of(moment_of(act, k, other), true));
        REQUIRE(raised.trip == level.trip);
        REQUIRE(std::fabs(raised.force.z - level.force.x) < 1e-12);
        REQUIRE(raised.force.x == 0.0);
        REQUIRE(raised.saturated == level.saturated);
        REQUIRE(raised.force_slew == level.force_slew);
        strongest = std::fmax(strongest, std::fabs(raised.force.z));
    }
    CHECK((up.state.trip == cause));
    CHECK(strongest > 0.1);
    CHECK(strongest <= 6.0 * (1.0 + 1e-12));
}

TEST_CASE("a force in space keeps its direction at the limit, and a slew takes the straight way") {
    SEEDED(random, 100U);
    const SafetyLimits limits{.max_force = 5.0, .ramp_step = 1.0, .slew = random.in(0.05, 20.0)};
    Chain chain{limits};
    Vec3 last{};
    for (int k = 0; k < 200; ++k) {
        const Vec3 asked(random.in(-9.0, 9.0), random.in(-9.0, 9.0), random.in(-9.0, 9.0));
        const Vec3 given = chain({.force = asked}).force;
        const double length = glm::length(asked);
        const Vec3 strong = length > 5.0 ? asked * (5.0 / length) : asked;
        const double way = glm::length(strong - last);
        const Vec3 want = way > limits.slew ? last + (strong - last) * (limits.slew / way) : strong;
        REQUIRE(glm::length(given - want) < 1e-12);
        last = given;
    }
}

TEST_CASE(
    "a straight axis that is pushed and does not count ends the force within 0.15 m of strokes, "
    "within 0.6 m if only at every hill, and no other") {
    EACH(axis, 0, 1, 2);
    SEED(20U);
    EACH(pushed, as<std::string>(), "always", "over hills", "never");
    EACH(stuck, true, false);
    Random random(seed);
    Chain chain{{.ramp_step = 1.0, .watch_encoders = true, .axes = 3}};
    chain.limits.stuck_travel = 0.080;
    const double period = random.in(0.5, 2.0);  // s of a stroke to and fro
    const double wide = random.in(0.02, 0.05);
    double way = 0.0;
    Vec3 last{};
    for (int k = 0; k < 20000 && chain.state.trip == Trip::none && way < 1.0; ++k) {
        const double phase = 2.0 * 3.141592653589793 * 1e-3 * k / period;
        Vec3 place{};
        place[(axis + 1) % 3] = wide * std::sin(phase);
        place[(axis + 2) % 3] = 0.7 * wide * std::cos(1.3 * phase);
        place[axis] = stuck ? 0.0 : 50e-6 * std::sin(8.0 * phase);  // two counts
        const Vec3 counts = place / 26e-6;
        SafetyInput input{.hip = place,
                          .counts = {static_cast<std::int32_t>(std::floor(counts.x)),
                                     static_cast<std::int32_t>(std::floor(counts.y)),
                                     static_cast<std::int32_t>(std::floor(counts.z))}};
        const bool high = std::fabs(place[(axis + 1) % 3]) < 0.7 * wide;
        input.force[axis] = pushed == "always" || (pushed == "over hills" && high) ? 2.0 : 0.3;
        chain(input);
        way += k > 0 ? glm::length(place - last) : 0.0;
        last = place;
    }
    const bool ends = stuck && pushed != "never";
    CHECK((chain.state.trip == (ends ? Trip::stuck_encoder : Trip::none)));
    CHECK((!ends || way < (pushed == "always" ? 0.15 : 0.6)));
}

#include "stimuli/two_curve.hpp"
#include "protocols/session/exploration_meter.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"

using engine::Mode;
using engine::TickRecord;
using namespace palpate::protocols;

namespace {

constexpr double kChord = 0.0565685424949238;  // m, from (-40, 0) to (0, 40) mm

/// Of an arc over the chord, m: 2 / kappa asin(kappa c / 2).
double arc_length(double curvature) {
    return curvature == 0.0 ? kChord : 2.0 / curvature * std::asin(0.5 * curvature * kChord);
}

/// Where the share s of an arc's length lies: of the rational quadratic with end weights 1, middle
/// weight cos(half), half the angle of the arc, the parameter at the angle a from its start is
/// sin(a / 2) / (sin(a / 2) + sin(half - a / 2)).
double parameter_at(double share, double curvature) {
    const double half = std::asin(0.5 * std::fabs(curvature) * kChord);
    const double a = share * half;
    return half < 1e-9 ? share : std::sin(a) / (std::sin(a) + std::sin(half - a));
}

TickRecord tick_on(std::int64_t k, std::int16_t segment, double u) {
    TickRecord tick;
    tick.tick = k;
    tick.time_ns = k * 1'000'000;
    tick.segment = segment;
    tick.u = u;
    tick.mode = Mode::slip;
    return tick;
}

}  // namespace

TEST_CASE("coverage is the share of both arcs that the god-object went along",
          "[exploration][law]") {
    SEED(40);
    tests::Random random(static_cast<std::uint64_t>(seed));
    const double curvature = seed == 0 ? 0.0 : random.in(-20.0, 20.0);
    const auto outline = stimuli::make_outline({.curvature = curvature});
    OutlineCover cover(*outline);
    CHECK(cover.share() == 0.0);
    double visited = 0.0;
    for (std::int16_t segment = 0; segment < 2; ++segment) {
        double from = random.in(0.0, 1.0);
        double to = random.in(0.0, 1.0);
        std::tie(from, to) = std::minmax({from, to});
        visited += 0.5 * (to - from);
        for (int pass = 0; pass < 2; ++pass) {  // what was visited counts once
            for (int k = 0; k <= 2000; ++k) {
                const double share = from + (to - from) * k / 2000.0;
                cover.add(tick_on(k, segment, parameter_at(share, curvature)));
            }
        }
    }
    const double cells = 2.0 * 2.0 * OutlineCover::kCell * 1.8 / (2.0 * arc_length(curvature));
    CHECK(cover.share() >= visited - 1e-3);
    CHECK(cover.share() <= visited + cells);
    for (const std::int16_t elsewhere : {std::int16_t{2}, std::int16_t{-3}}) {  // the base
        const double before = cover.share();
        cover.add(tick_on(0, elsewhere, 0.5));
        CHECK(cover.share() == before);
    }
}

TEST_CASE("a hand that has been everywhere covers all, and one in the air nothing",
          "[exploration][law]") {
    const auto outline = stimuli::make_outline({.curvature = GENERATE(-10.0, 0.0, 5.0)});
    OutlineCover cover(*outline);
    TickRecord free = tick_on(0, 0, 0.5);
    free.mode = Mode::free;
    cover.add(free);
    CHECK(cover.share() == 0.0);
    for (int k = 0; k <= 3000; ++k) {
        cover.add(tick_on(k, static_cast<std::int16_t>(k % 2), k / 3000.0));
    }
    CHECK(cover.share() == Approx(1.0).epsilon(1e-12));
}

TEST_CASE("deciles are the nearest ranks", "[exploration][law]") {
    tests::Random random(static_cast<std::uint64_t>(GENERATE(range(0, 100))));
    std::vector<double> values(random.index(60));
    for (double& value : values) {
        value = random.coin() ? random.in(0.0, 1.0) : 0.5;  // with ties
    }
    const Deciles found = protocols::deciles_of(values);
    for (const auto& [q, value] :
         {std::pair{0.1, found.p10}, std::pair{0.5, found.p50}, std::pair{0.9, found.p90}}) {
        if (values.empty()) {
            CHECK(value == 0.0);
            continue;
        }
        // The smallest one that at least the share q of all does not exceed.
        const auto share_up_to = [&](double x) {
            return static_cast<double>(
                       std::ranges::count_if(values, [&](double v) { return v <= x; })) /
                   static_cast<double>(values.size());
        };
        CHECK(std::ranges::count(values, value) > 0);
        CHECK(share_up_to(value) >= q - 1e-12);
        for (const double smaller : values) {
            CHECK((smaller >= value || share_up_to(smaller) < q - 1e-12));
        }
    }
}

TEST_CASE("speeds are those of contact, stops and new slips are counted", "[exploration][law]") {
    SEED(30);
    tests::Random random(static_cast<std::uint64_t>(seed));
    const auto outline = stimuli::make_outline({.curvature = 5.0});
    ExplorationMeter meter(*outline);
    const double slow =
        random.in(0.01, 0.05);  // m/s, four fifths of the time in contact; then twice it
    double x = 0.0;
    std::int64_t k = 0;
    std::int64_t stops = 0;
    std::int64_t on_vertex = 0;
    for (int bout = 0; bout < 100; ++bout) {
        const double speed = bout % 5 == 4 ? 2.0 * slow : slow;
        for (int i = 0; i < 61; ++i) {
            x += speed * 1e-3;
            TickRecord tick =
                tick_on(k++, random.below(10) == 0 ? std::int16_t{-1} : std::int16_t{0}, 0.5);
            tick.hip = {x, 0.0, 0.0};
            tick.normal_force = speed;
            tick.mode = i % 30 == 0 ? Mode::stuck : i % 30 == 20 ? Mode::transition : Mode::slip;
            stops += tick.mode == Mode::stuck && i > 0 ? 1 : 0;  // who touches down has not slid
            on_vertex += tick.segment == -1 ? 1 : 0;
            meter.add(tick);
        }
        for (int i = 0; i < 1 + random.below(40); ++i) {  // a leap in the air is no speed
            x += random.in(-0.02, 0.02);
            TickRecord tick = tick_on(k++, -1, 0.0);
            tick.mode = Mode::free;
            tick.hip = {x, 0.0, 0.0};
            meter.add(tick);
        }
    }
    CHECK(meter.stick_events() == stops);
    CHECK(meter.vertex_ticks() == on_vertex);
    CHECK(meter.speed().p10 == Approx(slow).epsilon(1e-9));
    CHECK(meter.speed().p50 == Approx(slow).epsilon(1e-9));
    CHECK(meter.speed().p90 == Approx(2.0 * slow).epsilon(1e-9));
    CHECK(meter.normal_force().p50 == slow);
    CHECK(meter.normal_force().p90 == 2.0 * slow);
}

TEST_CASE("a hand that was never in contact has no speed, no force and covers nothing",
          "[exploration]") {
    const auto outline = stimuli::make_outline({.curvature = 5.0});
    const ExplorationMeter meter(*outline);
    CHECK(meter.speed().p90 == 0.0);
    CHECK(meter.normal_force().p10 == 0.0);
    CHECK(meter.covered_share() == 0.0);
}

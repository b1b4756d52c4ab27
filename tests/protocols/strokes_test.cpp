#include <variant>

#include "engine/realtime/felt_scene.hpp"
#include "stimuli/two_curve.hpp"
#include "protocols/session/trial_meter.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"

using engine::Mode;
using engine::TickRecord;
using engine::Vec2;
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

/// Two curves that rub.
engine::Scene felt_scene(double curvature) {
    return {stimuli::make_outline({.curvature = curvature}),
            {.friction = {.mu_s = 0.7, .mu_d = 0.5}}};
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

/// A hand at `place` along a straight surface turned by `angle`, pressing with 1 N; friction pulls
/// it back.
TickRecord tick_at(std::int64_t k, double place, double angle, double pull = 0.0) {
    const Vec2 t{std::cos(angle), std::sin(angle)};
    const Vec2 n{-t.y, t.x};
    TickRecord tick;
    tick.tick = k;
    tick.time_ns = k * 1'000'000;
    tick.hip = engine::Vec3(place * t - 0.001 * n, 0.0);
    tick.normal_force = 1.0;
    tick.tangential_force = pull;
    tick.force = engine::Vec3(n + pull * t, 0.0);
    tick.mode = engine::Mode::slip;
    return tick;
}

/// Half a period each way: every one is a stroke of 2 * amplitude.
std::int64_t strokes_of_sweeps(int half_periods, double amplitude, double angle, double tremor) {
    StrokeCounter counter;
    constexpr int kTicks = 500;  // a half period
    for (int k = 0; k <= half_periods * kTicks; ++k) {
        const double phase = std::numbers::pi * k / kTicks;
        const double shake = tremor * std::sin(2.0 * std::numbers::pi * 0.009 * k);
        counter.add(tick_at(k, -amplitude * std::cos(phase) + shake, angle, 0.4));
    }
    return counter.strokes();
}

/// A second of a hand in and out of contact, in no order.
protocols::TrialSummary felt_at_random(tests::Random& random, bool touches) {
    const engine::Scene scene = felt_scene(0.0);
    protocols::TrialMeter meter(1000.0, scene);
    for (int k = 0; k < 1000; ++k) {
        TickRecord tick = tick_at(k, random.in(-0.02, 0.02), 0.7);
        tick.segment = static_cast<std::int16_t>(random.below(3) - 1);
        tick.mode = static_cast<engine::Mode>(touches ? random.below(4) : 0);
        tick.flags = static_cast<std::uint8_t>(touches ? random.below(256) : 0);  // no episode
        tick.normal_force = random.in(0.0, 8.0);
        tick.force = {random.in(-8.0, 8.0), random.in(-8.0, 8.0), 0.0};
        meter.add(std::span(&tick, 1));
    }
    return meter.summary();
}

double number(const protocols::Measure::Value& value) {
    return std::holds_alternative<double>(value)
             ? std::get<double>(value)
             : static_cast<double>(std::get<std::int64_t>(value));
}

}  // namespace

TEST_CASE("coverage is the share of both arcs that the god-object went along") {
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

TEST_CASE("a hand that has been everywhere covers all, and one in the air nothing") {
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

TEST_CASE("deciles are the nearest ranks") {
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

TEST_CASE("speeds are those of contact, stops and new slips are counted") {
    SEED(30);
    tests::Random random(static_cast<std::uint64_t>(seed));
    const engine::Scene scene = felt_scene(5.0);
    protocols::TrialMeter meter(1000.0, scene);
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
            meter.add({&tick, 1});
        }
        for (int i = 0; i < 1 + random.below(40); ++i) {  // a leap in the air is no speed
            x += random.in(-0.02, 0.02);
            TickRecord tick = tick_on(k++, -1, 0.0);
            tick.mode = Mode::free;
            tick.hip = {x, 0.0, 0.0};
            meter.add({&tick, 1});
        }
    }
    const TrialSummary sum = meter.summary();
    CHECK(sum.stick_events == stops);
    CHECK(sum.vertex_ticks == on_vertex);
    CHECK(sum.speed.p10 == Approx(slow).epsilon(1e-9));
    CHECK(sum.speed.p50 == Approx(slow).epsilon(1e-9));
    CHECK(sum.speed.p90 == Approx(2.0 * slow).epsilon(1e-9));
    CHECK(sum.normal_force.p50 == slow);
    CHECK(sum.normal_force.p90 == 2.0 * slow);
}

TEST_CASE("a hand that was never in contact has no speed, no force and covers nothing") {
    const engine::Scene scene = felt_scene(5.0);
    const TrialSummary sum = protocols::TrialMeter(1000.0, scene).summary();
    CHECK(sum.speed.p90 == 0.0);
    CHECK(sum.normal_force.p10 == 0.0);
    CHECK(sum.covered_share == 0.0);
}

TEST_CASE("every sweep along the surface is one stroke, however the surface lies") {
    SEEDED(random, 60U);
    const int sweeps = 1 + random.below(12);
    const double amplitude = random.in(0.004, 0.05);
    const double angle = random.in(-3.2, 3.2);
    CHECK(strokes_of_sweeps(sweeps, amplitude, angle, 0.0) == sweeps);
    CHECK(strokes_of_sweeps(sweeps, amplitude, angle, 0.0005) ==
          sweeps);                                              // 9 Hz tremor, 1 mm to and fro
    CHECK(strokes_of_sweeps(sweeps, 0.0024, angle, 0.0) == 0);  // 4.8 mm are none
}

TEST_CASE("a bounce does not end a stroke, lifting the hand does") {
    EACH(off, 1, 50, 99, 100, 250);
    StrokeCounter counter;
    std::int64_t k = 0;
    const auto stroke = [&](double from, double to) {
        for (int i = 0; i <= 100; ++i) {
            counter.add(tick_at(k++, from + (to - from) * i / 100.0, 0.3));
        }
    };
    stroke(0.0, 0.02);
    for (int i = 0; i < off; ++i) {
        TickRecord tick = tick_at(k++, 0.02, 0.3);
        tick.mode = engine::Mode::free;
        tick.force = {};
        tick.normal_force = 0.0;
        counter.add(tick);
    }
    stroke(0.02, 0.04);
    // From contact to contact `off` + 1 ticks of 1 ms; more than 100 ms is a lift.
    CHECK(counter.strokes() == (off + 1 > 100 ? 2 : 1));
}

TEST_CASE("the meter says speed in contact and time on each side of the vertex") {
    const engine::Scene scene = felt_scene(0.0);
    protocols::TrialMeter meter(1000.0, scene);
    std::vector<TickRecord> ticks;
    for (int k = 0; k < 1000; ++k) {  // 0.1 m/s along a line, 200 ticks of it in the air
        TickRecord tick = tick_at(k, 1e-4 * k, 0.7);
        tick.segment = static_cast<std::int16_t>(k < 500 ? 0 : k < 510 ? -2 : 1);
        tick.mode = k >= 700 && k < 900 ? engine::Mode::free : engine::Mode::stuck;
        ticks.push_back(tick);
    }
    meter.add(std::span(ticks).first(333));
    meter.add(std::span(ticks).subspan(333));
    const auto sum = meter.summary();
    CHECK(sum.mean_speed_m_per_s == Approx(0.1).epsilon(1e-9));
    CHECK(sum.before_vertex_ticks == 500);
    CHECK(sum.after_vertex_ticks == 290);
    CHECK(sum.strokes == 2);
    CHECK(sum.strokes_before_vertex == 1);
    CHECK(sum.strokes_after_vertex == 1);
    CHECK(sum.reversals == 0);
}

TEST_CASE("of two intervals counts and ways add up, means weigh by contact, the largest remains") {
    EACH(seed, range(0, 30));
    tests::Random random(static_cast<std::uint64_t>(seed));
    const auto a = felt_at_random(random, seed % 3 != 1);
    const auto b = felt_at_random(random, seed % 3 != 2);
    const auto all = protocols::together(a, b);
    for (const protocols::Measure& one : protocols::measures()) {
        const std::string column(one.column);
        CAPTURE(column);
        if (column == "first_contact_s") {
            CHECK(all.first_contact_s == (a.first_contact_s ? a : b).first_contact_s);
            continue;
        }
        const double x = number(measured(one, a, true));
        const double y = number(measured(one, b, true));
        const bool counts = std::holds_alternative<std::int64_t>(measured(one, all, true));
        const auto weight = static_cast<double>(a.contact_ticks);
        const double weights = weight + static_cast<double>(b.contact_ticks);
        const double wanted = counts || column == "path_length_m" || column == "energy_j" ? x + y
                            : column.starts_with("mean_")
                                ? (x * weight + y * (weights - weight)) / weights
                            : column.starts_with("max_")  ? std::max(x, y)
                            : column != "worst_episode_j" ? x
                            : a.contact_ticks == 0        ? y
                            : b.contact_ticks == 0        ? x
                                                          : std::max(x, y);
        CHECK(number(measured(one, all, true)) == Approx(wanted).margin(1e-12));
    }
}

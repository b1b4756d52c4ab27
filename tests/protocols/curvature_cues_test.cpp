#include "protocols/observer/cues.hpp"
#include "tests/protocols/strokes.hpp"
#include "tests/support/catch.hpp"

using namespace palpate::protocols;

namespace {

Cues felt(const StrokeSpec& spec, std::uint64_t seed = 1) {
    CurvatureCues cues(OutlineSpec{});
    cues.add(strokes(spec, seed));
    return cues.cues();
}

}  // namespace

TEST_CASE("both cues find the curvature of an exact arc, with and without friction") {
    EACH(curvature, -10.0, -7.5, -5.0, -2.5, 0.0, 2.5, 5.0, 7.5, 10.0);
    EACH(mu, 0.0, 0.5, 0.7);
    const Cues cues = felt({.curvature = curvature, .mu = mu});
    REQUIRE(cues.force);
    REQUIRE(cues.position);
    // 1 % of the arc's series, 0.5 % of the depth, and a little of the turns.
    CHECK(std::fabs(*cues.force - curvature) < 0.02 * std::fabs(curvature) + 0.02);
    CHECK(std::fabs(*cues.position - curvature) < 0.02 * std::fabs(curvature) + 0.02);
    CHECK(cues.friction == Approx(mu).margin(1e-12));
}

TEST_CASE("a deep press stretches both cues as the header says") {
    const double curvature = GENERATE(-10.0, 10.0);
    const Cues cues = felt({.curvature = curvature, .depth = 0.003});
    const double expected = curvature / (1.0 - curvature * 0.003);
    CHECK(*cues.force == Approx(expected).epsilon(0.015));
    CHECK(*cues.position == Approx(expected).epsilon(0.015));
}

TEST_CASE("a trembling hand does not bias the cues") {
    SEED(std::uint64_t{20});
    const Cues cues = felt({.curvature = 5.0, .depth = 0.001, .mu = 0.5, .tremor = 0.0002}, seed);
    CHECK(std::fabs(*cues.force - 5.0) < 0.2);
    CHECK(std::fabs(*cues.position - 5.0) < 0.2);
}

TEST_CASE("nothing is learnt from ticks that are free, too light, stuck or off the chords") {
    using palpate::engine::Mode;
    const auto nothing_of = [](Mode mode, double normal_force, double away) {
        auto ticks = strokes({.curvature = 5.0});
        for (auto& tick : ticks) {
            tick.mode = mode;
            tick.normal_force = normal_force;
            tick.hip.x += away;
        }
        CurvatureCues cues(OutlineSpec{});
        for (const std::size_t some : {std::size_t{0}, ticks.size()}) {
            cues.add(std::span(ticks).first(some));
            const Cues result = cues.cues();
            CHECK((!result.force && !result.position && result.friction == 0.0));
        }
    };
    nothing_of(Mode::stuck, 0.5, 0.0);
    nothing_of(Mode::free, 0.5, 0.0);
    nothing_of(Mode::slip, 0.04, 0.0);
    nothing_of(Mode::slip, 1.0, 0.5);
}

#include "protocols/procedure/procedure.hpp"
#include "tests/protocols/orders.hpp"
#include "tests/support/random.hpp"

using namespace palpate::protocols;

namespace {

/// The levels of a staircase under the given answers. @param turned  the trials of its reversals
std::vector<double> levels(Staircase& staircase,
                           std::string_view answers,
                           std::vector<std::size_t>* turned = nullptr) {
    std::vector<double> levels;
    for (const char answer : answers) {
        levels.push_back(staircase.level());
        const std::size_t reversals = staircase.reversals().size();
        staircase.update(staircase.level(), answer == '1');
        if (turned != nullptr && staircase.reversals().size() > reversals) {
            turned->push_back(levels.size() - 1);
        }
    }
    return levels;
}

void check_same(const std::vector<double>& got, const std::vector<double>& wanted) {
    REQUIRE(got.size() == wanted.size());
    for (std::size_t i = 0; i < got.size(); ++i) {
        CAPTURE(i);
        CHECK(got[i] == Approx(wanted[i]).epsilon(1e-8));
    }
}

/// Mean chance of a right answer at the levels that a long staircase visits, for a logistic
/// observer.
double mean_level(StaircaseSpec spec, std::uint64_t seed) {
    spec.trials = 6000;
    Staircase staircase(spec);
    Random random(seed);
    double sum = 0.0;
    while (!staircase.finished()) {
        const double x = staircase.level();
        sum += staircase.trials() >= 200 ? x : 0.0;
        staircase.update(x, random.in(0, 1) < core(Family::logistic, x, 0.0, 1.0));
    }
    return sum / 5800.0;
}

}  // namespace

// The answers and levels of these two are tabulated in PsychoPy's test of its StairHandler: a
// 1-up-3-down staircase that moves by single answers until its first reversal. The answers: four
// right, four wrong, and again.
TEST_CASE("a staircase of linear steps runs a published sequence") {
    Staircase staircase({.start = 0.8,
                         .down = 3,
                         .steps_up = {0.1, 0.01, 0.001},
                         .steps_down = {0.1, 0.01, 0.001},
                         .fast_start = true,
                         .lowest = 0.0,
                         .highest = 1.0,
                         .trials = 20});
    std::vector<std::size_t> turned;
    check_same(levels(staircase, "11110000111100001111", &turned),
               {0.8,  0.7,   0.6,   0.5,  0.4,   0.41,  0.42,  0.43,  0.44,  0.44,
                0.44, 0.439, 0.439, 0.44, 0.441, 0.442, 0.443, 0.443, 0.443, 0.442});
    CHECK(turned == std::vector<std::size_t>{4, 10, 12, 18});
    check_same(staircase.reversals(), {0.4, 0.44, 0.439, 0.443});
    CHECK(staircase.finished());
}

TEST_CASE("staircases of decibels and of logarithms run a published sequence") {
    const bool decibels = GENERATE(true, false);
    StaircaseSpec spec{.start = 0.8,
                       .down = 3,
                       .steps_up = {0.4, 0.2, 0.2, 0.1},
                       .scale = StepScale::db,
                       .fast_start = true,
                       .lowest = 0.0,
                       .highest = 1.0,
                       .trials = 20};
    if (!decibels) {
        spec.scale = StepScale::log10;
        for (double& step : spec.steps_up) {
            step /= 20.0;
        }
    }
    spec.steps_down = spec.steps_up;
    Staircase staircase(spec);
    check_same(
        levels(staircase, "11110000111100001111"),
        {0.8,         0.763994069, 0.729608671, 0.696770872, 0.665411017, 0.680910431, 0.696770872,
         0.713000751, 0.729608671, 0.729608671, 0.729608671, 0.713000751, 0.713000751, 0.72125691,
         0.729608671, 0.738057142, 0.746603441, 0.746603441, 0.746603441, 0.738057142});
}

TEST_CASE("a one-up-one-down staircase runs a published sequence") {
    Staircase staircase({.start = 0.8,
                         .down = 1,
                         .steps_up = {0.1},
                         .steps_down = {0.1},
                         .trials = 10,
                         .average = 4});
    std::vector<std::size_t> turned;
    check_same(levels(staircase, "1101101101", &turned),
               {0.8, 0.7, 0.6, 0.7, 0.6, 0.5, 0.6, 0.5, 0.4, 0.5});
    CHECK(turned == std::vector<std::size_t>{2, 3, 5, 6, 8, 9});
    CHECK(staircase.estimate().mean.value() == Approx((0.5 + 0.6 + 0.4 + 0.5) / 4.0));
}

TEST_CASE("the targets are Levitt's and Kaernbach's") {
    // Levitt 1971, table I: .500, .707, .794, .841.
    constexpr std::array kLevitt{0.5, 0.707, 0.794, 0.841};
    for (std::size_t down = 1; down <= 4; ++down) {
        CHECK(target({.down = down}) == Approx(kLevitt[down - 1]).margin(5e-4));
        CHECK(std::pow(target({.down = down}), double(down)) == Approx(0.5).epsilon(1e-14));
    }
    // Kaernbach 1991: S_up (1 - p) = S_down p; p = .75 wants steps of 1 down and 3 up.
    CHECK(weighted_step_ratio(0.75) == Approx(1.0 / 3.0).epsilon(1e-15));
    for (const double p : {0.3, 0.6, 0.75, 0.9}) {
        CHECK(
            target({.down = 1, .steps_up = {2.0}, .steps_down = {2.0 * weighted_step_ratio(p)}}) ==
            Approx(p).epsilon(1e-14));
    }
    CHECK(std::isnan(target({.up = 2})));
}

TEST_CASE("a staircase settles at its target on a simulated logistic observer") {
    // The small step keeps the curvature of the function out; 6,000 trials leave a spread of about
    // .05 on the axis, where a wrong rule would be off by .5 or more.
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
        for (std::size_t down = 1; down <= 4; ++down) {
            const double p = std::pow(0.5, 1.0 / static_cast<double>(down));
            CAPTURE(seed, down);
            CHECK(mean_level({.down = down, .steps_up = {0.1}, .steps_down = {0.1}}, seed) ==
                  Approx(std::log(p / (1.0 - p))).margin(0.2));
        }
        for (const double p : {0.35, 0.6, 0.75, 0.85}) {
            CAPTURE(seed, p);
            CHECK(mean_level(
                      {.down = 1, .steps_up = {0.1}, .steps_down = {0.1 * weighted_step_ratio(p)}},
                      seed) == Approx(std::log(p / (1.0 - p))).margin(0.2));
        }
    }
}

TEST_CASE("a staircase never leaves its bounds, and ends by reversals") {
    SEEDED(random, std::uint64_t{200});
    StaircaseSpec spec{.start = random.in(1.0, 3.0),
                       .up = static_cast<std::size_t>(1 + random.below(3)),
                       .down = static_cast<std::size_t>(1 + random.below(3)),
                       .steps_up = {random.decade(-1, 0.5), random.decade(-2, 0)},
                       .steps_down = {random.decade(-1, 0.5)},
                       .scale = static_cast<StepScale>(random.below(3)),
                       .fast_start = random.coin(),
                       .lowest = 0.5,
                       .highest = 4.0,
                       .reversals = static_cast<std::size_t>(1 + random.below(12))};
    Staircase staircase(spec);
    while (!staircase.finished()) {
        REQUIRE(staircase.level() >= 0.5);
        REQUIRE(staircase.level() <= 4.0);
        staircase.update(staircase.level(), random.coin());
        REQUIRE(staircase.trials() < 10'000);
    }
    CHECK(staircase.reversals().size() == spec.reversals);
    CHECK(staircase.estimate().mean.value() >= 0.5);
    CHECK(staircase.estimate().mean.value() <= 4.0);
}

TEST_CASE("ways up and down meet at one level, to the bit, whatever their steps") {
    // From a bound on the way, too, and of linear ones from another track's start.
    SEEDED(random, std::uint64_t{200});
    const auto scale = static_cast<StepScale>(random.below(3));
    const double step = std::round(random.decade(1, 3)) * 1e-3;
    const auto at = [&](int steps) {
        return scale == StepScale::linear ? 0.3 + steps * step
             : scale == StepScale::db     ? 0.3 * std::pow(10.0, steps * step / 20.0)
                                          : 0.3 * std::pow(10.0, steps * step);
    };
    const int below = scale == StepScale::linear ? 0 : -20;
    const int above = scale == StepScale::log10 ? 8 : 20;
    std::set<double> met;
    for (const int start : scale == StepScale::linear ? std::vector{0, 7} : std::vector{0}) {
        Staircase staircase({.start = at(start),
                             .down = 1,
                             .steps_up = {step},
                             .steps_down = {step},
                             .scale = scale,
                             .lowest = at(below),
                             .highest = at(above),
                             .trials = 500});
        while (!staircase.finished()) {
            met.insert(staircase.level());
            staircase.update(staircase.level(), random.coin());
        }
    }
    for (const double level : met) {
        CHECK(std::ranges::count_if(met, [level](double other) {
                  return std::fabs(other - level) < 1e-9 * std::fabs(level);
              }) == 1);
    }
    CHECK(met.size() > 8);
}

TEST_CASE("interleaving is fair and each track goes its own way") {
    std::vector<StaircaseSpec> specs;
    for (int i = 0; i < 3; ++i) {
        specs.push_back({.name = std::string(1, static_cast<char>('a' + i)),
                         .start = 10.0 * i,
                         .trials = 4000});
    }
    Staircases run(specs, Pcg32(7, 9));
    std::map<std::pair<std::size_t, std::size_t>, int> neighbours;
    std::vector<Staircase> alone;
    for (const StaircaseSpec& spec : specs) {
        alone.emplace_back(spec);
    }
    Random random(1);
    std::size_t before = 0;
    constexpr int kTrials = 9000;  // nobody is finished yet, but for one seed in thousands
    for (int i = 0; i < kTrials; ++i) {
        const std::size_t track = run.track();
        ++neighbours[{before, track}];
        before = track;
        REQUIRE(run.next()[0] == alone[track].level());
        const bool right = random.coin();
        alone[track].update(alone[track].level(), right);
        run.update(run.next(), right ? 1 : 0);
    }
    // Chi-square over the pairs of neighbours: 8 degrees of freedom, 26.1 is passed once in a
    // thousand.
    CHECK(chi_square(neighbours, 9) < 26.1);
    while (!run.finished()) {
        run.update(run.next(), 1);
    }
    CHECK(run.trials() == 12'000);
    CHECK(run.estimates().size() == 3);
    CHECK_THROWS_WITH(run.update(run.next(), 1), Has("every staircase has ended"));
}

TEST_CASE("constant stimuli are balanced, in all orders alike") {
    const std::vector<double> values{1.0, 2.0, 3.0};
    std::map<std::vector<double>, int> orders;
    constexpr int kRuns = 6000;
    for (std::uint64_t seed = 0; seed < kRuns; ++seed) {
        const ConstantStimuli run({.values = values, .repetitions = 1}, Pcg32(seed, 3));
        ++orders[std::vector<double>(run.order().begin(), run.order().end())];
    }
    REQUIRE(orders.size() == 6);
    CHECK(chi_square(orders, 6) < 20.5);  // 5 degrees of freedom, once in a thousand

    for (std::uint64_t seed = 0; seed < 50; ++seed) {
        const bool in_blocks = seed % 2 == 0;
        ConstantStimuli run({.values = evenly(-4, 4, 7), .repetitions = 6, .in_blocks = in_blocks},
                            Pcg32(seed, 1));
        std::map<double, int> counts;
        while (!run.finished()) {
            ++counts[run.next()[0]];
            run.update(run.next(), 1);
            if (in_blocks && run.trials() % 7 == 0) {
                REQUIRE(even(counts, 7, run.trials() / 7));
            }
        }
        CHECK(run.trials() == 42);
        CHECK(even(counts, 7, 6));
        CHECK_THROWS_WITH(run.update(run.next(), 1), Has("every stimulus was shown"));
    }
}

TEST_CASE("a staircase that makes no sense is refused with the remedy") {
    CHECK_THROWS_WITH(Staircase({.start = 1}),
                      Has("give trials, or, outside of a protocol, reversals"));
    CHECK_THROWS_WITH(Staircase({.start = 1, .steps_up = {}, .trials = 5}),
                      Has("step_up is empty"));
    CHECK_THROWS_WITH(Staircase({.start = 1, .steps_down = {-1.0}, .trials = 5}),
                      Has("step_down holds -1"));
    CHECK_THROWS_WITH(Staircase({.start = 9, .highest = 4, .trials = 5}), Has("start is 9"));
    CHECK_THROWS_WITH(Staircase({.start = 0, .scale = StepScale::db, .trials = 5}), Has("above 0"));
    CHECK_THROWS_WITH(Staircases({{.trials = 5}, {.trials = 5}}, Pcg32(1, 1)),
                      Has("two staircases are called staircase"));
    CHECK_THROWS_WITH(Staircases({}, Pcg32(1, 1)), Has("no staircase"));
    Staircases db({{.start = 1.0, .scale = StepScale::db, .trials = 5}}, Pcg32(1, 1));
    CHECK_THROWS_WITH(db.update(std::vector<double>{0.0}, 1), Has("above 0"));
    CHECK_THROWS_WITH(db.update(std::vector<double>{1.0}, 2), Has("give 0 or 1"));
}

TEST_CASE("answers that are left out later move no other to another staircase") {
    SEEDED(random, std::uint64_t{100});
    std::vector<StaircaseSpec> specs;
    for (const char* name : {"far", "near", "other"}) {
        specs.push_back({.name = name, .start = random.in(1.0, 9.0), .trials = 12});
    }
    Procedure run(specs, Pcg32(seed, 5));
    Procedure kept(specs, Pcg32(seed, 5));
    std::map<std::string, Staircase, std::less<>> alone;
    for (const StaircaseSpec& spec : specs) {
        alone.emplace(spec.name, spec);
    }
    const auto answer = [&](double shown, bool right, const std::string& track) {
        kept.update(std::span(&shown, 1), right ? 1 : 0, track);
        alone.at(track).update(shown, right);
    };
    const double share = random.in(0.1, 0.6);
    while (!run.finished()) {
        const std::string track(run.track());
        const double shown = run.next().at(0);
        const bool right = random.coin();
        run.update(std::span(&shown, 1), right ? 1 : 0, track);
        if (random.in(0.0, 1.0) > share) {
            answer(shown, right, track);
        }
    }
    while (!kept.finished()) {  // each is run to its end, from where its own answers led
        REQUIRE(kept.next().at(0) == alone.at(std::string(kept.track())).level());
        answer(kept.next().at(0), random.coin(), std::string(kept.track()));
    }
    CHECK(kept.trials() == 36);
    for (const Estimate& estimate : kept.estimates()) {
        const Estimate own = alone.at(estimate.name).estimate();
        CHECK((estimate.mean == own.mean && estimate.sd == own.sd));
    }
    const double one = 1.0;
    CHECK_THROWS_WITH(Procedure(specs, Pcg32(1, 1)).update(std::span(&one, 1), 1, "farther"),
                      Has("there is no staircase farther"));
}

TEST_CASE("a constant stimulus whose answer is left out comes again") {
    SEEDED(random, std::uint64_t{100});
    const ConstantStimuliSpec spec{
        .values = {1.0, 2.0, 2.0, 3.0, 4.0}, .repetitions = 4, .in_blocks = random.coin()};
    Procedure run(spec, Pcg32(seed, 5));
    Procedure kept(spec, Pcg32(seed, 5));
    std::map<double, int> counts;
    const auto answer = [&](const std::vector<double>& shown) {
        kept.update(shown, 1);
        ++counts[shown.at(0)];
    };
    for (int i = random.below(20); i > 0; --i) {
        const std::vector<double> shown = run.next();
        run.update(shown, 1);
        if (random.coin()) {
            answer(shown);
        }
    }
    while (!kept.finished()) {
        answer(kept.next());
    }
    CHECK(counts == std::map<double, int>{{1.0, 4}, {2.0, 8}, {3.0, 4}, {4.0, 4}});
}

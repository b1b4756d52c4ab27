#include "protocols/observer/simulated_observer.hpp"
#include "tests/protocols/strokes.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/scenes.hpp"

using namespace palpate::protocols;

namespace {

const std::vector<double> kCurvatures{-10.0, -5.0, 0.0, 5.0, 10.0};
const std::vector<std::size_t> kOrder{3, 0, 4, 1, 2};  // place -> object
const std::vector<Picture> kPictures(5);

Protocol observed_study(double noise, double lapse) {
    Protocol protocol;
    for (const double curvature : kCurvatures) {
        protocol.objects.push_back({.name = "", .curvature = curvature});
    }
    protocol.observer = {.noise = noise, .lapse = lapse, .force_weight = 0.5};
    return protocol;
}

TrialView trial(std::size_t number) {
    return {.total = 1000, .done = number, .explore_min_s = 2.0};
}

SimulatedObserver observer(const Protocol& protocol, std::uint64_t seed = 1) {
    return {protocol,
            {.protocol_hash = "h", .participant = "p", .purpose = "", .seed = seed},
            kOrder,
            [] {
                return true;
            }};
}

/// The object that is chosen in one trial.
std::size_t answer(SimulatedObserver& who,
                   std::size_t number,
                   std::span<const palpate::engine::TickRecord> ticks) {
    REQUIRE(who.ready(trial(number)) == Signal::go_on);
    who.feel(ticks);
    return kOrder.at(who.choose(trial(number), which_of(kPictures)).place);
}

}  // namespace

TEST_CASE("without noise every object is named right, and strokes with friction bias nothing") {
    EACH(mu, 0.0, 0.3, 0.5, 0.7);
    const Protocol protocol = observed_study(0.0, 0.0);
    SimulatedObserver who = observer(protocol);
    for (std::size_t object = 0; object < kCurvatures.size(); ++object) {
        const double curvature = kCurvatures[object];
        CHECK(answer(who, object + 1, strokes({.curvature = curvature, .mu = mu})) == object);
        CHECK(std::fabs(who.percept().value() - curvature) < 0.02 * std::fabs(curvature) + 0.02);
    }
}

TEST_CASE("a friction bias shifts the percept by its size times the coefficient") {
    Protocol protocol = observed_study(0.0, 0.0);
    SimulatedObserver plain = observer(protocol);
    protocol.observer.bias_per_mu = 4.0;
    SimulatedObserver biased = observer(protocol);
    const auto ticks = strokes({.curvature = 5.0, .mu = 0.5});
    static_cast<void>(answer(plain, 1, ticks));
    static_cast<void>(answer(biased, 1, ticks));
    CHECK(*biased.percept() - *plain.percept() == Approx(2.0));
}

TEST_CASE("lapses are spread over all pictures, and so are answers after nothing felt") {
    const bool felt = GENERATE(true, false);
    const Protocol protocol = observed_study(0.0, felt ? 1.0 : 0.0);
    SimulatedObserver who = observer(protocol);
    const auto ticks =
        felt ? strokes({.curvature = 5.0}) : std::vector<palpate::engine::TickRecord>{};
    std::vector<int> chosen(5, 0);
    for (std::size_t i = 1; i <= 1000; ++i) {
        ++chosen[answer(who, i, ticks)];
    }
    for (const int count : chosen) {
        CHECK(std::abs(count - 200) < 5 * 13);
    }
}

TEST_CASE("an answer depends on the key and the trial's number, not on what came before") {
    const Protocol protocol = observed_study(2.62, 0.02);
    const auto ticks = strokes({.curvature = 5.0});
    SimulatedObserver unbroken = observer(protocol);
    std::vector<Choice> choices;
    for (std::size_t i = 1; i <= 30; ++i) {
        static_cast<void>(unbroken.ready(trial(i)));
        unbroken.feel(ticks);
        choices.push_back(unbroken.choose(trial(i), which_of(kPictures)));
    }
    SimulatedObserver resumed = observer(protocol);
    int differs = 0;
    SimulatedObserver other = observer(protocol, 2);
    for (std::size_t i = 20; i <= 30; ++i) {
        static_cast<void>(resumed.ready(trial(i)));
        resumed.feel(ticks);
        const Choice choice = resumed.choose(trial(i), which_of(kPictures));
        CHECK(choice.place == choices[i - 1].place);
        CHECK(choice.reaction_s == choices[i - 1].reaction_s);
        static_cast<void>(other.ready(trial(i)));
        other.feel(ticks);
        differs +=
            other.choose(trial(i), which_of(kPictures)).reaction_s != choice.reaction_s ? 1 : 0;
    }
    CHECK(differs == 11);
}

TEST_CASE("nobody answers before the guard time, nor after the time-out") {
    Protocol protocol = observed_study(2.62, 0.02);
    protocol.timing.guard = 1.0;
    SimulatedObserver who = observer(protocol);
    Question question = which_of(kPictures);
    question.timeout_s = 1.5;
    question.confidence = GENERATE(false, true);
    int late = 0;
    for (std::size_t i = 0; i < 400; ++i) {
        const Choice choice = who.choose(trial(i), question);
        if (choice.signal == Signal::too_late) {
            ++late;
            continue;
        }
        CHECK((choice.reaction_s >= 1.0 && choice.reaction_s < 1.5));
        CHECK(choice.confidence.has_value() == question.confidence);
        CHECK((!question.confidence || choice.confidence_reaction_s < 1.5));
    }
    CHECK((late > 40 && late < 360));
}

TEST_CASE("the observer is done when its hand is, not before the minimum") {
    bool hand_is_done = false;
    const Protocol protocol = observed_study(0.0, 0.0);
    SimulatedObserver who(protocol, {}, kOrder, [&] { return hand_is_done; });
    CHECK(who.explore(trial(1), 10.0).signal == Signal::go_on);
    hand_is_done = true;
    CHECK(who.explore(trial(1), 1.9).signal == Signal::go_on);
    CHECK(who.explore(trial(1), 2.0).signal == Signal::done);
    CHECK(who.explore(trial(1), 2.5).at_s == 2.5);
}

TEST_CASE("reaction times are those of people") {
    const Protocol protocol = observed_study(2.62, 0.0);
    SimulatedObserver who = observer(protocol);
    double sum = 0.0;
    for (std::size_t i = 1; i <= 2000; ++i) {
        const double reaction = who.choose(trial(i), which_of(kPictures)).reaction_s;
        CHECK(reaction >= 0.25);
        sum += reaction;
    }
    CHECK(sum / 2000.0 == Approx(1.5).margin(0.07));  // 0.8 + 0.7; standard error 0.016
}

TEST_CASE("normal and exponential draws have their moments") {
    Pcg32 random(3, 4);
    constexpr int kDraws = 200000;
    double sum = 0.0, squares = 0.0, fourth = 0.0, within = 0.0, waits = 0.0;
    for (int i = 0; i < kDraws; ++i) {
        const double z = normal_draw(random);
        sum += z;
        squares += z * z;
        fourth += z * z * z * z;
        within += std::fabs(z) < 1.0 ? 1.0 : 0.0;
        const double wait = exponential_draw(random);
        REQUIRE(wait >= 0.0);
        waits += wait;
    }
    CHECK(std::fabs(sum / kDraws) < 4.0 * std::sqrt(1.0 / kDraws));
    CHECK(std::fabs(squares / kDraws - 1.0) < 4.0 * std::sqrt(2.0 / kDraws));
    CHECK(std::fabs(fourth / kDraws - 3.0) < 4.0 * std::sqrt(96.0 / kDraws));
    CHECK(std::fabs(within / kDraws - 0.682689) < 4.0 * std::sqrt(0.2166 / kDraws));
    CHECK(std::fabs(waits / kDraws - 1.0) < 4.0 * std::sqrt(1.0 / kDraws));
}

// Near value: a script in another language, with libm's logarithm. Exact value: this code's own,
// the same from debug and optimised builds; it must never change, or recorded simulations could not
// be repeated.
TEST_CASE("draws are the same to the last bit in every build") {
    Pcg32 random(42, 54);
    double sum = 0.0;
    for (int i = 0; i < 1000; ++i) {
        sum += normal_draw(random);
    }
    CHECK(sum == Approx(-11.329851741512321).epsilon(1e-12));
    CHECK(sum == -0x1.6a8e253d4a5e7p+3);
}

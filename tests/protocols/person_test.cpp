#include "protocols/file/observer_file.hpp"
#include "protocols/observer/simulated_observer.hpp"
#include "tests/protocols/simulated_answers.hpp"
#include "tests/protocols/strokes.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/scenes.hpp"

using namespace palpate::protocols;

namespace {

StreamKey key_of(std::size_t person, std::uint64_t seed = 1) {
    return {.protocol_hash = "h",
            .participant = "S" + std::to_string(person),
            .purpose = "",
            .seed = seed};
}

double logit_of(double share) {
    return std::log(share / (1.0 - share));
}

template <class Number>
Spread over_people(const ObserverModel& model, Number number) {
    std::vector<double> values;
    for (std::size_t i = 0; i < 4000; ++i) {
        values.push_back(number(drawn_person(model, key_of(i))));
    }
    return spread_of(values);
}

/// 4 standard errors of 4,000 people.
void check_spread(const Spread& found, double mean, double sd) {
    CHECK(found.mean == Approx(mean).margin(4.0 * sd / std::sqrt(4000.0)));
    CHECK(found.sd == Approx(sd).epsilon(4.0 / std::sqrt(8000.0)));
}

Protocol study_of(const std::vector<double>& curvatures) {
    Protocol protocol;
    for (const double curvature : curvatures) {
        protocol.objects.push_back({.name = "", .curvature = curvature});
    }
    return protocol;
}

Protocol three_objects() {
    return study_of({-10.0, 0.0, 10.0});
}

double below(double z) {
    return 0.5 * std::erfc(-z / std::numbers::sqrt2);
}

Protocol five_objects() {
    Protocol protocol = study_of({-10.0, -5.0, 0.0, 5.0, 10.0});
    protocol.frictions = {{.name = "off"}, {.name = "on", .mu_s = 0.7, .mu_d = 0.5}};
    protocol.design.repetitions = 10;
    return protocol;
}

/// Hands that feel each curvature as it is.
std::vector<FeltTrial> exact_hands(const Protocol& protocol) {
    std::vector<FeltTrial> hands;
    for (std::size_t object = 0; object < protocol.objects.size(); ++object) {
        for (const std::size_t friction : {0U, 1U}) {
            const double curvature = protocol.objects[object].curvature;
            hands.push_back({object, friction,
                             Cues{.force = curvature,
                                  .position = curvature,
                                  .friction = friction == 1 ? 0.5 : 0.0}});
        }
    }
    return hands;
}

constexpr FrictionPair kPair{.without = 0, .with = 1};

struct Sums {
    double expected = 0.0;
    double without = 0.0;
    double with = 0.0;
    double trials = 0.0;
};

Sums sums_of(const JudgedPeople& people, std::size_t count) {
    Sums sums;
    for (std::size_t i = 0; i < count; ++i) {
        const JudgedPerson one = people.person(3, i / 20, i % 20);
        sums.expected += (one.share_with - one.share_without) / static_cast<double>(count);
        sums.without += static_cast<double>(one.right_without);
        sums.with += static_cast<double>(one.right_with);
        sums.trials += static_cast<double>(one.trials);
    }
    return sums;
}

}  // namespace

TEST_CASE("people are drawn with the spread that an observer file says") {
    ObserverModel model;
    model.typical = {
        .noise = 2.0, .lapse = 0.1, .force_weight = 0.5, .bias_per_mu = 3.0, .noise_mu = 0.1};
    model.friction.noise_per_mu = 1.7;
    model.people = {.noise = 0.4,
                    .bias = 1.5,
                    .lapse = 0.6,
                    .force_weight = 0.1,
                    .bias_per_mu = 2.0,
                    .noise_per_mu = 0.3,
                    .reaction = 0.2,
                    .speed = 0.1,
                    .press = 0.05};
    const auto spread = [&](auto number) {
        return over_people(model, number);
    };
    check_spread(spread([](const Person& p) { return std::log(p.spec.noise); }), std::log(2.0),
                 0.4);
    check_spread(spread([](const Person& p) { return p.bias; }), 0.0, 1.5);
    check_spread(spread([](const Person& p) { return logit_of(p.spec.lapse); }), logit_of(0.1),
                 0.6);
    check_spread(spread([](const Person& p) { return p.spec.force_weight; }), 0.5, 0.1);
    check_spread(spread([](const Person& p) { return p.spec.bias_per_mu; }), 3.0, 2.0);
    check_spread(spread([](const Person& p) { return std::log(p.noise_per_mu); }), std::log(1.7),
                 0.3);
    check_spread(spread([](const Person& p) { return std::log(p.reaction->median); }),
                 std::log(1.5), 0.2);
    check_spread(spread([](const Person& p) { return std::log(p.hand.speed); }), 0.0, 0.1);
    check_spread(spread([](const Person& p) { return std::log(p.hand.press); }), 0.0, 0.05);
}

TEST_CASE(
    "without a spread everybody is the typical one, and a person is the same in all sessions") {
    ObserverModel model = typical_observer();
    StreamKey key = key_of(7);
    const Person first = drawn_person(model, key);
    key.session = 5;
    key.block = 9;
    CHECK(drawn_person(model, key) == first);
    key.seed = 2;
    CHECK_FALSE(drawn_person(model, key) == first);
    model.people = {};
    const Person all{.spec = model.typical,
                     .noise_per_mu = model.friction.noise_per_mu,
                     .learning = model.learning,
                     .reaction = model.reaction,
                     .hand = model.hand};
    CHECK(drawn_person(model, key) == all);
    CHECK(drawn_person(model, key_of(8)) == all);
}

TEST_CASE("the noise of a percept is learned away and grows with felt friction") {
    SEEDED(random, 50U);
    Person person;
    person.spec.noise = random.in(0.1, 5.0);
    person.noise_per_mu = random.in(0.2, 5.0);
    person.learning = {.first = random.in(0.5, 3.0), .trials = random.in(1.0, 100.0)};
    const double friction = random.in(0.0, 1.0);
    const auto done = static_cast<std::size_t>(random.in(0.0, 200.0));
    const double n = static_cast<double>(done);
    const double expected =
        person.spec.noise *
        (1.0 + (person.learning.first - 1.0) * std::exp(-n / person.learning.trials)) *
        std::pow(person.noise_per_mu, friction);
    CHECK(percept_noise(person, friction, done) == Approx(expected).epsilon(1e-12));
    CHECK(percept_noise(person, 0.0, 1'000'000) == Approx(person.spec.noise).epsilon(1e-12));

    const Cues both{.force = 4.0, .position = 2.0, .friction = friction};
    person.bias = random.in(-2.0, 2.0);
    person.spec.bias_per_mu = random.in(-5.0, 5.0);
    person.spec.force_weight = random.in(0.0, 1.0);
    const double w = person.spec.force_weight;
    const double extra = person.bias + person.spec.bias_per_mu * friction;
    CHECK(*percept_mean(person, both) == Approx(4.0 * w + 2.0 * (1.0 - w) + extra));
    CHECK(*percept_mean(person, {.force = 4.0, .position = {}, .friction = friction}) ==
          Approx(4.0 + extra));
    CHECK_FALSE(percept_mean(person, {}));
}

TEST_CASE("a person's own bias and noise decide the answers") {
    const Protocol protocol = three_objects();
    const std::vector<Picture> pictures(3);
    Person person{.spec = {.noise = 3.0, .lapse = 0.0, .force_weight = 0.5}};
    person.bias = 4.0;
    person.learning = {.first = 2.0, .trials = 1e9};  // never learned within these trials
    SimulatedObserver who(
        protocol, key_of(1), {0, 1, 2}, [] { return true; }, person);
    const auto ticks = tests::strokes({.curvature = 0.0, .passes = 2});
    constexpr std::size_t kTrials = 4000;
    double convex = 0.0;
    for (std::size_t i = 0; i < kTrials; ++i) {
        const TrialView view{.total = kTrials, .done = i};
        REQUIRE(who.ready(view) == Signal::go_on);
        who.feel(ticks);
        convex += who.choose(view, which_of(pictures)).place == 2 ? 1.0 : 0.0;
    }
    // Above 5 1/m with a mean of 4 and a noise of 6: 1 - Phi(1/6) = .4338; 4 standard errors.
    CHECK(convex / kTrials == Approx(0.4338).margin(4.0 * std::sqrt(0.4338 * 0.5662 / kTrials)));
}

TEST_CASE("reaction times of a person are lognormal, longer in doubt, and add up to a session") {
    const Protocol protocol = three_objects();
    const std::vector<Picture> pictures(3);
    Person person;
    person.reaction = ReactionSpec{.median = 2.0, .spread = 0.3, .doubt = 1.8};
    SimulatedObserver who(
        protocol, key_of(1), {0, 1, 2}, [] { return true; }, person);
    constexpr std::size_t kTrials = 4000;
    std::vector<double> logs;
    double time = 0.0;
    for (std::size_t i = 0; i < kTrials; ++i) {  // nothing is felt: each answer is a guess
        const TrialView view{.total = kTrials, .done = i};
        REQUIRE(who.ready(view) == Signal::go_on);
        static_cast<void>(who.explore(view, 3.5));
        const double reaction = who.choose(view, which_of(pictures)).reaction_s;
        REQUIRE(who.feedback(view, true) == Signal::go_on);
        REQUIRE(who.gap(1.5) == Signal::go_on);
        time += 3.5 + reaction + 1.0 + 1.5;
        logs.push_back(std::log(reaction));
    }
    check_spread(spread_of(logs), std::log(2.0 * 1.8), 0.3);
    CHECK(who.time_s() == Approx(time));
}

TEST_CASE("an observer file says what it means: read, written and read again it is the same") {
    CHECK(parse_observer(observer_example(), "example") == typical_observer());
    CHECK(parse_observer("format = 1\n", "empty") == ObserverModel{});
    CHECK(load_observer("typical") == typical_observer());
    SEEDED(random, 100U);
    ObserverModel model;
    model.typical = {.noise = random.in(0.0, 9.0),
                     .lapse = random.in(0.0, 1.0),
                     .force_weight = random.in(0.0, 1.0),
                     .bias_per_mu = random.in(-9.0, 9.0),
                     .noise_mu = random.in(0.0, 1.0)};
    model.friction.noise_per_mu = random.in(0.1, 9.0);
    model.people.bias = random.in(0.0, 9.0);
    model.people.press = random.in(0.0, 1.0);
    model.learning = {.first = random.in(0.5, 2.0), .trials = random.in(1.0, 99.0)};
    model.reaction.doubt = random.in(1.0, 3.0);
    model.hand = {.speed = random.in(0.3, 2.0), .press = random.in(0.7, 1.9)};
    CHECK(parse_observer(observer_text(model), "text") == model);
}

TEST_CASE("what is wrong with an observer file is said with its line and column") {
    const std::string text =
        "format = 1\n[observer]\nnoise_per_m = -2\nlaps = 1\n[people]\nnoise_sd_ln = \"a\"\n"
        "[persons]\n";
    try {
        static_cast<void>(parse_observer(text, "o.toml"));
        FAIL("it was read");
    } catch (const ProtocolError& e) {
        const std::string what = e.what();
        for (const char* one :
             {"o.toml:3:15: noise_per_m is -2: give 0 to 1000", "o.toml:4:1: unknown key \"laps\"",
              "o.toml:6:15: noise_sd_ln is \"a\"", "o.toml:7:2: unknown key \"persons\""}) {
            CHECK_THAT(what, Has(one));
        }
    }
    CHECK_THROWS_AS(parse_observer("[observer]\n", "o.toml"), ProtocolError);
}

TEST_CASE("people who all judge alike are right as often as criteria midway say") {
    const Protocol protocol = five_objects();
    ObserverModel model;
    model.typical.lapse = 0.1;
    model.friction.noise_per_mu = 4.0;  // 2 at a felt friction of 0.5
    const auto share = [](double sigma) {
        const double judged =
            (3.0 * (2.0 * below(2.5 / sigma) - 1.0) + 2.0 * below(2.5 / sigma)) / 5.0;
        return 0.1 * 0.2 + 0.9 * judged;
    };
    const JudgedPeople people(protocol, model, exact_hands(protocol), kPair, {});
    const JudgedPerson one = people.person(1, 0, 0);
    CHECK(one.trials == 50);
    CHECK(one.share_without == Approx(share(2.62)).epsilon(1e-12));
    CHECK(one.share_with == Approx(share(5.24)).epsilon(1e-12));
    const Sums sums = sums_of(people, 200);  // 10,000 trials each: 4 standard errors
    CHECK(sums.without / sums.trials == Approx(share(2.62)).margin(0.02));
    CHECK(sums.with / sums.trials == Approx(share(5.24)).margin(0.02));
}

TEST_CASE(
    "whoever is judged has practised as a session asks for, and learns from one to the next") {
    EACH(practice, 0U, 1U, 5U);
    Protocol protocol = five_objects();
    protocol.design.practice_repetitions = practice;
    ObserverModel model;
    model.typical.lapse = 0.0;
    model.learning = {.first = 3.0, .trials = 40.0};
    const Person typical{.spec = model.typical, .learning = model.learning};
    double expected = 0.0;
    for (std::size_t i = 0; i < 100; ++i) {
        const double sigma = percept_noise(typical, 0.0, 10 * practice + i);
        expected += (8.0 * below(2.5 / sigma) - 3.0) / 5.0 / 100.0;
    }
    const JudgedPeople people(protocol, model, exact_hands(protocol), kPair, {});
    const Sums sums = sums_of(people, 400);  // 20,000 trials: 4 standard errors
    CHECK(sums.without / sums.trials == Approx(expected).margin(0.0142));
    CHECK(people.person(1, 0, 0).share_without == Approx(expected).margin(0.03));
}

TEST_CASE("an effect in log odds is that effect for every person, and none is none") {
    EACH(mean, -1.0, -0.3, 0.0, 0.5);
    const Protocol protocol = five_objects();
    ObserverModel model = typical_observer();
    model.people.bias = 2.0;  // some can hardly be right at all
    const JudgedPeople people(protocol, model, exact_hands(protocol), kPair,
                              LogitEffect{.mean = mean, .sd = 0.0});
    for (std::size_t i = 0; i < 50; ++i) {
        const JudgedPerson one = people.person(1, 7, i);
        CHECK(logit_of(one.share_with) - logit_of(one.share_without) == Approx(mean).margin(1e-9));
    }
    const Sums sums = sums_of(people, 800);  // 40,000 trials each
    CHECK((sums.with - sums.without) / sums.trials == Approx(sums.expected).margin(0.014));
}

TEST_CASE("people who differ by 0.8 logit without an effect have none on average, as a share") {
    const Protocol protocol = five_objects();
    const JudgedPeople people(protocol, typical_observer(), exact_hands(protocol), kPair,
                              LogitEffect{.mean = 0.0, .sd = 0.8, .in_shares = true});
    double squares = 0.0;
    for (std::size_t i = 0; i < 2000; ++i) {
        const JudgedPerson one = people.person(3, i / 20, i % 20);
        const double p = one.share_without;
        squares += std::pow((one.share_with - p) / (p * (1.0 - p)), 2.0) / 2000.0;
    }
    CHECK(std::sqrt(squares) == Approx(0.75).epsilon(0.07));  // some are cut
    CHECK(sums_of(people, 2000).expected == Approx(0.0).margin(0.015));
}

TEST_CASE("a judged person is the same whoever was asked for before") {
    const Protocol protocol = five_objects();
    const JudgedPeople people(protocol, typical_observer(), exact_hands(protocol), kPair,
                              LogitEffect{.mean = -0.5, .sd = 0.3});
    const JudgedPerson first = people.person(1, 4, 2);
    static_cast<void>(people.person(1, 4, 3));
    const JudgedPerson again = people.person(1, 4, 2);
    CHECK(first.right_with == again.right_with);
    CHECK(first.right_without == again.right_without);
    CHECK(first.share_with == again.share_with);
    CHECK(people.person(1, 4, 3).share_without != first.share_without);
    CHECK(people.person(2, 4, 2).share_without != first.share_without);

    CHECK_THROWS_AS(JudgedPeople(protocol, {}, {}, kPair, {}), std::invalid_argument);
    Protocol rating = protocol;
    rating.response.kind = ResponseKind::rating;
    CHECK_THROWS_AS(JudgedPeople(rating, {}, exact_hands(protocol), kPair, {}),
                    std::invalid_argument);
}

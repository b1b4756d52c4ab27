#include "protocols/file/observer_file.hpp"
#include "protocols/observer/person.hpp"
#include "tests/support/catch.hpp"

using namespace palpate::protocols;

namespace {

double below(double z) {
    return 0.5 * std::erfc(-z / std::numbers::sqrt2);
}

double log_odds(double share) {
    return std::log(share / (1.0 - share));
}

Protocol five_objects() {
    Protocol protocol;
    for (const double curvature : {-10.0, -5.0, 0.0, 5.0, 10.0}) {
        protocol.objects.push_back({.name = "", .curvature = curvature});
    }
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

TEST_CASE("people who all judge alike are right as often as criteria midway say",
          "[observer][law]") {
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

TEST_CASE("an effect in log odds is that effect for every person, and none is none",
          "[observer][law]") {
    const double mean = GENERATE(-1.0, -0.3, 0.0, 0.5);
    CAPTURE(mean);
    const Protocol protocol = five_objects();
    ObserverModel model = typical_observer();
    model.people.bias = 2.0;  // some can hardly be right at all
    const JudgedPeople people(protocol, model, exact_hands(protocol), kPair,
                              LogitEffect{.mean = mean, .sd = 0.0});
    for (std::size_t i = 0; i < 50; ++i) {
        const JudgedPerson one = people.person(1, 7, i);
        CHECK(log_odds(one.share_with) - log_odds(one.share_without) == Approx(mean).margin(1e-9));
    }
    const Sums sums = sums_of(people, 800);  // 40,000 trials each
    CHECK((sums.with - sums.without) / sums.trials == Approx(sums.expected).margin(0.014));
}

TEST_CASE("people who differ by 0.8 logit without an effect have none on average, as a share",
          "[observer][law]") {
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

TEST_CASE("a judged person is the same whoever was asked for before", "[observer][law]") {
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

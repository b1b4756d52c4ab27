#include "data/inference/person_numbers.hpp"
#include "tests/support/catch.hpp"

using namespace palpate::data;

namespace {

struct Answered {
    std::vector<std::size_t> shapes;
    std::vector<std::size_t> responses;
};

/// `trials` of five shapes, each as often; a share of the answers is right, the others are any
/// shape.
Answered some_answers(std::mt19937_64& random, std::size_t trials, double right) {
    std::uniform_real_distribution<double> uniform;
    Answered all;
    for (std::size_t i = 0; i < trials; ++i) {
        all.shapes.push_back(i % 5);
        all.responses.push_back(uniform(random) < right ? i % 5 : random() % 5);
    }
    return all;
}

/// Bits of a channel that is right with probability `right` and guesses among five else.
double bits_of(double right) {
    const double hit = right + (1.0 - right) / 5.0;
    const double other = (1.0 - right) / 5.0;
    return std::log2(5.0) + hit * std::log2(hit) + 4.0 * other * std::log2(other);
}

}  // namespace

TEST_CASE("bits: all of five shapes known is log2 5, and a guesser of 50 trials shows 0.28 bits",
          "[inference]") {
    std::mt19937_64 random(1);
    const Answered sure = some_answers(random, 50, 1.0);
    const Transmitted all = transmitted(sure.shapes, sure.responses, 99, 1, 1);
    CHECK(all.bits.plug_in == Approx(std::log2(5.0)).epsilon(1e-12));
    CHECK(all.null_p == 0.01);
    CHECK(all.interval.value().high == Approx(std::log2(5.0)));
    double plug_in = 0.0;
    double null_mean = 0.0;
    double corrected = 0.0;
    int found = 0;
    constexpr int kGuessers = 200;
    for (int i = 0; i < kGuessers; ++i) {
        const Answered one = some_answers(random, 50, 0.0);
        const Transmitted sent = transmitted(one.shapes, one.responses, 99, 1, 1);
        plug_in += sent.bits.plug_in / kGuessers;
        null_mean += sent.null_mean.value() / kGuessers;
        corrected += sent.bits.miller_madow / kGuessers;
        found += sent.null_p <= 0.05 ? 1 : 0;
    }
    CHECK(std::fabs(plug_in - 0.28) < 0.02);
    CHECK(std::fabs(null_mean - plug_in) < 0.02);
    CHECK(std::fabs(corrected - 0.08) < 0.02);
    CHECK(found <= 22);  // 5 % of 200, and four of its errors
    const Answered one = some_answers(random, 50, 0.5);
    CHECK(transmitted(one.shapes, one.responses, 200, 1, 7).null_mean ==
          transmitted(one.shapes, one.responses, 200, 1, 7).null_mean);
    CHECK(transmitted(one.shapes, one.responses, 200, 2, 7).null_mean !=
          transmitted(one.shapes, one.responses, 200, 1, 7).null_mean);
    CHECK_FALSE(transmitted({}, {}, 10, 1, 1).interval);
}

TEST_CASE("the permutation null is the mean over all ways to deal the answers",
          "[inference][law]") {
    const std::vector<std::size_t> shapes{0, 0, 0, 1, 1, 1};
    const std::vector<std::size_t> responses{0, 0, 0, 0, 1, 1};
    // The two answers 1 fall on 15 pairs of trials: 9 mixed, 6 on one shape.
    const auto bits = [](double a, double b, double n) {
        const double p = a / n;
        return p == 0.0 ? 0.0 : p * std::log2(p / (b / n));
    };
    const double mixed = 2.0 * (bits(2, 3.0 * 4 / 6, 6) + bits(1, 3.0 * 2 / 6, 6));
    const double split =
        bits(3, 3.0 * 4 / 6, 6) + bits(1, 3.0 * 4 / 6, 6) + bits(2, 3.0 * 2 / 6, 6);
    const Transmitted sent = transmitted(shapes, responses, 40000, 5, 2);
    CHECK(sent.bits.plug_in == Approx(split).epsilon(1e-12));
    CHECK(sent.null_mean.value() == Approx((9.0 * mixed + 6.0 * split) / 15.0).epsilon(0.02));
    CHECK(sent.null_p.value() == Approx(0.4).margin(0.01));
}

// PALPATE_BITS_PEOPLE=4000 draws so many people; what then comes is in docs/data.md.
TEST_CASE("the interval of transmitted bits holds the channel's own", "[inference][law]") {
    const char* asked = std::getenv("PALPATE_BITS_PEOPLE");
    const int people = asked != nullptr ? std::atoi(asked) : 300;
    const double right = GENERATE(0.3, 0.5, 0.7);
    const std::size_t trials = GENERATE(std::size_t{50}, std::size_t{100});
    std::mt19937_64 random(3);
    int held = 0;
    double bias = 0.0;
    for (int i = 0; i < people; ++i) {
        const Answered one = some_answers(random, trials, right);
        const Transmitted sent = transmitted(one.shapes, one.responses, 0, 1, 1);
        held +=
            sent.interval->low <= bits_of(right) && bits_of(right) <= sent.interval->high ? 1 : 0;
        bias += (sent.bits.miller_madow - bits_of(right)) / people;
    }
    CAPTURE(right, trials, held, bias);
    if (asked != nullptr) {
        WARN("right " << right << ", " << trials << " trials: held "
                      << static_cast<double>(held) / people << ", Miller-Madow's bias " << bias);
    }
    CHECK(static_cast<double>(held) / people > 0.93 - 3.5 * std::sqrt(0.05 / people));
}

TEST_CASE("the area of confidence is the share of pairs, ties half, counted one by one",
          "[inference][law]") {
    const auto seed = GENERATE(palpate::tests::seeds(30U));
    std::mt19937 random(seed);
    const auto levels = [&] {
        std::vector<double> all(1 + random() % 20);
        for (double& one : all) {
            one = static_cast<double>(1 + random() % 4);
        }
        return all;
    };
    const auto right = levels();
    const auto wrong = levels();
    double pairs = 0.0;
    for (const double a : right) {
        for (const double b : wrong) {
            pairs += a > b ? 1.0 : a == b ? 0.5 : 0.0;
        }
    }
    CHECK(type_2_area(right, wrong).value() ==
          Approx(pairs / static_cast<double>(right.size() * wrong.size())).epsilon(1e-13));
    CHECK_FALSE(type_2_area(right, {}));
    CHECK_FALSE(type_2_area({}, wrong));
}

TEST_CASE("a trend gives back the slopes of a plane, and leaves out what it cannot tell apart",
          "[inference][law]") {
    const auto seed = GENERATE(palpate::tests::seeds(20U));
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    const double a = uniform(random);
    const double b = uniform(random);
    const double c = uniform(random);
    std::vector<Moment> moments;
    for (int i = 0; i < 60; ++i) {
        const double rest = i % (10 + static_cast<int>(seed % 5));
        moments.push_back({.trial = 1.0 + i, .since_break = rest, .value = a + b * i + c * rest});
    }
    CHECK(trend(moments).trial.value() == Approx(b).margin(1e-12));
    CHECK(trend(moments).since_break.value() == Approx(c).margin(1e-11));
    moments[5].since_break = std::nullopt;
    CHECK_FALSE(trend(moments).since_break);
    for (Moment& one : moments) {  // one stretch without a break
        one.since_break = one.trial - 1.0;
        one.value = b * one.trial;
    }
    CHECK_FALSE(trend(moments).since_break);
    CHECK(trend(moments).trial.value() == Approx(b).margin(1e-12));
    CHECK_FALSE(trend(std::vector<Moment>(moments.begin(), moments.begin() + 2)).trial);
    CHECK_FALSE(trend({}).trial);
}

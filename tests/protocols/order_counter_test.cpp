#include "protocols/design/plan_summary.hpp"
#include "protocols/order/order_counter.hpp"
#include "protocols/order/order_sampler.hpp"
#include "tests/protocols/orders.hpp"
#include "tests/support/random.hpp"

using namespace palpate::protocols;

namespace {

/// Up to 8 trials of up to 3 objects and 3 frictions, conditions as they come: unequal counts,
/// holes.
Order some_trials(Random& random) {
    const std::size_t objects = 1 + random.index(3);
    const std::size_t frictions = 1 + random.index(3);
    Order trials;
    for (int left = 1 + random.below(8); left > 0; --left) {
        trials.push_back({random.index(objects), random.index(frictions)});
    }
    return trials;
}

Natural number(std::size_t n) {
    return n;
}

}  // namespace

TEST_CASE("a share of whole numbers of any size is the quotient of what they are made of") {
    SEED(50U);
    Pcg32 random(seed, 3);
    const double part = random.next();
    const double whole = 1.0 + random.next();
    Natural a = static_cast<std::uint64_t>(part);
    Natural b = static_cast<std::uint64_t>(whole);
    for (std::uint32_t words = random.bounded(60); words > 0; --words) {
        a *= 0xFFFFFFFBU;
        b *= 0xFFFFFFFBU;
    }
    CHECK(share_of(a, b) == Approx(part / whole).epsilon(1e-15));
    CHECK(bits_of(Natural(1) << seed) == seed + 1);
    for (int i = 0; i < 20; ++i) {
        const Natural drawn = draw_below(b, random);
        CHECK((drawn >= 0 && drawn < b));
    }
}

TEST_CASE("the counter finds as many orders as there are, for both limits at once") {
    SEEDED(random, std::uint64_t{300});
    const Order trials = some_trials(random);
    const RunLimits limits{.object = random.index(4), .friction = random.index(4)};
    CAPTURE(trials.size(), limits.object, limits.friction);
    const auto orders = admissible(trials, limits);
    const auto counter = OrderCounter::build(trials, limits, 1'000'000);
    REQUIRE(counter);
    CHECK(counter->total() == number(orders.size()));

    const auto objects = counts_of(trials, &Condition::object);
    if (limits.object > 0) {
        Order alone = trials;
        for (Condition& condition : alone) {
            condition.friction = 0;
        }
        CHECK(count_orders(objects, limits.object) ==
              number(admissible(alone, {.object = limits.object}).size()));
    }
    if (orders.empty()) {
        CHECK_THROWS_AS(OrderSampler(trials, limits).counter_of_both(), OrderError);
    }
}

TEST_CASE("two ways to count large designs agree to the last digit") {
    struct Case {
        std::vector<std::size_t> counts;
        std::size_t limit;
    };
    const auto [counts, limit] = GENERATE(values<Case>({{{50, 50}, 3},
                                                        {{50, 50}, 1},
                                                        {{10, 10, 10, 10, 10}, 1},
                                                        {{10, 10, 10, 10, 10}, 2},
                                                        {{30, 20, 7}, 4},
                                                        {{9, 8, 7, 6}, 2}}));
    Order trials;
    for (std::size_t level = 0; level < counts.size(); ++level) {
        trials.insert(trials.end(), counts[level], Condition{level, 0});
    }
    const auto counter = OrderCounter::build(trials, {.object = limit}, 100'000);
    REQUIRE(counter);
    CHECK(counter->total() == count_orders(counts, limit));
    CHECK_FALSE(OrderCounter::build(trials, {.object = limit}, counter->states() - 1));
}

// Every way, also where the sampler itself would not take it, against the list of all orders.
TEST_CASE("every way of drawing is uniform over all admissible orders") {
    struct Case {
        Order trials;
        RunLimits limits;
    };
    const auto [trials, limits] = GENERATE(values<Case>({
        {factorial_of(2, 2, 2), {.object = 2, .friction = 2}},
        {factorial_of(3, 2, 1), {.object = 1, .friction = 2}},
        {{{0, 0}, {0, 0}, {0, 0}, {0, 1}, {1, 1}, {1, 1}, {2, 0}}, {.object = 2, .friction = 2}},
        {{{0, 0}, {0, 1}, {0, 2}, {1, 0}, {1, 0}, {2, 1}, {2, 2}}, {.object = 1, .friction = 1}},
    }));
    const OrderWay way = GENERATE(OrderWay::shuffles, OrderWay::friction_counted,
                                  OrderWay::object_counted, OrderWay::together, OrderWay::apart);
    const auto orders = admissible(trials, limits);
    CAPTURE(orders.size(), to_string(way));
    OrderSampler sampler(trials, limits);
    REQUIRE(sampler.counter_of(&Condition::object) != nullptr);
    REQUIRE(sampler.counter_of(&Condition::friction) != nullptr);
    REQUIRE(sampler.counter_of_both() != nullptr);
    Pcg32 random(77, static_cast<std::uint64_t>(way));
    const double excess = excess_of_chi_square(orders, 60 * orders.size(), [&] {
        for (;;) {
            if (auto order = sampler.propose(way, random)) {
                return *order;
            }
        }
    });
    CHECK(std::fabs(excess) < 4.0);
}

// experiment.md names the shares 4.9e-5, .268 and .829 for five shapes ten times each.
TEST_CASE("the acceptance of whole shuffles is the published one") {
    const Order trials = factorial_of(5, 1, 10);
    CHECK(acceptance_of(trials, {.object = 1}).share == Approx(4.9e-5).epsilon(0.01));
    CHECK(acceptance_of(trials, {.object = 2}).share == Approx(0.268).epsilon(0.002));
    CHECK(acceptance_of(trials, {.object = 3}).share == Approx(0.829).epsilon(0.002));
    CHECK(acceptance_of(trials, {.object = 3}).exact);
    CHECK(acceptance_of(trials, {}).share == 1.0);
}

TEST_CASE("the acceptance is the number of admissible orders over the number of all") {
    SEEDED(random, std::uint64_t{60});
    const Order trials = some_trials(random);
    const RunLimits limits{.object = random.index(4), .friction = random.index(4)};
    const auto kept = static_cast<double>(admissible(trials, limits).size());
    if (kept == 0.0) {
        CHECK_THROWS_AS(acceptance_of(trials, limits), OrderError);
        return;
    }
    const Acceptance acceptance = acceptance_of(trials, limits);
    CHECK(acceptance.exact);
    CHECK(acceptance.share ==
          Approx(kept / static_cast<double>(admissible(trials, {}).size())).epsilon(1e-12));
}

// By two ways that leave different things to chance, and by 1.9e-5 of 10^7 shuffles counted
// earlier.
TEST_CASE("the default study's acceptance is estimated alike by counting and by shuffling") {
    const Acceptance acceptance =
        acceptance_of(factorial_of(5, 2, 10), {.object = 2, .friction = 3});
    CHECK_FALSE(acceptance.exact);
    CHECK(acceptance.error < 0.02);
    CHECK(acceptance.share == Approx(1.95e-5).epsilon(0.08));
}

TEST_CASE("limits that hardly any shuffle keeps are kept") {
    struct Case {
        Order trials;
        RunLimits limits;
    };
    // Acceptances from 1e-11 to 6e-39.
    const auto [trials, limits] = GENERATE(values<Case>({
        {factorial_of(5, 2, 10), {.object = 2, .friction = 2}},
        {factorial_of(5, 2, 10), {.object = 2, .friction = 1}},
        {factorial_of(3, 2, 10), {.object = 1, .friction = 2}},
        {factorial_of(2, 2, 10), {.object = 1, .friction = 2}},
        {factorial_of(2, 1, 40), {.object = 1}},
        {factorial_of(1, 2, 100), {.friction = 1}},
    }));
    CAPTURE(trials.size(), limits.object, limits.friction);
    Pcg32 random(3, 4);
    Order drawn = OrderSampler(trials, limits).draw(random).order;
    CHECK(within_limits(drawn, limits));
    std::sort(drawn.begin(), drawn.end());
    CHECK(drawn == trials);
}

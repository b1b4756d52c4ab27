#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "protocols/design/constrained_order.hpp"
#include "tests/support/catch.hpp"

using namespace palpate::protocols;

namespace {

using Order = std::vector<Condition>;

Order factorial_of(std::size_t objects, std::size_t frictions, std::size_t repetitions) {
    Order trials;
    for (std::size_t object = 0; object < objects; ++object) {
        for (std::size_t friction = 0; friction < frictions; ++friction) {
            trials.insert(trials.end(), repetitions, Condition{object, friction});
        }
    }
    return trials;
}

std::size_t longest_run(const Order& order, std::size_t Condition::*factor) {
    std::size_t longest = 0;
    std::size_t run = 0;
    for (std::size_t i = 0; i < order.size(); ++i) {
        run = i > 0 && order[i].*factor == order[i - 1].*factor ? run + 1 : 1;
        longest = std::max(longest, run);
    }
    return longest;
}

/// Every admissible order, by going through all permutations of the multiset.
std::map<Order, std::size_t> admissible(Order trials, const RunLimits& limits) {
    std::map<Order, std::size_t> orders;
    std::sort(trials.begin(), trials.end());
    do {
        if ((limits.object == 0 || longest_run(trials, &Condition::object) <= limits.object) &&
            (limits.friction == 0 ||
             longest_run(trials, &Condition::friction) <= limits.friction)) {
            orders.emplace(trials, 0);
        }
    } while (std::next_permutation(trials.begin(), trials.end()));
    return orders;
}

/// Pearson's chi-square against equal shares, as standard deviations from its mean k - 1.
template <class Draw>
double excess_of_chi_square(std::map<Order, std::size_t> counts,
                            std::size_t draws,
                            const Draw& draw) {
    for (std::size_t i = 0; i < draws; ++i) {
        const auto cell = counts.find(draw());
        REQUIRE(cell != counts.end());
        ++cell->second;
    }
    const double expected = static_cast<double>(draws) / static_cast<double>(counts.size());
    double chi_square = 0.0;
    for (const auto& [order, count] : counts) {
        const double off = static_cast<double>(count) - expected;
        chi_square += off * off / expected;
    }
    const double freedom = static_cast<double>(counts.size()) - 1.0;
    return (chi_square - freedom) / std::sqrt(2.0 * freedom);
}

/// What not to do: shuffle once, then swap offending trials away until the limits hold.
Order repaired(Order order, const RunLimits& limits, Pcg32& random) {
    shuffle(std::span(order), random);
    for (std::size_t i = 1; !within_limits(order, limits); i = i % (order.size() - 1) + 1) {
        if (!within_limits(std::span(order).first(i + 1), limits)) {
            std::swap(order[i], order[random.bounded(static_cast<std::uint32_t>(order.size()))]);
        }
    }
    return order;
}

}  // namespace

TEST_CASE("every order has each trial exactly once and keeps the run limits", "[order][law]") {
    const auto seed = GENERATE(range(std::uint64_t{0}, std::uint64_t{200}));
    CAPTURE(seed);
    Pcg32 random(seed, 5);
    const Order trials = factorial_of(5, 2, 10);
    const ConstrainedOrder drawn = constrained_order(trials, {.object = 2, .friction = 3}, random);

    CHECK(longest_run(drawn.order, &Condition::object) <= 2);
    CHECK(longest_run(drawn.order, &Condition::friction) <= 3);
    Order sorted = drawn.order;
    std::sort(sorted.begin(), sorted.end());
    CHECK(sorted == trials);
    CHECK(drawn.acceptance == 1.0 / static_cast<double>(drawn.attempts));
}

TEST_CASE("all admissible orders are equally likely", "[order][law]") {
    struct Case {
        Order trials;
        RunLimits limits;
    };
    const auto [trials, limits] = GENERATE(values<Case>({
        {factorial_of(2, 2, 2), {.object = 2, .friction = 2}},
        {factorial_of(2, 2, 2), {.object = 1, .friction = 3}},
        {factorial_of(3, 1, 3), {.object = 1, .friction = 0}},
        {factorial_of(3, 2, 1), {.object = 1, .friction = 2}},
    }));
    const auto orders = admissible(trials, limits);
    CAPTURE(orders.size());
    Pcg32 random(2024, 1);
    const double excess = excess_of_chi_square(orders, 100 * orders.size(), [&] {
        return constrained_order(trials, limits, random).order;
    });
    CHECK(std::fabs(excess) < 4.0);
}

TEST_CASE("repair by swaps fails the same test", "[order]") {
    const Order trials = factorial_of(2, 2, 2);
    const RunLimits limits{.object = 2, .friction = 2};
    const auto orders = admissible(trials, limits);
    Pcg32 random(2024, 1);
    const double excess = excess_of_chi_square(orders, 100 * orders.size(),
                                               [&] { return repaired(trials, limits, random); });
    CHECK(excess > 50.0);
}

// Exact shares by counting: .268 for runs of at most 2, .829 for at most 3 (five levels ten times).
TEST_CASE("the acceptance agrees with the exact count", "[order]") {
    struct Case {
        std::size_t limit;
        double exact;
    };
    const auto [limit, exact] = GENERATE(values<Case>({{2, 0.268}, {3, 0.829}}));
    Pcg32 random(31, 7);
    constexpr int kOrders = 5000;
    double attempts = 0.0;
    for (int i = 0; i < kOrders; ++i) {
        attempts += static_cast<double>(
            constrained_order(factorial_of(5, 1, 10), {.object = limit, .friction = 0}, random)
                .attempts);
    }
    const double share = kOrders / attempts;
    const double deviation = exact * std::sqrt((1.0 - exact) / kOrders);
    CHECK(std::fabs(share - exact) < 4.0 * deviation + 0.0005);
}

TEST_CASE("the cheap test refuses exactly what one factor cannot keep", "[order][law]") {
    for (std::size_t first = 0; first <= 5; ++first) {
        for (std::size_t second = 0; second <= 4; ++second) {
            for (std::size_t limit = 1; limit <= 4; ++limit) {
                Order trials(first, Condition{0, 0});
                trials.insert(trials.end(), second, Condition{1, 0});
                CAPTURE(first, second, limit);
                const RunLimits limits{.object = limit, .friction = 0};
                CHECK(why_infeasible(trials, limits).has_value() ==
                      admissible(trials, limits).empty());
            }
        }
    }
}

TEST_CASE("limits that cannot be kept are refused with a reason", "[order]") {
    Pcg32 random(1, 1);
    CHECK_THROWS_WITH(
        constrained_order(factorial_of(1, 1, 3), {.object = 2, .friction = 0}, random),
        Catch::Matchers::ContainsSubstring("object 1 occurs 3 times") &&
            Catch::Matchers::ContainsSubstring("allow runs of 3"));
    CHECK_THROWS_WITH(
        constrained_order(factorial_of(2, 2, 5), {.object = 1, .friction = 1}, random),
        Catch::Matchers::ContainsSubstring("alternate"));
    // Two objects forty times each: only 2 of 1.1e23 orders alternate.
    Order hopeless = factorial_of(2, 1, 40);
    CHECK_THROWS_WITH(constrained_order(hopeless, {.object = 1, .friction = 0}, random),
                      Catch::Matchers::ContainsSubstring("none of 2000000 shuffles of 80 trials") &&
                          Catch::Matchers::ContainsSubstring("allow longer runs"));
}

TEST_CASE("no limits: the first shuffle is taken", "[order]") {
    Pcg32 random(9, 9);
    CHECK(constrained_order(factorial_of(1, 1, 30), {}, random).attempts == 1);
    CHECK(constrained_order({}, {.object = 1, .friction = 1}, random).order.empty());
}

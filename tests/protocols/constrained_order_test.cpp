#include "protocols/order/order_sampler.hpp"
#include "tests/protocols/orders.hpp"

using namespace palpate::protocols;

namespace {

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
    SEED(std::uint64_t{200});
    Pcg32 random(seed, 5);
    const Order trials = factorial_of(5, 2, 10);
    const ConstrainedOrder drawn = OrderSampler(trials, {.object = 2, .friction = 3}).draw(random);

    CHECK(longest_run(drawn.order, &Condition::object) <= 2);
    CHECK(longest_run(drawn.order, &Condition::friction) <= 3);
    Order sorted = drawn.order;
    std::sort(sorted.begin(), sorted.end());
    CHECK(sorted == trials);
    CHECK(drawn.attempts >= 1);
}

// What tells uniform orders of every way of drawing (order_counter_test.cpp) is able to fail.
TEST_CASE("repair by swaps is not uniform over all admissible orders", "[order]") {
    const Order trials = factorial_of(2, 2, 2);
    const RunLimits limits{.object = 2, .friction = 2};
    const auto orders = admissible(trials, limits);
    Pcg32 random(2024, 1);
    const double excess = excess_of_chi_square(orders, 100 * orders.size(),
                                               [&] { return repaired(trials, limits, random); });
    CHECK(excess > 50.0);
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
        OrderSampler(factorial_of(1, 1, 3), {.object = 2, .friction = 0}).draw(random),
        Has("object 1 occurs 3 times", "allow runs of 3"));
    CHECK_THROWS_WITH(
        OrderSampler(factorial_of(2, 2, 5), {.object = 1, .friction = 1}).draw(random),
        Has("alternate"));
    // Each limit can be kept alone: the frictions alternate, and the objects come in whole.
    Order unlike = factorial_of(2, 2, 1);
    unlike.push_back({0, 0});
    unlike.push_back({0, 1});
    CHECK_THROWS_WITH(OrderSampler(unlike, {.object = 1, .friction = 2}).draw(random),
                      Has("allow runs"));
}

TEST_CASE("no limits: the first shuffle is taken", "[order]") {
    Pcg32 random(9, 9);
    CHECK(OrderSampler(factorial_of(1, 1, 30), {}).draw(random).attempts == 1);
    CHECK(OrderSampler({}, {.object = 1, .friction = 1}).draw(random).order.empty());
}

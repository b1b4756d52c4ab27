#include "protocols/design/acceptance.hpp"

#include <cmath>

#include "protocols/order/order_count.hpp"
#include "protocols/order/order_counter.hpp"
#include "protocols/order/order_sampler.hpp"

namespace palpate::protocols {
namespace {

/// Of the proposals of one way, how many keep the limits; and what that makes of all shuffles.
Acceptance estimate(OrderSampler& sampler, std::span<const Condition> trials) {
    constexpr std::uint64_t kProposals = 100'000;
    const OrderWay way = sampler.first_way();
    const auto counted = [&](std::size_t Condition::*factor) {
        return share_of(sampler.counter_of(factor)->total(),
                        multinomial(counts_of(trials, factor)));
    };
    double known = 1.0;
    if (way == OrderWay::friction_counted || way == OrderWay::apart) {
        known *= counted(&Condition::friction);
    }
    if (way == OrderWay::object_counted || way == OrderWay::apart) {
        known *= counted(&Condition::object);
    }
    if (way == OrderWay::apart) {  // its pairs have any table of conditions, shuffles the right one
        const Natural pairs = multinomial(counts_of(trials, &Condition::object)) *
                              multinomial(counts_of(trials, &Condition::friction));
        known /= share_of(orders_of(trials), pairs);
    }
    Pcg32 random(0, 0);
    std::uint64_t kept = 0;
    for (std::uint64_t i = 0; i < kProposals; ++i) {
        kept += sampler.propose(way, random) ? 1U : 0U;
    }
    const double share = static_cast<double>(kept) / static_cast<double>(kProposals);
    return {.share = known * share,
            .exact = kept == kProposals,
            .error = kept > 0 ? std::sqrt((1.0 - share) / static_cast<double>(kept)) : 1.0,
            .draws = kProposals};
}

}  // namespace

std::optional<double> acceptance_of_one(std::span<const Condition> trials,
                                        std::size_t Condition::*factor,
                                        std::size_t limit) {
    const auto counts = counts_of(trials, factor);
    if (!binds(counts, limit)) {
        return 1.0;
    }
    if (trials.size() > kMaxCounted) {
        return std::nullopt;
    }
    return share_of(count_orders(counts, limit), multinomial(counts));
}

Acceptance acceptance_of(std::span<const Condition> trials, const RunLimits& limits) {
    OrderSampler sampler({trials.begin(), trials.end()}, limits);
    const auto object = acceptance_of_one(trials, &Condition::object, limits.object);
    const auto friction = acceptance_of_one(trials, &Condition::friction, limits.friction);
    if (object && friction && (*object == 1.0 || *friction == 1.0)) {
        return {.share = *object * *friction};
    }
    if (sampler.first_way() == OrderWay::together) {
        return {.share = share_of(sampler.counter_of_both()->total(), orders_of(trials))};
    }
    return estimate(sampler, trials);
}

}  // namespace palpate::protocols

#include "protocols/order/order_sampler.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "protocols/order/order_counter.hpp"
#include "protocols/protocol/condition.hpp"

namespace palpate::protocols {
namespace {

using Level = std::size_t Condition::*;

Level other(Level factor) {
    return factor == &Condition::object ? &Condition::friction : &Condition::object;
}

std::size_t limit_of(const RunLimits& limits, Level factor) {
    return factor == &Condition::object ? limits.object : limits.friction;
}

std::string text_of(const RunLimits& limits) {
    return fmt::format("{} {}, {} {}", limits.words[0], limits.object, limits.words[1],
                       limits.friction);
}

/// Bits of one over the share of pairs that have the asked table, object and friction each in any
/// order.
std::size_t rarity_of_table(std::span<const Condition> trials) {
    return bits_of(multinomial(counts_of(trials, &Condition::object))) +
           bits_of(multinomial(counts_of(trials, &Condition::friction))) -
           bits_of(orders_of(trials));
}

std::shared_ptr<const OrderCounter> counter_or_none(std::optional<OrderCounter> built) {
    return built ? std::make_shared<const OrderCounter>(*std::move(built)) : nullptr;
}

/// No fewer than the states of a counter of both factors.
double max_places(std::span<const Condition> trials, const RunLimits& limits) {
    std::map<std::size_t, double> rows;  // how many remainders the row of an object can have
    for (const auto& [condition, count] : cells_of(trials)) {
        double& row = rows.try_emplace(condition.object, 1.0).first->second;
        row *= static_cast<double>(count) + 1.0;
    }
    double max = 0.0;
    for (const auto& [object, row] : rows) {
        max = std::max(max, row);
    }
    double heaps = 1.0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        heaps *= (max + static_cast<double>(i)) / (static_cast<double>(i) + 1.0);
    }
    const auto frictions = static_cast<double>(counts_of(trials, &Condition::friction).size());
    return heaps * static_cast<double>(rows.size()) * frictions *
           static_cast<double>(limits.object * limits.friction);
}

/// Whether counting a factor is hopeless, before a second is lost on it. With runs of 2 an order
/// gets to a good part of all remainders (limit 1 is another matter); an eighth of them is too many
/// already.
bool too_many_states(const std::vector<std::size_t>& counts, std::size_t limit, std::size_t max) {
    if (counts.empty()) {
        return false;
    }
    const auto least = static_cast<double>(*std::ranges::min_element(counts));
    double heaps = 1.0;
    for (std::size_t i = 1; i <= counts.size(); ++i) {
        heaps *= (least + static_cast<double>(i)) / static_cast<double>(i);
    }
    return limit >= 2 && heaps > 8.0 * static_cast<double>(max);
}

}  // namespace

OrderSampler::OrderSampler(std::vector<Condition> trials, const RunLimits& limits)
    : trials_(std::move(trials)), limits_(limits) {
    if (const auto why = why_infeasible(trials_, limits)) {
        throw OrderError(
            fmt::format("no order keeps the run limits ({}): {}", text_of(limits), why->reason));
    }
    ways_ = by_rarity();
}

std::vector<OrderWay> OrderSampler::by_rarity() const {
    using enum OrderWay;
    const auto objects = counts_of(trials_, &Condition::object);
    const auto frictions = counts_of(trials_, &Condition::friction);
    const std::size_t object = rarity_of(objects, limits_.object);
    const std::size_t friction = rarity_of(frictions, limits_.friction);
    if (!binds(objects, limits_.object) || !binds(frictions, limits_.friction)) {
        constexpr std::size_t kOften = 10;
        const OrderWay counted = object > 0 ? object_counted : friction_counted;
        return object + friction <= kOften ? std::vector{shuffles} : std::vector{counted, shuffles};
    }
    if (max_places(trials_, limits_) <= static_cast<double>(max_states(trials_.size()))) {
        return {together};
    }
    // What is left to chance: the limit of the factor that is dealt, or the table.
    std::vector<std::pair<std::size_t, OrderWay>> chances = {
        {object, friction_counted}, {friction, object_counted}, {rarity_of_table(trials_), apart}};
    std::ranges::sort(chances);
    std::vector<OrderWay> ways;
    for (const auto& [rarity, way] : chances) {
        constexpr std::size_t kHopeless = 32;
        if (rarity <= kHopeless) {
            ways.push_back(way);
        }
    }
    ways.push_back(shuffles);
    return ways;
}

std::size_t OrderSampler::max_states(std::size_t trials) noexcept {
    constexpr std::size_t kMax = 400'000;
    constexpr std::size_t kBytes = 64'000'000;
    return std::min(kMax, kBytes / (100 + trials / 2));
}

const OrderCounter* OrderSampler::counter_of(Level factor) {
    Lazy& lazy = factor == &Condition::object ? object_ : friction_;
    const std::size_t max = max_states(trials_.size());
    if (!lazy && too_many_states(counts_of(trials_, factor), limit_of(limits_, factor), max)) {
        lazy = nullptr;
    } else if (!lazy) {
        std::vector<Condition> alone;
        for (const Condition& condition : trials_) {
            alone.push_back({.object = condition.*factor});
        }
        lazy =
            counter_or_none(OrderCounter::build(alone, {.object = limit_of(limits_, factor)}, max));
    }
    return lazy->get();
}

const OrderCounter* OrderSampler::counter_of_both() {
    if (!both_) {
        both_ = counter_or_none(OrderCounter::build(trials_, limits_, max_states(trials_.size())));
        refuse_if<OrderError>(
            *both_ && (*both_)->total().is_zero(),
            "no order keeps the run limits ({}) at once, though each alone can be "
            "kept: allow longer runs of one of them",
            text_of(limits_));
    }
    return both_->get();
}

bool OrderSampler::can(OrderWay way) {
    using enum OrderWay;
    const bool objects = way == object_counted || way == apart;
    const bool frictions = way == friction_counted || way == apart;
    return (!objects || counter_of(&Condition::object) != nullptr) &&
           (!frictions || counter_of(&Condition::friction) != nullptr) &&
           (way != together || counter_of_both() != nullptr);
}

OrderWay OrderSampler::first_way() {
    return *std::ranges::find_if(ways_, [&](OrderWay way) { return can(way); });
}

ConstrainedOrder OrderSampler::draw(Pcg32& random) {
    std::uint64_t attempts = 0;
    for (; way_ < ways_.size(); ++way_) {
        const OrderWay way = ways_[way_];
        dealt_ = 0;
        piles_.clear();
        while (can(way) && dealt_ <= kDeals) {
            ++attempts;
            if (Proposal order = propose(way, random)) {
                return {std::move(*order), attempts, way};
            }
        }
    }
    throw OrderError(fmt::format(
        "none of {} orders drawn of {} trials kept the run limits ({}): allow longer "
        "runs, 0 for no limit{}",
        attempts, trials_.size(), text_of(limits_),
        limits_.words == RunLimits{}.words ? ", or divide the trials into blocks" : ""));
}

OrderSampler::Proposal OrderSampler::propose(OrderWay way, Pcg32& random) {
    switch (way) {
        case OrderWay::shuffles:
            return deal_both(random);
        case OrderWay::friction_counted:
            return deal_beside(&Condition::friction, random);
        case OrderWay::object_counted:
            return deal_beside(&Condition::object, random);
        case OrderWay::together: {
            std::vector<Condition> order;
            for (OrderWalk walk(*counter_of_both()); !walk.done();) {
                order.push_back(walk.next(random));
            }
            return order;
        }
        case OrderWay::apart:
            return count_apart(random);
    }
    return std::nullopt;
}

/// shuffle(), but given up as soon as the trials that already have their place, the last ones,
/// break a limit: dealing on could not mend it. What is not given up is as uniform as whole
/// shuffles are.
OrderSampler::Proposal OrderSampler::deal_both(Pcg32& random) {
    std::vector<Condition>& trials = trials_;
    Run object(&Condition::object, limits_.object);
    Run friction(&Condition::friction, limits_.friction);
    for (std::size_t left = trials.size(); left > 0; --left) {
        ++dealt_;
        if (left > 1) {
            const std::size_t chosen = random.bounded(static_cast<std::uint32_t>(left));
            std::swap(trials[chosen], trials[left - 1]);
        }
        if (left < trials.size() && !(object.goes_on(trials[left], trials[left - 1]) &&
                                      friction.goes_on(trials[left], trials[left - 1]))) {
            return std::nullopt;
        }
    }
    return trials;
}

OrderSampler::Proposal OrderSampler::deal_beside(Level counted, Pcg32& random) {
    if (piles_.empty()) {
        for (const Condition& condition : trials_) {
            piles_[condition.*counted].trials.push_back(condition);
        }
    }
    for (auto& [level, pile] : piles_) {
        pile.left = pile.trials.size();
    }
    std::vector<Condition> order;
    Run run(other(counted), limit_of(limits_, other(counted)));
    for (OrderWalk walk(*counter_of(counted)); !walk.done();) {
        ++dealt_;
        auto& [trials, left] = piles_.at(walk.next(random).object);
        const std::size_t chosen = random.bounded(static_cast<std::uint32_t>(left));
        std::swap(trials[chosen], trials[--left]);
        if (!order.empty() && !run.goes_on(order.back(), trials[left])) {
            return std::nullopt;
        }
        order.push_back(trials[left]);
    }
    return order;
}

OrderSampler::Proposal OrderSampler::count_apart(Pcg32& random) {
    std::map<Condition, std::size_t> left = cells_of(trials_);
    std::vector<Condition> order;
    OrderWalk object(*counter_of(&Condition::object));
    OrderWalk friction(*counter_of(&Condition::friction));
    while (!object.done()) {
        ++dealt_;
        const std::size_t chosen = object.next(random).object;
        const Condition next{chosen, friction.next(random).object};
        const auto rest = left.find(next);
        if (rest == left.end() || rest->second == 0) {
            return std::nullopt;
        }
        --rest->second;
        order.push_back(next);
    }
    return order;
}

}  // namespace palpate::protocols

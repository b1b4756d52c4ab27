#include "protocols/design/constrained_order.hpp"

#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>

namespace palpate::protocols {
namespace {

using Level = std::size_t Condition::*;

/// Length of the run of one factor while trials come one after another.
class Run {
public:
    Run(Level factor, std::size_t limit) : factor_(factor), limit_(limit) {}

    /// Whether the limit still holds with `next` after `last`.
    bool goes_on(const Condition& last, const Condition& next) noexcept {
        length_ = last.*factor_ == next.*factor_ ? length_ + 1 : 1;
        return limit_ == 0 || length_ <= limit_;
    }

private:
    Level factor_;
    std::size_t limit_;
    std::size_t length_ = 1;  ///< of the first trial alone, which any limit allows
};

/// shuffle(), but given up as soon as the trials that already have their place, the last ones, break a
/// limit: dealing on could not mend it. What is not given up is as uniform as whole shuffles are.
bool deal(std::span<Condition> trials, const RunLimits& limits, Pcg32& random) noexcept {
    Run object(&Condition::object, limits.object);
    Run friction(&Condition::friction, limits.friction);
    for (std::size_t left = trials.size(); left > 0; --left) {
        if (left > 1) {
            const std::size_t chosen = random.bounded(static_cast<std::uint32_t>(left));
            std::swap(trials[chosen], trials[left - 1]);
        }
        if (left < trials.size() && !(object.goes_on(trials[left], trials[left - 1]) &&
                                      friction.goes_on(trials[left], trials[left - 1]))) {
            return false;
        }
    }
    return true;
}

std::map<std::size_t, std::size_t> counts_of(std::span<const Condition> trials, Level factor) {
    std::map<std::size_t, std::size_t> counts;
    for (const Condition& condition : trials) {
        ++counts[condition.*factor];
    }
    return counts;
}

std::optional<Infeasible> too_many_of_one_level(std::span<const Condition> trials,
                                                Level factor,
                                                std::size_t limit,
                                                Infeasible::Factor which) {
    if (limit == 0) {
        return std::nullopt;
    }
    for (const auto& [level, count] : counts_of(trials, factor)) {
        const std::size_t others = trials.size() - count;
        const std::size_t needed = (count + others) / (others + 1);  // ceil(count / (others + 1))
        if (needed > limit) {
            const char* name = which == Infeasible::Factor::object ? "object" : "friction";
            return Infeasible{which,
                              fmt::format("{} {} occurs {} times among {} other trials, so that it "
                                          "comes at least {} times in a row somewhere; allow runs "
                                          "of {} or more, or 0 for no limit",
                                          name, level + 1, count, others, needed, needed)};
        }
    }
    return std::nullopt;
}

}  // namespace

bool within_limits(std::span<const Condition> order, const RunLimits& limits) noexcept {
    Run object(&Condition::object, limits.object);
    Run friction(&Condition::friction, limits.friction);
    for (std::size_t i = 1; i < order.size(); ++i) {
        if (!(object.goes_on(order[i - 1], order[i]) && friction.goes_on(order[i - 1], order[i]))) {
            return false;
        }
    }
    return true;
}

std::optional<Infeasible> why_infeasible(std::span<const Condition> trials,
                                         const RunLimits& limits) {
    using enum Infeasible::Factor;
    if (auto why = too_many_of_one_level(trials, &Condition::object, limits.object, object)) {
        return why;
    }
    if (auto why = too_many_of_one_level(trials, &Condition::friction, limits.friction, friction)) {
        return why;
    }
    const bool both_alternate = limits.object == 1 && limits.friction == 1 &&
                                counts_of(trials, &Condition::object).size() == 2 &&
                                counts_of(trials, &Condition::friction).size() == 2;
    if (both_alternate && std::set<Condition>(trials.begin(), trials.end()).size() > 2) {
        return Infeasible{friction,
                          "object and friction would both alternate in every trial, so that an "
                          "object would always come with the same friction; allow runs of 2 of one "
                          "of them"};
    }
    return std::nullopt;
}

std::uint64_t most_attempts(std::size_t trials) noexcept {
    constexpr std::uint64_t kMost = 2'000'000;
    constexpr std::uint64_t kDraws = 200'000'000;  // about a second of PCG32
    return std::min(kMost, kDraws / std::max<std::uint64_t>(trials, 1) + 1);
}

ConstrainedOrder constrained_order(std::vector<Condition> trials,
                                   const RunLimits& limits,
                                   Pcg32& random) {
    if (const auto why = why_infeasible(trials, limits)) {
        throw OrderError(fmt::format("no order keeps the run limits (object {}, friction {}): {}",
                                     limits.object, limits.friction, why->reason));
    }
    const std::uint64_t most = most_attempts(trials.size());
    for (std::uint64_t attempts = 1; attempts <= most; ++attempts) {
        if (deal(trials, limits, random)) {
            return {std::move(trials), attempts, 1.0 / static_cast<double>(attempts)};
        }
    }
    throw OrderError(
        fmt::format("none of {} shuffles of {} trials kept the run limits (object {}, friction "
                    "{}): allow longer runs, or 0 for no limit",
                    most, trials.size(), limits.object, limits.friction));
}

}  // namespace palpate::protocols

#include "protocols/order/constrained_order.hpp"

#include <array>
#include <set>

#include <fmt/format.h>

#include "engine/base/text.hpp"

namespace palpate::protocols {
namespace {

using Level = std::size_t Condition::*;

std::optional<Infeasible> too_many_of_one_level(std::span<const Condition> trials,
                                                const RunLimits& limits,
                                                Infeasible::Factor which) {
    const bool of_object = which == Infeasible::Factor::object;
    const std::size_t limit = of_object ? limits.object : limits.friction;
    const Level factor = of_object ? &Condition::object : &Condition::friction;
    for (const auto& [level, count] : occurrences(trials, factor)) {
        const std::size_t others = trials.size() - count;
        const std::size_t needed = (count + others) / (others + 1);  // ceil(count / (others + 1))
        if (limit > 0 && needed > limit) {
            return Infeasible{
                which,
                fmt::format("{} {} occurs {} among {}, so that it comes at least {} in a row "
                            "somewhere; allow runs of {} or more, or 0 for no limit",
                            limits.words[of_object ? 0 : 1], level + 1, counted(count, "time"),
                            counted(others, "other trial"), counted(needed, "time"), needed)};
        }
    }
    return std::nullopt;
}

}  // namespace

std::map<std::size_t, std::size_t> occurrences(std::span<const Condition> trials,
                                               std::size_t Condition::*factor) {
    std::map<std::size_t, std::size_t> counts;
    for (const Condition& condition : trials) {
        ++counts[condition.*factor];
    }
    return counts;
}

std::optional<Infeasible> why_infeasible(std::span<const Condition> trials,
                                         const RunLimits& limits) {
    using enum Infeasible::Factor;
    for (const Infeasible::Factor factor : {object, friction}) {
        if (auto why = too_many_of_one_level(trials, limits, factor)) {
            return why;
        }
    }
    const bool both_alternate = limits.object == 1 && limits.friction == 1 &&
                                occurrences(trials, &Condition::object).size() == 2 &&
                                occurrences(trials, &Condition::friction).size() == 2;
    if (both_alternate && std::set<Condition>(trials.begin(), trials.end()).size() > 2) {
        return Infeasible{
            friction,
            fmt::format("{0} and {1} would both alternate in every trial, so that one {0} would "
                        "always come with the same {1}; allow runs of 2 of one of them",
                        limits.words[0], limits.words[1])};
    }
    return std::nullopt;
}

std::string_view to_string(OrderWay way) noexcept {
    constexpr std::array<std::string_view, 5> kWords{
        "whole shuffles", "frictions counted, objects dealt", "objects counted, frictions dealt",
        "counted", "objects and frictions counted apart"};
    return kWords[static_cast<std::size_t>(way)];
}

}  // namespace palpate::protocols

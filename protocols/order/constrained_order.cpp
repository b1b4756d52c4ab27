#include "protocols/order/constrained_order.hpp"

#include <array>
#include <map>
#include <set>

#include <fmt/format.h>

#include "engine/base/text.hpp"

namespace palpate::protocols {
namespace {

using Level = std::size_t Condition::*;

std::map<std::size_t, std::size_t> occurrences(std::span<const Condition> trials, Level factor) {
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
    for (const auto& [level, count] : occurrences(trials, factor)) {
        const std::size_t others = trials.size() - count;
        const std::size_t needed = (count + others) / (others + 1);  // ceil(count / (others + 1))
        if (needed > limit) {
            const char* name = which == Infeasible::Factor::object ? "object" : "friction";
            return Infeasible{
                which,
                fmt::format("{} {} occurs {} among {}, so that it comes at least {} in a row "
                            "somewhere; allow runs of {} or more, or 0 for no limit",
                            name, level + 1, counted(count, "time"), counted(others, "other trial"),
                            counted(needed, "time"), needed)};
        }
    }
    return std::nullopt;
}

}  // namespace

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
                                occurrences(trials, &Condition::object).size() == 2 &&
                                occurrences(trials, &Condition::friction).size() == 2;
    if (both_alternate && std::set<Condition>(trials.begin(), trials.end()).size() > 2) {
        return Infeasible{
            friction,
            "object and friction would both alternate in every trial, so that an object would "
            "always come with the same friction; allow runs of 2 of one of them"};
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

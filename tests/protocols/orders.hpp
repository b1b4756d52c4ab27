#pragma once

#include "protocols/design/session_plan.hpp"
#include "protocols/order/constrained_order.hpp"
#include "tests/support/catch.hpp"

/// Small designs, gone through one order after the other.
namespace palpate::tests {

using protocols::Condition;
using protocols::RunLimits;
using Order = std::vector<Condition>;

inline Order factorial_of(std::size_t objects, std::size_t frictions, std::size_t repetitions) {
    Order trials;
    for (std::size_t object = 0; object < objects; ++object) {
        for (std::size_t friction = 0; friction < frictions; ++friction) {
            trials.insert(trials.end(), repetitions, Condition{object, friction});
        }
    }
    return trials;
}

/// A study of so many pictured objects, unpictured ones for catch trials, and frictions.
inline protocols::Protocol named_study(std::size_t objects,
                                       std::size_t frictions,
                                       const protocols::DesignSpec& design,
                                       std::size_t unpictured = 1) {
    protocols::Protocol protocol;
    for (std::size_t i = 0; i < objects; ++i) {
        protocol.objects.push_back({.name = fmt::format("object_{}", i)});
    }
    for (std::size_t i = 0; i < unpictured; ++i) {
        protocol.objects.push_back({.name = fmt::format("catch_{}", i), .pictured = false});
    }
    for (std::size_t i = 0; i < frictions; ++i) {
        protocol.frictions.push_back({.name = fmt::format("friction_{}", i)});
    }
    protocol.design = design;
    return protocol;
}

/// What the objects, or the frictions, of an order are called.
template <class Things>
std::vector<std::string> names_of(const Things& things, const std::vector<std::size_t>& order) {
    std::vector<std::string> names;
    for (const std::size_t i : order) {
        names.push_back(things[i].name);
    }
    return names;
}

inline std::size_t longest_run(const Order& order, std::size_t Condition::*factor) {
    std::size_t longest = 0;
    std::size_t run = 0;
    for (std::size_t i = 0; i < order.size(); ++i) {
        run = i > 0 && order[i].*factor == order[i - 1].*factor ? run + 1 : 1;
        longest = std::max(longest, run);
    }
    return longest;
}

/// Whether no level of a factor comes more often in a row than its limit; 0: none.
inline bool within_limits(std::span<const Condition> order, const RunLimits& limits) {
    const auto keeps = [&](std::size_t Condition::*factor, std::size_t limit) {
        return limit == 0 || longest_run({order.begin(), order.end()}, factor) <= limit;
    };
    return keeps(&Condition::object, limits.object) && keeps(&Condition::friction, limits.friction);
}

/// Every admissible order, by going through all permutations of the multiset.
inline std::map<Order, std::size_t> admissible(Order trials, const RunLimits& limits) {
    std::map<Order, std::size_t> orders;
    std::sort(trials.begin(), trials.end());
    do {
        if (within_limits(trials, limits)) {
            orders.emplace(trials, 0);
        }
    } while (std::next_permutation(trials.begin(), trials.end()));
    return orders;
}

/// Whether so many cells have a count, each of them `each`.
template <class Counts, class Number>
bool even(const Counts& counts, std::size_t cells, Number each) {
    return counts.size() == cells && std::ranges::all_of(counts, [each](const auto& one) {
               return std::cmp_equal(one.second, each);
           });
}

/// Pearson's chi-square against equal shares of so many cells, of which those without a count may
/// be left out.
template <class Counts>
double chi_square(const Counts& counts, std::size_t cells) {
    double all = 0.0;
    for (const auto& [cell, count] : counts) {
        all += static_cast<double>(count);
    }
    const double expected = all / static_cast<double>(cells);
    double sum = expected * static_cast<double>(cells - counts.size());
    for (const auto& [cell, count] : counts) {
        const double off = static_cast<double>(count) - expected;
        sum += off * off / expected;
    }
    return sum;
}

/// The same as standard deviations from its mean k - 1.
template <class Key, class Draw>
double excess_of_chi_square(std::map<Key, std::size_t> counts,
                            std::size_t draws,
                            const Draw& draw) {
    for (std::size_t i = 0; i < draws; ++i) {
        const auto cell = counts.find(draw());
        REQUIRE(cell != counts.end());
        ++cell->second;
    }
    const double freedom = static_cast<double>(counts.size()) - 1.0;
    return (chi_square(counts, counts.size()) - freedom) / std::sqrt(2.0 * freedom);
}

}  // namespace palpate::tests

#include "protocols/procedure/expected_entropy.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "protocols/psychometric/exact_math.hpp"

namespace palpate::protocols {
namespace {

constexpr double kTie = 1e-12;

/// sum a_i b_i in eight strands, each in order: one fixed result, and work for every unit of a
/// processor.
double dot(std::span<const double> a, std::span<const double> b) noexcept {
    constexpr std::size_t kStrands = 8;
    if (a.size() == 1) {
        return a[0] * b[0];
    }
    std::array<double, kStrands> strand{};
    const std::size_t whole = a.size() - a.size() % kStrands;
    for (std::size_t i = 0; i < whole; i += kStrands) {
        for (std::size_t k = 0; k < kStrands; ++k) {
            strand[k] += a[i + k] * b[i + k];
        }
    }
    for (std::size_t i = whole; i < a.size(); ++i) {
        strand[i - whole] += a[i] * b[i];
    }
    return ((strand[0] + strand[4]) + (strand[2] + strand[6])) +
           ((strand[1] + strand[5]) + (strand[3] + strand[7]));
}

}  // namespace

std::vector<double> expected_entropies(const LikelihoodTable& table,
                                       std::span<const double> weights) {
    const double now = entropy_of(weights);
    std::vector<double> expected(table.stimuli().size());
    for (std::size_t x = 0; x < expected.size(); ++x) {
        double predicted = 0.0;  // H(R|x)
        double rest = 1.0;
        for (std::size_t r = 0; r + 1 < table.outcomes(); ++r) {
            const double chance = dot(weights, table.chances(x, r));
            predicted -= p_log_p(chance);
            rest -= chance;
        }
        predicted -= p_log_p(rest);
        expected[x] = now - (predicted - dot(weights, table.outcome_entropy(x)));
    }
    return expected;
}

CellGroups groups_of(const Grid& parameters, std::span<const std::string> nuisance) {
    const auto is_nuisance = [nuisance](const Axis& axis) {
        return std::find(nuisance.begin(), nuisance.end(), axis.name) != nuisance.end();
    };
    for (const std::string& name : nuisance) {
        const auto axes = parameters.axes();
        if (std::none_of(axes.begin(), axes.end(),
                         [&name](const Axis& axis) { return axis.name == name; })) {
            throw std::invalid_argument(
                fmt::format("the nuisance {} is no parameter of the model: delete it", name));
        }
    }
    CellGroups groups{.of = std::vector<std::uint32_t>(parameters.size()), .count = 1};
    bool any = false;
    for (std::size_t k = 0; k < parameters.dimensions(); ++k) {
        const std::size_t size = parameters.axis(k).values.size();
        if (is_nuisance(parameters.axis(k))) {
            groups.run *= size;
            continue;
        }
        any = true;
        groups.run = 1;  // only nuisance axes behind the last wanted one make runs
        groups.count *= size;
        for (std::size_t cell = 0; cell < parameters.size(); ++cell) {
            groups.of[cell] =
                static_cast<std::uint32_t>(groups.of[cell] * size + parameters.index(cell, k));
        }
    }
    if (!any) {
        throw std::invalid_argument("every parameter is a nuisance: leave one out of the list");
    }
    return groups;
}

std::vector<double> expected_marginal_entropies(const LikelihoodTable& table,
                                                std::span<const double> weights,
                                                const CellGroups& groups) {
    std::vector<double> expected(table.stimuli().size());
    std::vector<double> joint(groups.count);  // P(r, group | x)
    for (std::size_t x = 0; x < expected.size(); ++x) {
        for (std::size_t r = 0; r < table.outcomes(); ++r) {
            std::fill(joint.begin(), joint.end(), 0.0);
            const std::span<const double> chances = table.chances(x, r);
            for (std::size_t c = 0; c < weights.size(); c += groups.run) {
                joint[groups.of[c]] +=
                    dot(weights.subspan(c, groups.run), chances.subspan(c, groups.run));
            }
            double sum = 0.0;
            for (const double p : joint) {
                sum += p;
                expected[x] -= p_log_p(p);
            }
            expected[x] += p_log_p(sum);
        }
    }
    return expected;
}

std::size_t first_of_least(std::span<const double> entropies) noexcept {
    const double least = *std::min_element(entropies.begin(), entropies.end());
    const double max = least + kTie * std::max(1.0, std::fabs(least));
    const auto first = std::find_if(entropies.begin(), entropies.end(),
                                    [max](double entropy) { return entropy <= max; });
    return static_cast<std::size_t>(first - entropies.begin());
}

}  // namespace palpate::protocols

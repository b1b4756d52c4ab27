#include "protocols/procedure/expected_entropy.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "protocols/psychometric/exact_math.hpp"

namespace palpate::protocols {
namespace {

constexpr double kTie = 1e-12;

/// sum a_i b_i in eight strands, each in order: one fixed result, and work for every unit of a
/// processor.
double dot(std::span<const double> a, std::span<const double> b) noexcept {
    constexpr std::size_t kStrands = 8;
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
    double now = 0.0;
    for (const double w : weights) {
        now -= p_log_p(w);
    }
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

std::vector<double> expected_marginal_entropies(const LikelihoodTable& table,
                                                std::span<const double> weights,
                                                std::span<const std::uint32_t> group,
                                                std::size_t groups) {
    std::vector<double> expected(table.stimuli().size());
    std::vector<double> joint(groups);  // P(r, group | x)
    for (std::size_t x = 0; x < expected.size(); ++x) {
        for (std::size_t r = 0; r < table.outcomes(); ++r) {
            std::fill(joint.begin(), joint.end(), 0.0);
            const std::span<const double> chances = table.chances(x, r);
            for (std::size_t c = 0; c < weights.size(); ++c) {
                joint[group[c]] += weights[c] * chances[c];
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
    const double most = least + kTie * std::max(1.0, std::fabs(least));
    const auto first = std::find_if(entropies.begin(), entropies.end(),
                                    [most](double entropy) { return entropy <= most; });
    return static_cast<std::size_t>(first - entropies.begin());
}

}  // namespace palpate::protocols

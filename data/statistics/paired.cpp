#include "data/statistics/paired.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "protocols/psychometric/exact_math.hpp"
#include "data/statistics/distributions.hpp"
#include "data/statistics/over_people.hpp"

namespace palpate::data {
namespace {

constexpr std::size_t kMaxRanked = 300;  ///< 90,000 sums

/// Twice the mean rank of each size, so that ties are whole numbers too; in the order of `sizes`.
std::vector<std::size_t> doubled_ranks(const std::vector<double>& sizes) {
    std::vector<std::size_t> order(sizes.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, {}, [&](std::size_t i) { return sizes[i]; });
    const double slack = sizes.empty() ? 0.0 : 1e-9 * sizes[order.back()];
    std::vector<std::size_t> ranks(sizes.size());
    for (std::size_t first = 0; first < order.size();) {
        std::size_t end = first + 1;
        while (end < order.size() && sizes[order[end]] - sizes[order[end - 1]] <= slack) {
            ++end;
        }
        for (std::size_t i = first; i < end; ++i) {
            ranks[order[i]] = first + 1 + end;
        }
        first = end;
    }
    return ranks;
}

/// The share of patterns of signs whose sum lies as far from the middle as `sum`.
double share_as_far(const std::vector<std::size_t>& ranks, std::size_t sum, std::size_t all) {
    std::vector<double> chance(all + 1);
    chance[0] = 1.0;
    std::size_t reached = 0;
    for (const std::size_t rank : ranks) {
        reached += rank;
        for (std::size_t s = reached + 1; s-- > 0;) {
            chance[s] = 0.5 * (chance[s] + (s >= rank ? chance[s - rank] : 0.0));
        }
    }
    const std::size_t lower = std::min(sum, all - sum);
    double p = 0.0;
    for (std::size_t s = 0; s <= all; ++s) {
        p += std::min(s, all - s) <= lower ? chance[s] : 0.0;
    }
    return std::min(p, 1.0);
}

}  // namespace

std::optional<PairedT> paired_t(std::span<const double> differences) {
    if (differences.empty()) {
        return std::nullopt;
    }
    const PeopleMean mean = mean_over_people(differences);
    if (!mean.interval) {
        return std::nullopt;
    }
    double squares = 0.0;
    for (const double one : differences) {
        squares += (one - mean.mean) * (one - mean.mean);
    }
    const auto n = static_cast<double>(differences.size());
    PairedT made{.mean = mean.mean, .sd = std::sqrt(squares / (n - 1.0)), .df = n - 1.0};
    made.t = made.mean / (made.sd / std::sqrt(n));
    made.p = t_two_sided(made.t, made.df);
    made.interval = *mean.interval;
    made.dz = made.mean / made.sd;
    return made;
}

SignedRank signed_rank(std::span<const double> differences) {
    double largest = 0.0;
    for (const double one : differences) {
        largest = std::max(largest, std::fabs(one));
    }
    std::vector<double> sizes;
    std::vector<bool> above;
    for (const double one : differences) {
        if (std::fabs(one) > 1e-9 * largest) {
            sizes.push_back(std::fabs(one));
            above.push_back(one > 0.0);
        }
    }
    const std::vector<std::size_t> ranks = doubled_ranks(sizes);
    std::size_t sum = 0;
    std::size_t all = 0;
    double squares = 0.0;
    for (std::size_t i = 0; i < ranks.size(); ++i) {
        sum += above[i] ? ranks[i] : 0;
        all += ranks[i];
        squares += 0.25 * static_cast<double>(ranks[i]) * static_cast<double>(ranks[i]);
    }
    SignedRank made{.v = 0.5 * static_cast<double>(sum),
                    .ranked = ranks.size(),
                    .exact = ranks.size() <= kMaxRanked};
    if (ranks.empty()) {
        return made;
    }
    const double far = std::fabs(made.v - 0.25 * static_cast<double>(all));
    made.p = made.exact ? share_as_far(ranks, sum, all)
                        : 2.0 * protocols::normal_cdf(-far / std::sqrt(0.25 * squares));
    return made;
}

double jzs_bayes_factor(double t, std::size_t n, double r) {
    constexpr double kStep = 0.02;
    constexpr double kInverseSqrtTwoPi = 0.398942280401432677939946059934381868;
    const auto people = static_cast<double>(n);
    const double df = people - 1.0;
    const double none = std::log1p(t * t / df);
    double sum = 0.0;
    for (double at = -8.0; at < 60.0; at += kStep) {  // beyond: below e^-1000 and e^-50
        const double g = std::exp(at);
        const double spread = 1.0 + people * r * r * g;
        const double log_ratio =
            -0.5 * std::log(spread) - 0.5 * (df + 1.0) * (std::log1p(t * t / (spread * df)) - none);
        sum += std::exp(log_ratio - 0.5 * at - 0.5 / g);
    }
    return sum * kStep * kInverseSqrtTwoPi;
}

}  // namespace palpate::data

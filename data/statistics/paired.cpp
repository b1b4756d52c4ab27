#include "data/statistics/paired.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "engine/base/pcg32.hpp"
#include "engine/base/text.hpp"
#include "protocols/psychometric/exact_math.hpp"

namespace palpate::data {
namespace {

constexpr std::size_t kMaxExact = 40;  ///< 2^20 sums in each half
constexpr int kDrawn = 1'000'000;

bool alike(std::span<const double> values, double size) {
    const auto [low, high] = std::ranges::minmax(values);
    return high - low <= kRounding * std::max({size, std::fabs(low), std::fabs(high)});
}

double squares_about(double mean, std::span<const double> values) {
    double squares = 0.0;
    for (const double value : values) {
        squares += (value - mean) * (value - mean);
    }
    return squares;
}

/// Standard error of the mean times the 97.5 % point of t; nothing if it would be 0 or is not
/// known.
std::optional<double> half_width(std::span<const double> values, double mean, double size) {
    if (values.size() < 2 || alike(values, size)) {
        return std::nullopt;
    }
    const auto n = static_cast<double>(values.size());
    return t_quantile(0.975, n - 1.0) * std::sqrt(squares_about(mean, values) / (n - 1.0) / n);
}

/// From the least on: sums do not depend on who comes first.
std::vector<double> in_order(std::span<const double> values) {
    std::vector<double> sorted(values.begin(), values.end());
    std::ranges::sort(sorted);
    return sorted;
}

double mean_of(std::span<const double> values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// The sums of all patterns of signs.
std::vector<double> signed_sums(std::span<const double> values) {
    std::vector<double> sums{0.0};
    for (const double value : values) {
        const std::size_t before = sums.size();
        for (std::size_t i = 0; i < before; ++i) {
            sums.push_back(sums[i] - value);
            sums[i] += value;
        }
    }
    return sums;
}

/// The share of patterns whose sum reaches `far` on either side, by the sums of both halves of the
/// people.
double exact_share(std::span<const double> differences, double far) {
    const std::size_t half = differences.size() / 2;
    const std::vector<double> first = signed_sums(differences.first(half));
    std::vector<double> second = signed_sums(differences.subspan(half));
    std::ranges::sort(second);
    double reached = 0.0;
    for (const double sum : first) {
        reached += static_cast<double>(second.end() - std::ranges::lower_bound(second, far - sum));
        reached +=
            static_cast<double>(std::ranges::upper_bound(second, -far - sum) - second.begin());
    }
    return reached / (static_cast<double>(first.size()) * static_cast<double>(second.size()));
}

double drawn_share(std::span<const double> differences, double far) {
    Pcg32 random(20260301, 1);
    int reached = 1;  // the observed pattern is one of them
    for (int i = 1; i < kDrawn; ++i) {
        double sum = 0.0;
        for (const double difference : differences) {
            sum += random.bounded(2) == 0 ? difference : -difference;
        }
        reached += std::fabs(sum) >= far ? 1 : 0;
    }
    return static_cast<double>(reached) / kDrawn;
}

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

}  // namespace

double signed_sums_p(std::span<const std::size_t> sizes, std::size_t above) {
    const std::size_t all = std::accumulate(sizes.begin(), sizes.end(), std::size_t{0});
    std::vector<double> chance(all + 1);  // of the sum of those above 0
    chance[0] = 1.0;
    std::size_t reached = 0;
    for (const std::size_t size : sizes) {
        reached += size;
        for (std::size_t s = reached + 1; s-- > 0;) {
            chance[s] = 0.5 * (chance[s] + (s >= size ? chance[s - size] : 0.0));
        }
    }
    const std::size_t lower = std::min(above, all - above);
    double p = 0.0;
    for (std::size_t s = 0; s <= all; ++s) {
        p += std::min(s, all - s) <= lower ? chance[s] : 0.0;
    }
    return std::min(p, 1.0);
}

double difference_of(double first, double second) {
    const double size = std::max(std::fabs(first), std::fabs(second));
    return std::fabs(second - first) <= kRounding * size ? 0.0 : second - first;
}

PeopleMean mean_over_people(std::span<const double> of_each, double size) {
    const std::vector<double> values = in_order(of_each);
    PeopleMean made{.people = values.size(), .mean = mean_of(values)};
    if (const auto half = half_width(values, made.mean, size)) {
        made.interval = Interval{made.mean - *half, made.mean + *half};
    }
    return made;
}

PeopleMean mean_share_over_people(std::span<const double> of_each) {
    const std::vector<double> shares = in_order(of_each);
    PeopleMean made{.people = shares.size(), .mean = mean_of(shares)};
    const auto half = half_width(shares, made.mean, 0.0);
    if (half && made.mean > 0.0 && made.mean < 1.0) {
        const double logit = std::log(made.mean / (1.0 - made.mean));
        const double far = *half / (made.mean * (1.0 - made.mean));
        made.interval =
            Interval{1.0 / (1.0 + std::exp(far - logit)), 1.0 / (1.0 + std::exp(-far - logit))};
    }
    return made;
}

SignFlip sign_flip(std::span<const double> differences) {
    double sum = 0.0;
    double size = 0.0;
    for (const double difference : differences) {
        sum += difference;
        size += std::fabs(difference);
    }
    // Sums of the same shares in another order differ in their last bits: they count as equal.
    const double far = std::fabs(sum) - 1e-9 * size;
    if (far <= 0.0) {
        return {};
    }
    const bool exact = differences.size() <= kMaxExact;
    return {.p = exact ? exact_share(differences, far) : drawn_share(differences, far),
            .exact = exact};
}

std::string without_text(std::span<const LeftOutPerson> people) {
    std::string text;
    for (const LeftOutPerson& one : people) {
        text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", one.name, one.why);
    }
    return people.empty()
             ? text
             : fmt::format("{} left out: {}", counted(people.size(), "person", "people"), text);
}

std::optional<double> median_of(std::vector<double> values) {
    if (values.empty()) {
        return std::nullopt;
    }
    std::ranges::sort(values);
    const double low = values[(values.size() - 1) / 2];
    const double high = values[values.size() / 2];
    const bool known = std::isfinite(low) && std::isfinite(high);
    return known ? std::optional(0.5 * (low + high)) : std::nullopt;
}

Interval newcombe(std::int64_t k1, std::int64_t n1, std::int64_t k2, std::int64_t n2) {
    const double p1 = static_cast<double>(k1) / static_cast<double>(n1);
    const double p2 = static_cast<double>(k2) / static_cast<double>(n2);
    const Interval one = wilson(k1, n1);
    const Interval two = wilson(k2, n2);
    return {p2 - p1 - std::hypot(p2 - two.low, one.high - p1),
            p2 - p1 + std::hypot(two.high - p2, p1 - one.low)};
}

std::optional<PairedT> paired_t(std::span<const double> differences, double size) {
    if (differences.empty()) {
        return std::nullopt;
    }
    const PeopleMean mean = mean_over_people(differences, size);
    if (!mean.interval) {
        return std::nullopt;
    }
    const auto n = static_cast<double>(differences.size());
    PairedT made{.mean = mean.mean,
                 .sd = std::sqrt(squares_about(mean.mean, differences) / (n - 1.0)),
                 .df = n - 1.0};
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
    made.p = made.exact ? signed_sums_p(ranks, sum)
                        : 2.0 * protocols::normal_cdf(-far / std::sqrt(0.25 * squares));
    return made;
}

double jzs_bayes_factor(double t, std::size_t n, double r) {
    constexpr double kStep = 0.02;
    constexpr double kNormalAtZero = 0.398942280401432677939946059934381868;
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
    return sum * kStep * kNormalAtZero;
}

}  // namespace palpate::data

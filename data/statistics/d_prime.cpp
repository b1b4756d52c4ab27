#include "data/statistics/d_prime.hpp"

#include <algorithm>
#include <cmath>

#include "protocols/psychometric/exact_math.hpp"

namespace palpate::data {
namespace {

constexpr double kInverseSqrtTwoPi = 0.398942280401432677939946059934381868;

}  // namespace

double share_correct(double d, std::int64_t m) {
    constexpr double kStep = 0.0625;
    constexpr int kReach = 144;  // 9 deviations to each side: phi(9) is 1e-18
    double sum = 0.0;
    for (int i = -kReach; i <= kReach; ++i) {
        const double x = kStep * i;
        sum += std::exp(-0.5 * x * x) *
               std::pow(protocols::normal_cdf(x + d), static_cast<double>(m - 1));
    }
    return sum * kStep * kInverseSqrtTwoPi;
}

double d_prime(std::int64_t hits, std::int64_t n, std::int64_t m, std::int64_t least) {
    const auto count = static_cast<double>(n);
    const double end = 0.5 / static_cast<double>(least > 0 ? least : n);
    const double share = std::clamp(static_cast<double>(hits) / count, end, 1.0 - end);
    if (m == 2) {
        return std::sqrt(2.0) * protocols::normal_quantile(share);
    }
    double low = -1.0;
    double high = 1.0;
    while (share_correct(low, m) > share) {
        low *= 2.0;
    }
    while (share_correct(high, m) < share) {
        high *= 2.0;
    }
    // Halving only: 60 halvings of 64 end below 1e-16, and a table of thousands takes a second.
    for (int i = 0; i < 60 && high - low > 1e-12; ++i) {
        const double middle = 0.5 * (low + high);
        (share_correct(middle, m) < share ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

YesNo yes_no(std::int64_t hits,
             std::int64_t signals,
             std::int64_t false_alarms,
             std::int64_t noises,
             std::int64_t least_signals,
             std::int64_t least_noises) {
    const auto z = [](std::int64_t yes, std::int64_t n, std::int64_t least) {
        const auto of = static_cast<double>(least > 0 ? least : n);
        const double like = static_cast<double>(yes) * (of / static_cast<double>(n));
        return protocols::normal_quantile((like + 0.5) / (of + 1.0));
    };
    const double hit = z(hits, signals, least_signals);
    const double alarm = z(false_alarms, noises, least_noises);
    return {.d_prime = hit - alarm, .criterion = -0.5 * (hit + alarm)};
}

}  // namespace palpate::data

#include "data/statistics/information.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "protocols/psychometric/exact_math.hpp"
#include "data/statistics/solve.hpp"

namespace palpate::data {
namespace {

constexpr double kInverseSqrtTwoPi = 0.398942280401432677939946059934381868;

struct Entropy {
    double bits = 0.0;
    double cells = 0.0;  ///< that occur
};

template <class Counts>
Entropy entropy(const Counts& counts, double all) {
    Entropy entropy;
    for (const auto& [key, n] : counts) {
        if (n > 0) {
            const double share = static_cast<double>(n) / all;
            entropy.bits -= share * std::log2(share);
            entropy.cells += 1.0;
        }
    }
    return entropy;
}

}  // namespace

double share_correct(double d, std::int64_t m) {
    constexpr double kStep = 0.0625;
    constexpr int kReach = 144;  // 9 deviations to each side: phi(9) is 1e-18
    static const auto kBells = [] {
        std::array<double, 2 * kReach + 1> bells{};
        for (int i = -kReach; i <= kReach; ++i) {
            const double x = kStep * i;
            bells[static_cast<std::size_t>(i + kReach)] = std::exp(-0.5 * x * x);
        }
        return bells;
    }();
    double sum = 0.0;
    double x = -kStep * kReach;  // its sums are exact
    for (const double bell : kBells) {
        sum += bell * std::pow(protocols::normal_cdf(x + d), static_cast<double>(m - 1));
        x += kStep;
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
    const auto beyond = [share, m](double d) {
        return share_correct(d, m) - share;
    };
    Reading low{-1.0, beyond(-1.0)};
    Reading high{1.0, beyond(1.0)};
    while (low.value > 0.0) {
        low = {2.0 * low.at, beyond(2.0 * low.at)};
    }
    while (high.value < 0.0) {
        high = {2.0 * high.at, beyond(2.0 * high.at)};
    }
    // Halvings, of which most are decided by where it passes, about.
    constexpr double kAbout = 1e-11;
    const double near = crossing(beyond, 0.0, low, high, 1e-15);
    for (int i = 0; i < 60 && high.at - low.at > 1e-12; ++i) {
        const double middle = 0.5 * (low.at + high.at);
        const bool below = std::fabs(middle - near) > kAbout ? middle < near : beyond(middle) < 0.0;
        (below ? low : high).at = middle;
    }
    const double found = 0.5 * (low.at + high.at);
    return std::fabs(found) < 1e-12 ? 0.0 : found;  // of chance alone: none
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

Information mutual_information(const ConfusionCounts& counts) {
    std::map<std::string, std::int64_t> stimuli;
    std::map<std::string, std::int64_t> responses;
    std::int64_t sum = 0;
    for (const auto& [pair, n] : counts) {
        stimuli[pair.first] += n;
        responses[pair.second] += n;
        sum += n;
    }
    if (sum == 0) {
        return {};
    }
    const auto all = static_cast<double>(sum);
    const Entropy x = entropy(stimuli, all);
    const Entropy y = entropy(responses, all);
    const Entropy both = entropy(counts, all);
    const double plug_in = x.bits + y.bits - both.bits;
    const double cells = x.cells + y.cells - both.cells - 1.0;
    const double miller_madow = plug_in + cells / (2.0 * all * std::numbers::ln2);
    const double most = std::clamp(x.bits, 0.0, std::log2(x.cells));
    return {.plug_in = plug_in,
            .miller_madow = miller_madow,
            .corrected = std::clamp(miller_madow, 0.0, most),
            .most = most};
}

}  // namespace palpate::data

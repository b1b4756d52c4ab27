#include "data/statistics/information.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "protocols/psychometric/exact_math.hpp"

namespace palpate::data {
namespace {

constexpr double kInverseSqrtTwoPi = 0.398942280401432677939946059934381868;

/// A place and what the share of correct answers is there beyond the one looked for.
struct Beyond {
    double d = 0.0;
    double by = 0.0;
};

/// Where nothing is beyond, about, between two ends: by the secant, the weight of an end that stays
/// halved (Illinois' rule).
template <class At>
double passed_near(Beyond low, Beyond high, const At& at) {
    double before = 0.0;
    for (int i = 0; i < 30 && low.by < 0.0 && high.by > 0.0; ++i) {
        const Beyond next = at(high.d - high.by * (high.d - low.d) / (high.by - low.by));
        if (std::fabs(next.by) < 1e-15) {
            return next.d;
        }
        (next.by < 0.0 ? low : high) = next;
        if (next.by * before > 0.0) {
            (next.by < 0.0 ? high : low).by *= 0.5;
        }
        before = next.by;
    }
    return low.by < 0.0 ? high.d : low.d;
}

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
    const auto at = [share, m](double d) {
        return Beyond{d, share_correct(d, m) - share};
    };
    Beyond low = at(-1.0);
    Beyond high = at(1.0);
    while (low.by > 0.0) {
        low = at(2.0 * low.d);
    }
    while (high.by < 0.0) {
        high = at(2.0 * high.d);
    }
    // Halvings, of which most are decided by where it passes, about.
    constexpr double kAbout = 1e-11;
    const double near = passed_near(low, high, at);
    for (int i = 0; i < 60 && high.d - low.d > 1e-12; ++i) {
        const double middle = 0.5 * (low.d + high.d);
        const bool below = std::fabs(middle - near) > kAbout ? middle < near : at(middle).by < 0.0;
        (below ? low : high).d = middle;
    }
    return 0.5 * (low.d + high.d);
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

#include "data/fit/bootstrap.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "engine/base/pcg32.hpp"
#include "engine/math/elementary.hpp"
#include "protocols/psychometric/exact_math.hpp"
#include "data/fit/optimum.hpp"

namespace palpate::data {
namespace {

/// Draws a binomial number by the inverse of its distribution: one uniform number, log2(n) comparisons.
class Binomial {
public:
    Binomial(double n, double p) {
        const auto count = static_cast<std::size_t>(n);
        const double mean = n * p;
        const double reach = 12.0 * std::sqrt(mean * (1.0 - p)) + 40.0;  // beyond: below 1e-30
        first_ = static_cast<std::size_t>(std::max(0.0, std::floor(mean - reach)));
        const std::size_t last = std::min(count, static_cast<std::size_t>(mean + reach) + 1);
        if (p <= 0.0 || p >= 1.0) {
            first_ = p <= 0.0 ? 0 : count;
            return;
        }
        // Terms over that of the mode, outward, so that none overflows.
        const auto mode = std::clamp(static_cast<std::size_t>(mean), first_, last);
        std::vector<double> terms(last - first_ + 1, 1.0);
        const double odds = p / (1.0 - p);
        for (std::size_t k = mode; k < last; ++k) {
            terms[k + 1 - first_] = terms[k - first_] * odds * static_cast<double>(count - k) /
                                    static_cast<double>(k + 1);
        }
        for (std::size_t k = mode; k > first_; --k) {
            terms[k - 1 - first_] = terms[k - first_] / odds * static_cast<double>(k) /
                                    static_cast<double>(count - k + 1);
        }
        double sum = 0.0;
        for (double& term : terms) {
            sum += term;
            term = sum;
        }
        for (double& term : terms) {
            term /= sum;
        }
        terms.back() = 1.0;
        cumulative_ = std::move(terms);
    }

    [[nodiscard]] double draw(Pcg32& random) const {
        const double uniform = (static_cast<double>(random.next()) +
                                (static_cast<double>(random.next()) + 0.5) * 0x1p-32) *
                               0x1p-32;
        const auto at = std::ranges::lower_bound(cumulative_, uniform);
        return static_cast<double>(first_) + static_cast<double>(at - cumulative_.begin());
    }

private:
    std::size_t first_ = 0;
    std::vector<double> cumulative_{};  ///< none: it is always first_
};

/// Where the samples are drawn from.
CurvePoint source(const CurveModel& model, const CurveFit& fit) {
    constexpr Prior kWeak{2.0, 20.0};
    constexpr double kNearItsMode = 0.05;
    const CurveSpec& spec = model.spec();
    const bool lapses = spec.lapse_free && !spec.lapse_prior;
    const bool guesses = spec.guess_free && !spec.two_sided && !spec.guess_prior;
    if (!lapses && !guesses) {
        return fit.at;
    }
    CurveModel held = model;
    held.set_rate_priors(guesses ? kWeak : spec.guess_prior, lapses ? kWeak : spec.lapse_prior);
    CurvePoint start = fit.at;
    start[2] = guesses ? kNearItsMode : start[2];
    start[3] = lapses ? kNearItsMode : start[3];
    return held.whole(climb(held, start, held.free()).at);
}

/// Told by its logarithm: it is above 0, and off by a factor.
bool by_logarithm(const CurveSpec& spec, Quantity quantity) {
    switch (quantity) {
        case Quantity::jnd:
        case Quantity::weber:
        case Quantity::slope:
            return true;
        case Quantity::threshold:
        case Quantity::at_share:
            return spec.family == protocols::Family::weibull;
        case Quantity::guess:
        case Quantity::lapse:
            return false;
    }
    return false;
}

}  // namespace

Bootstrap bootstrap(const CurveModel& model,
                    const CurveFit& fit,
                    std::size_t samples,
                    std::uint64_t seed,
                    std::uint64_t stream) {
    CurveModel drawn = model;
    const CurveMask free = model.free();
    std::vector<double> values(model.levels());
    Bootstrap all{.from = source(model, fit)};
    drawn.chances(all.from, values);
    std::vector<Binomial> levels;
    for (std::size_t i = 0; i < values.size(); ++i) {
        levels.emplace_back(model.counts()[i], values[i]);
    }
    Pcg32 random(seed, stream);
    all.at.reserve(samples);
    std::size_t worse = 1;
    std::map<std::vector<double>, Optimum> searched;  ///< few counts come again and again
    for (std::size_t s = 0; s < samples; ++s) {
        for (std::size_t i = 0; i < values.size(); ++i) {
            values[i] = levels[i].draw(random);
        }
        drawn.set_hits(values);
        Optimum found = climb(drawn, all.from, free, 1e-7);
        if (!found.settled || found.at[1] >= model.high()[1] || found.at[1] <= model.low()[1]) {
            const auto [known, first] = searched.try_emplace(values);
            if (first) {
                known->second = highest(drawn, found.at, free, Search::quick, 1e-7).best;
            }
            found = known->second;
        }
        all.steep += found.at[1] >= model.high()[1] - protocols::kLn2 ? std::size_t{1} : 0;
        all.at.push_back(drawn.whole(found.at));
        // Equal counts in another order of sums differ in their last bits.
        worse += drawn.deviance(all.at.back()) >= fit.deviance * (1.0 - 1e-9) ? std::size_t{1} : 0;
    }
    all.deviance_p = static_cast<double>(worse) / static_cast<double>(samples + 1);
    return all;
}

std::vector<double> of_all(const CurveSpec& spec,
                           const Bootstrap& samples,
                           Quantity quantity,
                           double share) {
    std::vector<double> values;
    values.reserve(samples.at.size());
    for (const CurvePoint& point : samples.at) {
        values.push_back(quantity_of(spec, point, quantity, share));
    }
    return values;
}

std::optional<double> corrected(const CurveSpec& spec,
                                const CurveFit& fit,
                                const Bootstrap& samples,
                                Quantity quantity,
                                double share) {
    const bool logarithm = by_logarithm(spec, quantity);
    const auto told = [logarithm](double value) {
        return logarithm ? engine::natural_log(value) : value;
    };
    double sum = 0.0;
    std::size_t used = 0;
    for (const double value : of_all(spec, samples, quantity, share)) {
        if (std::isfinite(value) && (!logarithm || value > 0.0)) {
            sum += told(value);
            ++used;
        }
    }
    const double estimate = quantity_of(spec, fit.at, quantity, share);
    const double from = quantity_of(spec, samples.from, quantity, share);
    const auto few = static_cast<double>(samples.at.size()) / 100.0;
    if (used == 0 || static_cast<double>(samples.at.size() - used) > few ||
        static_cast<double>(samples.steep) > few || !std::isfinite(told(estimate)) ||
        !std::isfinite(told(from))) {
        return std::nullopt;
    }
    const double value = told(estimate) - (sum / static_cast<double>(used) - told(from));
    return logarithm ? protocols::exponential(value) : value;
}

std::optional<Interval> bootstrap_interval(std::vector<double> values, double from) {
    std::erase_if(values, [](double value) { return std::isnan(value); });
    constexpr std::size_t kFewest = 40;
    if (values.size() < kFewest || !std::isfinite(from)) {
        return std::nullopt;
    }
    std::ranges::sort(values);
    const double slack = 1e-9 * std::fabs(from);
    const auto below = std::ranges::lower_bound(values, from - slack) - values.begin();
    const auto up_to = std::ranges::upper_bound(values, from + slack) - values.begin();
    const auto n = static_cast<double>(values.size());
    const double z0 = protocols::normal_quantile(0.5 * static_cast<double>(below + up_to) / n);
    if (!std::isfinite(z0)) {
        return std::nullopt;
    }
    const auto at = [&](double z) {
        const double place = protocols::normal_cdf(2.0 * z0 + z) * (n + 1.0) - 1.0;
        const double clamped = std::clamp(place, 0.0, n - 1.0);
        const auto left = static_cast<std::size_t>(clamped);
        const std::size_t right = std::min(left + 1, values.size() - 1);
        const double t = clamped - static_cast<double>(left);
        return (1.0 - t) * values[left] + t * values[right];
    };
    return Interval{at(-kNormal95), at(kNormal95)};
}

}  // namespace palpate::data

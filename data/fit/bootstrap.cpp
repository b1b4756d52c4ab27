#include <limits>
#include <map>

#include "engine/math/elementary.hpp"
#include "protocols/psychometric/exact_math.hpp"
#include "data/fit/curve_fit.hpp"
#include "data/fit/fit_report.hpp"

namespace palpate::data {
namespace {

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

/// Given by its logarithm: it is above 0, and off by a factor.
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

/// A quantity where the curve has no end.
double endless(
    const CurveSpec& spec, const CurvePoint& point, End end, Quantity quantity, double share) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    const bool weibull = spec.family == protocols::Family::weibull;
    switch (quantity) {
        case Quantity::threshold:
            if (end == End::far_up || end == End::far_down) {
                return end == End::far_up ? kInfinity : weibull ? 0.0 : -kInfinity;
            }
            break;
        case Quantity::jnd:
            if (end != End::both) {
                return end == End::steep ? 0.0 : kInfinity;
            }
            break;
        case Quantity::weber:
            if (end == End::steep && (weibull || point[0] > 0.0)) {
                return 0.0;
            }
            break;
        case Quantity::slope:
            if (end == End::steep) {
                return kInfinity;
            }
            break;
        case Quantity::guess:
        case Quantity::lapse:
        case Quantity::at_share:
            break;
    }
    const double value = quantity_of(spec, point, quantity, share);
    if (!std::isnan(value)) {
        return value;
    }
    const bool logarithmic = spec.family == protocols::Family::weibull_log10 ||
                             spec.family == protocols::Family::weibull_db;
    if (quantity == Quantity::at_share) {
        const bool below = share <= quantity_of(spec, point, Quantity::guess);
        return !below ? kInfinity : weibull ? 0.0 : -kInfinity;
    }
    return quantity == Quantity::weber && !logarithmic ? kInfinity : value;
}

/// No slope is too steep: the steepest curve is as good, at its place or with one level on its
/// rise.
bool is_steep(const CurveModel& model, const CurvePoint& at) {
    constexpr double kNearlyAStep = 2.70805020110221;  // ln 15: four times the reciprocal gap
    constexpr double kAsGood = 1e-6;
    const CurvePoint& high = model.high();
    if (at[1] <= high[1] - kNearlyAStep) {
        return false;
    }
    CurvePoint step = at;
    step[1] = high[1];
    const double value = model.value(at) - kAsGood;
    if (at[1] >= high[1] - protocols::kLn2 || model.value(step) > value) {
        return true;
    }
    const protocols::Family family = model.spec().family;
    const double half = core_quantile(family, 0.5);
    const double rise = std::max(1.0 - at[2] - at[3], 0.01);
    for (std::size_t i = 0; i < model.levels(); ++i) {
        const double share = (model.hits()[i] / model.counts()[i] - at[2]) / rise;
        if (share > 0.0 && share < 1.0) {
            const double u = core_quantile(family, share) - half;
            step[0] = model.places()[i] - u * protocols::exponential(-high[1]);
            if (std::isfinite(step[0]) && model.value(step) > value) {
                return true;
            }
        }
    }
    return false;
}

}  // namespace

End end_of(const CurveModel& model, const CurvePoint& at) {
    const bool flat = at[1] <= model.low()[1];
    return at[0] >= model.high()[0] || (flat && at[0] > model.last()) ? End::far_up
         : at[0] <= model.low()[0] || (flat && at[0] < model.first()) ? End::far_down
         : is_steep(model, at)                                        ? End::steep
                                                                      : End::both;
}

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
        const End end = end_of(drawn, found.at);
        all.ends.push_back(end);
        all.steep += end == End::steep ? std::size_t{1} : 0;
        all.far += end == End::far_up || end == End::far_down ? std::size_t{1} : 0;
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
    for (std::size_t i = 0; i < samples.at.size(); ++i) {
        values.push_back(endless(spec, samples.at[i], samples.ends[i], quantity, share));
    }
    return values;
}

std::optional<double> corrected(const CurveSpec& spec,
                                const CurveFit& fit,
                                const Bootstrap& samples,
                                Quantity quantity,
                                double share) {
    const bool logarithm = by_logarithm(spec, quantity);
    const auto on_scale = [logarithm](double value) {
        return logarithm ? engine::natural_log(value) : value;
    };
    double sum = 0.0;
    std::size_t used = 0;
    for (const double value : of_all(spec, samples, quantity, share)) {
        if (std::isfinite(value) && (!logarithm || value > 0.0)) {
            sum += on_scale(value);
            ++used;
        }
    }
    const double estimate = quantity_of(spec, fit.at, quantity, share);
    const double from = quantity_of(spec, samples.from, quantity, share);
    const auto few = static_cast<double>(samples.at.size()) / 100.0;
    if (used == 0 || static_cast<double>(samples.at.size() - used) > few ||
        static_cast<double>(samples.steep) > few || !std::isfinite(on_scale(estimate)) ||
        !std::isfinite(on_scale(from))) {
        return std::nullopt;
    }
    const double value = on_scale(estimate) - (sum / static_cast<double>(used) - on_scale(from));
    return logarithm ? protocols::exponential(value) : value;
}

std::optional<Interval> bootstrap_interval(std::vector<double> values, double from) {
    const auto none = std::erase_if(values, [](double value) { return std::isnan(value); });
    constexpr std::size_t kFewest = 40;
    if (values.size() < kFewest || 100 * none > values.size() || !std::isfinite(from)) {
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
        return t == 0.0 || values[left] == values[right]
                 ? values[left]
                 : (1.0 - t) * values[left] + t * values[right];
    };
    return Interval{at(-kNormal95), at(kNormal95)};
}

}  // namespace palpate::data

#include "data/inference/mixed_logit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "engine/base/pcg32.hpp"
#include "engine/base/side_by_side.hpp"
#include "protocols/psychometric/exact_math.hpp"
#include "data/statistics/distributions.hpp"

namespace palpate::data {
namespace {

/// e^-x, and log(1 + e^-x), of the x that was asked for last: the search for a peak asks for slope
/// and value at the same place.
class Decay {
public:
    double of(double x) {
        if (x != x_) {
            x_ = x;
            decay_ = std::exp(-x);
            log_ = kNone;
        }
        return decay_;
    }
    double log_of(double x) {
        const double decay = of(x);
        log_ = log_ == kNone ? std::log1p(decay) : log_;
        return log_;
    }

private:
    static constexpr double kNone = -1.0;
    double x_ = std::numeric_limits<double>::quiet_NaN();
    double decay_ = 0.0;
    double log_ = kNone;
};

/// What (s0, s1) = L u does to a person's two logits, and their answers.
struct PersonIntegral {
    const TwoCounts& person;
    std::array<double, 2> fixed;
    std::array<std::array<double, 2>, 2> along;  ///< d logit c / d u
    std::array<Decay, 2> decay;                  ///< of the logits

    [[nodiscard]] double value(double u0, double u1) {
        double sum = -0.5 * (u0 * u0 + u1 * u1);
        for (std::size_t c = 0; c < 2; ++c) {
            const double logit = fixed[c] + along[c][0] * u0 + along[c][1] * u1;
            // log(1 + e^x) without overflow
            const double soft = std::max(logit, 0.0) + decay[c].log_of(std::fabs(logit));
            sum += person.k[c] * logit - person.n[c] * soft;
        }
        return sum;
    }
};

/// The maximum of a PersonIntegral, and L of its curvature L L'.
struct Peak {
    double u0 = 0.0;
    double u1 = 0.0;
    double l00 = 1.0;
    double l10 = 0.0;
    double l11 = 1.0;
};

Peak peak_of(PersonIntegral& of) {
    Peak peak;
    for (int step = 0; step < 100; ++step) {
        double g0 = -peak.u0;
        double g1 = -peak.u1;
        double h00 = 1.0;
        double h10 = 0.0;
        double h11 = 1.0;
        for (std::size_t c = 0; c < 2; ++c) {
            const auto& z = of.along[c];
            const double logit = of.fixed[c] + z[0] * peak.u0 + z[1] * peak.u1;
            const double p = 1.0 / (1.0 + of.decay[c].of(logit));
            const double residual = of.person.k[c] - of.person.n[c] * p;
            const double weight = of.person.n[c] * p * (1.0 - p);
            g0 += residual * z[0];
            g1 += residual * z[1];
            h00 += weight * z[0] * z[0];
            h10 += weight * z[0] * z[1];
            h11 += weight * z[1] * z[1];
        }
        peak.l00 = std::sqrt(h00);
        peak.l10 = h10 / peak.l00;
        peak.l11 = std::sqrt(h11 - peak.l10 * peak.l10);
        const double y0 = g0 / peak.l00;
        const double y1 = (g1 - peak.l10 * y0) / peak.l11;
        if (y0 * y0 + y1 * y1 < 1e-22) {
            break;
        }
        const double s1 = y1 / peak.l11;
        const double s0 = (y0 - peak.l10 * s1) / peak.l00;
        double share = 1.0;
        if (y0 * y0 + y1 * y1 > 0.25) {  // the sum is concave: a short enough step gains
            const double now = of.value(peak.u0, peak.u1);
            while (share > 1e-6 && of.value(peak.u0 + share * s0, peak.u1 + share * s1) < now) {
                share *= 0.5;
            }
        }
        peak.u0 += share * s0;
        peak.u1 += share * s1;
    }
    return peak;
}

double log_integral(PersonIntegral of, const Nodes& nodes) {
    const Peak peak = peak_of(of);
    const double top = of.value(peak.u0, peak.u1);
    double sum = 0.0;
    for (std::size_t i = 0; i < nodes.at.size(); ++i) {
        for (std::size_t j = 0; j < nodes.at.size(); ++j) {
            const double zi = nodes.at[i];
            const double zj = nodes.at[j];
            const double d1 = std::numbers::sqrt2 * zj / peak.l11;
            const double d0 = (std::numbers::sqrt2 * zi - peak.l10 * d1) / peak.l00;
            sum += nodes.weight[i] * nodes.weight[j] *
                   std::exp(of.value(peak.u0 + d0, peak.u1 + d1) - top + zi * zi + zj * zj);
        }
    }
    return top - std::log(peak.l00 * peak.l11) + std::log(sum / std::numbers::pi);
}

/// A function of the parameters that are fitted, in the order b0, b1, l11, l21, l22.
class Objective {
public:
    Objective(std::span<const TwoCounts> people, const MixedSpec& spec)
        : people_(people), spec_(spec), nodes_(gauss_hermite(spec.nodes)) {}

    /// b0, b1, l11, l21, l22
    [[nodiscard]] std::array<double, 5> whole(std::span<const double> at) const {
        std::size_t i = 0;
        std::array<double, 5> all{};
        all[0] = at[i++];
        all[1] = spec_.effect ? at[i++] : 0.0;
        all[2] = at[i++];
        if (spec_.slope) {
            all[3] = at[i++];
            all[4] = at[i++];
        }
        return all;
    }
    [[nodiscard]] std::vector<double> part(const std::array<double, 5>& all) const {
        std::vector<double> at{all[0]};
        if (spec_.effect) {
            at.push_back(all[1]);
        }
        at.push_back(all[2]);
        if (spec_.slope) {
            at.insert(at.end(), {all[3], all[4]});
        }
        return at;
    }
    /// Half of the deviance.
    [[nodiscard]] double operator()(std::span<const double> at) const {
        const auto all = whole(at);
        return 0.5 * mixed_deviance(people_, all[0], all[1], {all[2], all[3], all[4]}, nodes_);
    }

private:
    std::span<const TwoCounts> people_;
    MixedSpec spec_;
    Nodes nodes_;
};

void add_errors(const Objective& f, const Minimum& best, MixedFit& fit) {
    if (const auto covariance = inverse_curvature(f, best.at)) {
        const auto error_of = [&](std::size_t i) {
            const double variance = (*covariance)[i * best.at.size() + i];
            return std::isfinite(variance) && variance > 0.0 ? std::optional(std::sqrt(variance))
                                                             : std::nullopt;
        };
        fit.intercept_se = error_of(0);
        fit.effect_se = fit.spec.effect ? error_of(1) : std::nullopt;
    }
}

MixedFit fit_of(const Objective& f, const MixedSpec& spec, const Minimum& best) {
    const auto all = f.whole(best.at);
    MixedFit fit{.spec = spec, .intercept = all[0], .effect = all[1]};
    // L and L with a column turned round give the same covariance: the diagonal is held above 0.
    const double one = all[2] < 0.0 ? -1.0 : 1.0;
    fit.l = {std::fabs(all[2]), one * all[3], std::fabs(all[4])};
    fit.sd_intercept = fit.l[0];
    fit.sd_slope = std::hypot(fit.l[1], fit.l[2]);
    constexpr double kNone = 1e-4;
    if (spec.slope && fit.sd_intercept > kNone && fit.sd_slope > kNone) {
        fit.correlation = fit.l[1] / fit.sd_slope;
    }
    fit.log_likelihood = -best.value;
    fit.singular = fit.l[0] < kNone || (spec.slope && fit.l[2] < kNone);
    constexpr double kFar = 10.0;
    fit.intercept_unbounded = std::fabs(fit.intercept) > kFar;
    fit.unbounded = fit.intercept_unbounded || std::fabs(fit.effect) > kFar;
    fit.converged = best.converged;
    return fit;
}

/// Logits of the shares of all people, half an answer added to either side.
std::array<double, 2> pooled_logits(std::span<const TwoCounts> people) {
    std::array<double, 2> logits{};
    for (std::size_t c = 0; c < 2; ++c) {
        double hits = 0.5;
        double misses = 0.5;
        for (const TwoCounts& one : people) {
            hits += one.k[c];
            misses += one.n[c] - one.k[c];
        }
        logits[c] = std::log(hits / misses);
    }
    return logits;
}

double uniform_of(Pcg32& random) {
    return (static_cast<double>(random.next()) +
            (static_cast<double>(random.next()) + 0.5) * 0x1p-32) *
           0x1p-32;
}

/// Answers of people like those that `null` describes.
std::vector<TwoCounts> drawn(std::span<const TwoCounts> people,
                             const MixedFit& null,
                             Pcg32& random) {
    std::vector<TwoCounts> made;
    for (const TwoCounts& one : people) {
        const double u0 = protocols::normal_quantile(uniform_of(random));
        const double u1 = protocols::normal_quantile(uniform_of(random));
        TwoCounts& other = made.emplace_back(TwoCounts{.n = one.n});
        for (std::size_t c = 0; c < 2; ++c) {
            const double logit =
                null.intercept + null.l[0] * u0 + (c == 1 ? null.l[1] * u0 + null.l[2] * u1 : 0.0);
            const double p = 1.0 / (1.0 + protocols::exponential(-logit));
            for (double n = 0.0; n < one.n[c]; n += 1.0) {
                other.k[c] += uniform_of(random) < p ? 1.0 : 0.0;
            }
        }
    }
    return made;
}

}  // namespace

double mixed_deviance(std::span<const TwoCounts> people,
                      double b0,
                      double b1,
                      const std::array<double, 3>& l,
                      const Nodes& nodes) {
    const std::array<double, 2> fixed{b0, b0 + b1};
    std::array<Decay, 2> decay;  // where the search begins for everybody
    for (std::size_t c = 0; c < 2; ++c) {
        decay[c].log_of(std::fabs(fixed[c]));
        decay[c].of(fixed[c]);
    }
    double sum = 0.0;
    for (const TwoCounts& one : people) {
        sum += log_integral({.person = one,
                             .fixed = fixed,
                             .along = {{{l[0], 0.0}, {l[0] + l[1], l[2]}}},
                             .decay = decay},
                            nodes);
    }
    return -2.0 * sum;
}

MixedFit fit_mixed(std::span<const TwoCounts> people, const MixedSpec& spec, const MixedFit* from) {
    const Objective f(people, spec);
    std::vector<std::array<double, 5>> starts;
    if (from != nullptr) {
        // Off the boundary: there the slope of l22 is 0 and no step would leave it.
        starts.push_back({from->intercept, from->effect, std::max(from->l[0], 0.05), from->l[1],
                          std::max(from->l[2], 0.05)});
    } else {
        const auto logits = pooled_logits(people);
        for (const double spread : {0.2, 0.6, 1.5}) {
            starts.push_back({logits[0], logits[1] - logits[0], spread, 0.0, 0.7 * spread});
        }
    }
    Minimum best;
    for (const auto& start : starts) {
        Minimum found = minimum_near(f, f.part(start));
        if (best.at.empty() || found.value < best.value) {
            best = std::move(found);
        }
    }
    if (spec.errors) {
        polish(f, best);
    }
    MixedFit fit = fit_of(f, spec, best);
    if (spec.errors) {
        add_errors(f, best, fit);
    }
    return fit;
}

double likelihood_ratio(const MixedFit& full, const MixedFit& less) {
    return std::max(0.0, 2.0 * (full.log_likelihood - less.log_likelihood));
}

double slope_variance_p(double ratio) {
    return 0.5 * (chi_square_p(ratio, 1) + chi_square_p(ratio, 2));
}

SimulatedNull simulate_null(std::span<const TwoCounts> people,
                            const MixedFit& null,
                            double ratio,
                            std::size_t samples,
                            std::uint64_t seed,
                            std::uint64_t stream) {
    std::vector<double> ratios(samples);
    for_each_number(usable_processors(), samples, [&](std::size_t s) {
        Pcg32 random(seed, stream + s);
        const std::vector<TwoCounts> answers = drawn(people, null, random);
        const MixedFit less = fit_mixed(answers, {.effect = false, .errors = false}, &null);
        ratios[s] = likelihood_ratio(fit_mixed(answers, {.errors = false}, &less), less);
    });
    // Equal counts give equal ratios but for the last digits of the search.
    const auto reached = std::ranges::count_if(
        ratios, [&](double one) { return one >= ratio - 1e-6 * std::max(1.0, ratio); });
    return {.samples = samples,
            .p = static_cast<double>(reached + 1) / static_cast<double>(samples + 1)};
}

}  // namespace palpate::data

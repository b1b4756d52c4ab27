#include "data/inference/mixed_logit.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/base/pcg32.hpp"
#include "engine/base/side_by_side.hpp"
#include "protocols/psychometric/exact_math.hpp"
#include "data/statistics/distributions.hpp"
#include "data/statistics/solve.hpp"

namespace palpate::data {
namespace {

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

/// Standard error of parameter i of n. @param covariance  n x n
std::optional<double> error_of(const std::vector<double>& covariance,
                               std::size_t n,
                               std::size_t i) {
    const double variance = covariance[i * n + i];
    return std::isfinite(variance) && variance > 0.0 ? std::optional(std::sqrt(variance))
                                                     : std::nullopt;
}

void add_errors(const Objective& f, const Minimum& best, MixedFit& fit) {
    if (const auto covariance = inverse_curvature(f, best.at)) {
        const std::size_t n = best.at.size();
        fit.intercept_se = error_of(*covariance, n, 0);
        fit.effect_se = fit.spec.effect ? error_of(*covariance, n, 1) : std::nullopt;
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
    constexpr std::size_t kShare = 25;
    SideBySide work;
    std::size_t last = 0;
    for (std::size_t first = 0; first < samples; first += kShare) {
        last = work.add([&, first] {
            for (std::size_t s = first; s < std::min(first + kShare, samples); ++s) {
                Pcg32 random(seed, stream + s);
                const std::vector<TwoCounts> answers = drawn(people, null, random);
                const MixedFit less = fit_mixed(answers, {.effect = false, .errors = false}, &null);
                ratios[s] = likelihood_ratio(fit_mixed(answers, {.errors = false}, &less), less);
            }
        });
    }
    for (std::size_t task = 0; samples > 0 && task <= last; ++task) {
        work.wait_for(task);
    }
    // Equal counts give equal ratios but for the last digits of the search.
    const auto reached = std::ranges::count_if(
        ratios, [&](double one) { return one >= ratio - 1e-6 * std::max(1.0, ratio); });
    return {.samples = samples,
            .p = static_cast<double>(reached + 1) / static_cast<double>(samples + 1)};
}

}  // namespace palpate::data

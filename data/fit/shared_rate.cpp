#include <algorithm>
#include <cmath>

#include "engine/base/pcg32.hpp"
#include "engine/math/elementary.hpp"
#include "protocols/psychometric/exact_math.hpp"
#include "data/fit/curve_fit.hpp"
#include "data/fit/fit_report.hpp"

namespace palpate::data {
namespace {

/// Rates at which likelihoods are kept: 0.25 apart in the logarithm up to 0.001, where they are
/// nearly straight lines, and 0.05 apart beyond, of guess rates, which may be large, 0.03: cubics
/// in between are off by less than 1e-6.
/// @param rate  its place in CurvePoint
std::vector<double> log_rates(std::size_t rate) {
    constexpr double kMin = -16.0;  // 1e-7
    constexpr double kFine = -7.0;
    const bool guess = rate == 2;
    const double max = engine::natural_log(guess ? kMaxGuess : kMaxLapse);
    std::vector<double> all;
    for (double at = kMin; at < kFine; at += 0.25) {
        all.push_back(at);
    }
    const int steps = guess ? 224 : 112;
    for (int i = 0; i <= steps; ++i) {
        all.push_back(kFine + (max - kFine) * i / steps);
    }
    return all;
}

/// The model alone, without a belief of the rate that all share.
CurveModel alone(const CurveModel& model, bool keeps_prior) {
    CurveModel one = model;
    one.share(nullptr);
    if (!keeps_prior) {
        const CurveSpec& spec = model.spec();
        one.set_rate_priors(spec.guess_shared ? std::nullopt : spec.guess_prior,
                            spec.guess_shared ? spec.lapse_prior : std::nullopt);
    }
    return one;
}

struct RatePoint {
    double value = 0.0;
    double slope = 0.0;  ///< by the logarithm of the rate
};

/// The highest log-likelihood at each rate.
std::vector<RatePoint> highest_by_rate(const CurveModel& model, const std::vector<double>& places) {
    std::vector<RatePoint> kept(places.size());
    const std::size_t rate = model.spec().shared_rate();
    CurveMask free = model.free();
    free[rate] = false;
    CurvePoint near = model.middle();
    constexpr std::size_t kSearched = 12;  // the rates between follow their neighbours
    for (std::size_t back = places.size(); back > 0; --back) {
        const std::size_t i = back - 1;
        near[rate] = protocols::exponential(places[i]);
        Optimum best = climb(model, near, free);
        if (i % kSearched == 0 || back == places.size()) {
            const Optimum other = highest(model, near, free, Search::quick).best;
            best = other.value > best.value ? other : best;
        }
        near = best.at;
        CurvePoint gradient;
        CurveMatrix information;
        kept[i].value = model.derivatives(near, gradient, information);
        kept[i].slope = gradient[rate] * near[rate];
    }
    return kept;
}

/// All curves of a person at one rate.
struct Joint {
    std::vector<CurvePoint> at{};
    double value = 0.0;
};

/// What is each curve's own, eliminated: one equation for the rate, bend * step = slope, is left.
struct RateEquation {
    std::vector<CurvePoint> own;      ///< each curve's step where the rate stays
    std::vector<CurvePoint> by_rate;  ///< and what a step of the rate takes off it
    double slope = 0.0;
    double bend = 0.0;
};
RateEquation without_own(std::span<const CurveModel> models,
                         const std::vector<CurvePoint>& at,
                         const std::vector<CurvePoint>& gradients,
                         const std::vector<CurveMatrix>& informations,
                         std::span<const CurveMask> free,
                         double damping) {
    const std::size_t rate = models.front().spec().shared_rate();
    RateEquation out{.own = std::vector<CurvePoint>(at.size()),
                     .by_rate = std::vector<CurvePoint>(at.size())};
    for (std::size_t c = 0; c < at.size(); ++c) {
        const CurvePoint& by_all = informations[c][rate];
        CurveMask own = free[c];
        own[rate] = false;
        const DampedStep step(models[c], at[c], gradients[c], informations[c], own, damping);
        out.own[c] = step.move;
        out.by_rate[c] = times(step.inverse, by_all);
        out.slope += gradients[c][rate] - dot(by_all, out.own[c]);
        out.bend += step.information[rate][rate] - dot(by_all, out.by_rate[c]);
    }
    return out;
}

double sum_derivatives(std::span<const CurveModel> models,
                       const std::vector<CurvePoint>& at,
                       std::vector<CurvePoint>& gradients,
                       std::vector<CurveMatrix>& informations) {
    double sum = 0.0;
    for (std::size_t c = 0; c < at.size(); ++c) {
        sum += models[c].derivatives(at[c], gradients[c], informations[c]);
    }
    return sum;
}

/// climb() of all together: what is each curve's own is eliminated, which leaves one equation for
/// the rate.
/// @param free  of each curve, the rate not looked at
Joint climb_together(std::span<const CurveModel> models,
                     std::vector<CurvePoint> start,
                     std::span<const CurveMask> free,
                     double tolerance) {
    const std::size_t n = models.size();
    const std::size_t rate = models.front().spec().shared_rate();
    const double max = models.front().high()[rate];
    std::vector<CurvePoint> gradients(n);
    std::vector<CurveMatrix> informations(n);
    Joint best{.at = std::move(start)};
    best.value = sum_derivatives(models, best.at, gradients, informations);
    double damping = 0.0;
    for (int step = 0; step < 200; ++step) {
        const auto [own, by_rate, slope, bend] =
            without_own(models, best.at, gradients, informations, free, damping);
        const double now = best.at.front()[rate];
        const bool held = (now <= 0.0 && slope <= 0.0) || (now >= max && slope >= 0.0);
        const double move = held || !(bend > 0.0) ? 0.0 : slope / bend;
        const double next_rate = std::clamp(now + move, 0.0, max);
        double gain = move * slope;
        Joint next{.at = best.at};
        for (std::size_t c = 0; c < n; ++c) {
            for (std::size_t i = 0; i < kCurveParameters; ++i) {
                const double by = own[c][i] - move * by_rate[c][i];
                gain += own[c][i] * gradients[c][i];
                if (i != rate && free[c][i]) {
                    next.at[c][i] =
                        std::clamp(best.at[c][i] + by, models[c].low()[i], models[c].high()[i]);
                }
            }
            next.at[c][rate] = next_rate;
        }
        const auto kept_gradients = gradients;
        const auto kept_informations = informations;
        next.value = sum_derivatives(models, next.at, gradients, informations);
        if (next.value > best.value) {
            const double gained = next.value - best.value;
            best = std::move(next);
            const bool whole = damping == 0.0;
            damping = damping < 1e-3 ? 0.0 : 0.1 * damping;
            if (whole && gained < tolerance) {
                break;
            }
        } else {
            gradients = kept_gradients;
            informations = kept_informations;
            if (damping > 1e10 || !(gain > 0.0) || (damping == 0.0 && gain < tolerance)) {
                break;
            }
            damping = damping == 0.0 ? 1e-3 : 10.0 * damping;
        }
    }
    for (std::size_t c = 0; c < n; ++c) {
        best.at[c] = models[c].whole(best.at[c]);
    }
    return best;
}

std::vector<CurveModel> all_alone(std::span<const CurveModel> models) {
    std::vector<CurveModel> all;
    for (const CurveModel& one : models) {
        all.push_back(alone(one, all.empty()));
    }
    return all;
}

std::vector<CurveMask> masks_of(std::span<const CurveModel> models) {
    std::vector<CurveMask> all(models.size());
    std::ranges::transform(models, all.begin(), &CurveModel::free);
    return all;
}

/// What the bootstrap draws from: free rates that no prior holds are pulled off their ends.
std::vector<CurvePoint> drawn_from(const CurveSpec& spec,
                                   std::span<const CurveModel> drawn,
                                   std::vector<CurvePoint> from,
                                   std::span<const CurveMask> free) {
    constexpr Prior kWeak{2.0, 20.0};  // as of bootstrap()
    constexpr double kNearItsMode = 0.05;
    const bool lapses = spec.lapse_free && !spec.lapse_prior;
    const bool guesses = spec.guess_free && !spec.two_sided && !spec.guess_prior;
    if (!lapses && !guesses) {
        return from;
    }
    std::vector<CurveModel> held(drawn.begin(), drawn.end());
    for (std::size_t c = 0; c < held.size(); ++c) {  // the shared rate is believed in once
        const CurveSpec& own = drawn[c].spec();
        held[c].set_rate_priors(guesses && (c == 0 || !spec.guess_shared) ? kWeak : own.guess_prior,
                                lapses && (c == 0 || !spec.lapse_shared) ? kWeak : own.lapse_prior);
        from[c][2] = guesses ? std::max(from[c][2], kNearItsMode) : from[c][2];
        from[c][3] = lapses ? kNearItsMode : from[c][3];
    }
    return climb_together(held, from, free, 1e-12).at;
}

}  // namespace

SharedRate::At SharedRate::at(double rate) const {
    const double least = protocols::exponential(places_.front());
    if (rate <= least) {  // a straight line of the rate itself
        const double slope = slopes_.front() / least;
        return {values_.front() + slope * (rate - least), slope, 0.0};
    }
    const double u = engine::natural_log(rate);
    const auto above = std::ranges::upper_bound(places_, u);
    const auto i = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(
        above - places_.begin(), 1, static_cast<std::ptrdiff_t>(places_.size()) - 1));
    const double h = places_[i] - places_[i - 1];
    const double t = (u - places_[i - 1]) / h;
    const double rise = values_[i] - values_[i - 1];
    const double a = h * slopes_[i - 1] - rise;
    const double b = rise - h * slopes_[i];
    const double value = values_[i - 1] + t * (rise + (1.0 - t) * ((1.0 - t) * a + t * b));
    const double by_t = rise + (1.0 - 2.0 * t) * ((1.0 - t) * a + t * b) + t * (1.0 - t) * (b - a);
    const double by_tt = -2.0 * ((1.0 - t) * a + t * b) + 2.0 * (1.0 - 2.0 * t) * (b - a);
    const double slope = by_t / h;
    return {value, slope / rate, (by_tt / (h * h) - slope) / (rate * rate)};
}

void share_rate(std::span<CurveModel> models) {
    const std::vector<double> places = log_rates(models.front().spec().shared_rate());
    std::vector<std::vector<RatePoint>> kept;
    for (const CurveModel& one : models) {
        kept.push_back(highest_by_rate(alone(one, false), places));
    }
    for (std::size_t c = 0; c < models.size() && models.size() > 1; ++c) {
        auto others = std::make_shared<SharedRate>(places);
        for (std::size_t o = 0; o < models.size(); ++o) {
            for (std::size_t i = 0; o != c && i < places.size(); ++i) {
                others->add(i, kept[o][i].value, kept[o][i].slope);
            }
        }
        models[c].share(std::move(others));
    }
}

std::vector<Bootstrap> shared_bootstrap(std::span<const CurveModel> models,
                                        std::span<const CurveFit> fits,
                                        std::size_t samples,
                                        std::uint64_t seed,
                                        std::span<const std::uint64_t> streams) {
    std::vector<CurveModel> drawn = all_alone(models);
    const std::vector<CurveMask> free = masks_of(models);
    std::vector<CurvePoint> from(fits.size());
    std::ranges::transform(fits, from.begin(), &CurveFit::at);
    from = drawn_from(models.front().spec(), drawn, std::move(from), free);
    const std::size_t n = models.size();
    std::vector<Bootstrap> all(n);
    std::vector<std::vector<Binomial>> levels(n);
    std::vector<Pcg32> random;
    std::vector<std::size_t> worse(n, 1);
    std::vector<double> values;
    for (std::size_t c = 0; c < n; ++c) {
        all[c].from = from[c];
        values.resize(models[c].levels());
        drawn[c].chances(from[c], values);
        for (std::size_t i = 0; i < values.size(); ++i) {
            levels[c].emplace_back(models[c].counts()[i], values[i]);
        }
        random.emplace_back(seed, streams[c]);
    }
    for (std::size_t s = 0; s < samples; ++s) {
        for (std::size_t c = 0; c < n; ++c) {
            values.resize(levels[c].size());
            for (std::size_t i = 0; i < values.size(); ++i) {
                values[i] = levels[c][i].draw(random[c]);
            }
            drawn[c].set_hits(values);
        }
        const Joint found = climb_together(drawn, from, free, 1e-7);
        for (std::size_t c = 0; c < n; ++c) {
            const End end = end_of(drawn[c], found.at[c]);
            all[c].at.push_back(found.at[c]);
            all[c].ends.push_back(end);
            all[c].steep += end == End::steep ? std::size_t{1} : 0;
            all[c].far += end == End::far_up || end == End::far_down ? std::size_t{1} : 0;
            worse[c] += drawn[c].deviance(found.at[c]) >= fits[c].deviance * (1.0 - 1e-9)
                          ? std::size_t{1}
                          : 0;
        }
    }
    for (std::size_t c = 0; c < n; ++c) {
        all[c].deviance_p = static_cast<double>(worse[c]) / static_cast<double>(samples + 1);
    }
    return all;
}

double shared_equality_p(std::span<const CurveModel> models,
                         std::size_t one,
                         const CurveFit& fit_one,
                         std::size_t two,
                         const CurveFit& fit_two,
                         Quantity quantity) {
    const CurveSpec& spec = models.front().spec();
    const bool tied = quantity == Quantity::jnd && spec.family == protocols::Family::weibull;
    const std::size_t i = tied || quantity == Quantity::threshold ? 0 : 1;
    std::vector<CurveModel> plain = all_alone(models);
    std::vector<CurveMask> free = masks_of(models);
    std::vector<CurvePoint> near;
    for (std::size_t c = 0; c < models.size(); ++c) {
        CurvePoint middle = models[c].middle();
        middle[spec.shared_rate()] = fit_one.at[spec.shared_rate()];
        near.push_back(c == one ? fit_one.at
                       : c == two
                           ? fit_two.at
                           : highest(models[c], middle, models[c].free(), Search::quick).best.at);
    }
    const Joint best = climb_together(plain, near, free, 1e-12);
    free[one][i] = free[two][i] = false;
    const auto loss = [&](double place) {
        std::vector<CurvePoint> start = best.at;
        for (const std::size_t c : {one, two}) {
            if (tied) {
                plain[c].tie({.kind = Tie::Kind::jnd, .value = place});
                start[c][1] = plain[c].log_slope_at(start[c][0]);
            } else {
                start[c][i] = place;
            }
        }
        return best.value - climb_together(plain, start, free, 1e-10).value;
    };
    const auto place_of = [&](std::size_t c) {
        return tied ? engine::natural_log(quantity_of(spec, best.at[c], quantity)) : best.at[c][i];
    };
    const double chi_square =
        2.0 * std::max(0.0, least_between(loss, place_of(one), place_of(two)));
    return 2.0 * protocols::normal_cdf(-std::sqrt(chi_square));
}

}  // namespace palpate::data

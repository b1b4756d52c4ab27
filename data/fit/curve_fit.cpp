#include "data/fit/curve_fit.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "engine/math/elementary.hpp"
#include "protocols/psychometric/exact_math.hpp"
#include "data/statistics/solve.hpp"

namespace palpate::data {
namespace {

using engine::natural_log;
using protocols::exponential;
using protocols::Family;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();
constexpr double kReach = 1.959963984540054;  ///< sqrt of the 95 % point of chi-square with 1 df

/// Which parameter or tie of the model holds the quantity, and the quantity at a place of it.
struct FixedParameter {
    std::size_t parameter = 0;
    Tie tie{};
    double at = 0.0;
    double low = -kInfinity;
    double high = kInfinity;
    double step = 1.0;
    std::function<double(double)> quantity{};
};

FixedParameter parameter_held(const CurveModel& model,
                              const CurveFit& fit,
                              std::size_t i,
                              std::function<double(double)> value) {
    const double se = std::sqrt(fit.covariance[i][i]);
    const double plain = i == 0 ? 0.1 * (model.last() - model.first()) : i == 1 ? 0.5 : 0.02;
    return {.parameter = i,
            .at = fit.at[i],
            .low = model.low()[i],
            .high = model.high()[i],
            .step = se > 0.0 && std::isfinite(se) ? std::min(2.0 * se, 20.0 * plain) : plain,
            .quantity = std::move(value)};
}

std::optional<FixedParameter> held(const CurveModel& model,
                                   const CurveFit& fit,
                                   Quantity quantity,
                                   double share) {
    const CurveSpec& spec = model.spec();
    const Family family = spec.family;
    const auto of_parameter = [&](std::size_t i, std::function<double(double)> value) {
        return parameter_held(model, fit, i, std::move(value));
    };
    const auto of_slope = [&] {
        return of_parameter(1, [family, quantity](double log_slope) {
            return quantity_of({.family = family}, {0.0, log_slope, 0.0, 0.0}, quantity);
        });
    };
    const auto of_tie = [&](Tie tie, std::function<double(double)> value) {
        return FixedParameter{
            .tie = tie, .at = tie.value, .step = 0.3, .quantity = std::move(value)};
    };
    const double value = quantity_of(spec, fit.at, quantity, share);
    if (!std::isfinite(value)) {
        return std::nullopt;
    }
    switch (quantity) {
        case Quantity::threshold:
            return of_parameter(0, [family](double z) { return off_axis(family, z); });
        case Quantity::slope:
            return of_slope();
        case Quantity::jnd:
            return family == Family::weibull
                     ? of_tie({.kind = Tie::Kind::jnd, .value = natural_log(value)}, exponential)
                     : of_slope();
        case Quantity::weber:
            if (family == Family::weibull) {
                return of_slope();
            }
            return of_tie({.kind = Tie::Kind::weber, .value = natural_log(value)}, exponential);
        case Quantity::guess:
        case Quantity::lapse: {
            const std::size_t i = quantity == Quantity::lapse || spec.two_sided ? 3 : 2;
            return model.free()[i]
                     ? std::optional(of_parameter(i, [](double rate) { return rate; }))
                     : std::nullopt;
        }
        case Quantity::at_share: {
            if (model.free()[2] || model.free()[3]) {
                return std::nullopt;
            }
            FixedParameter one =
                of_tie({.kind = Tie::Kind::share,
                        .value = on_axis(family, value),
                        .share = (share - fit.at[2]) / (1.0 - fit.at[2] - fit.at[3])},
                       [family](double z) { return off_axis(family, z); });
            one.step = 0.1 * (model.last() - model.first());
            one.low = model.low()[0];
            one.high = model.high()[0];
            return one;
        }
    }
    return std::nullopt;
}

/// The loss of log-likelihood where a quantity is held: the best of the searches from where the
/// last one ended and from a grid.
class Profile {
public:
    Profile(CurveModel model, const CurveFit& fit, const FixedParameter& held)
        : model_(std::move(model)), fit_(&fit), held_(held), near_(fit.at) {}

    void restart() { near_ = fit_->at; }

    double value(double place) {
        CurveMask free;
        if (held_.tie.kind == Tie::Kind::none) {
            free = model_.free();
            free[held_.parameter] = false;
            near_[held_.parameter] = place;
        } else {
            Tie tie = held_.tie;
            tie.value = place;
            model_.tie(tie);
            free = model_.free();
            if (tie.kind != Tie::Kind::share) {  // the location stays, not the slope
                near_[1] = model_.log_slope_at(near_[0]);
            }
        }
        const bool rate = held_.tie.kind == Tie::Kind::none && held_.parameter >= 2;
        const Search search = rate ? Search::quick : Search::thorough;
        const Optimum found = highest(model_, near_, free, search, 1e-10).best;
        near_ = model_.whole(found.at);
        return found.value;
    }

    /// The signed root of the deviance against the maximum, which is nearly a straight line.
    double root(double place) { return std::sqrt(2.0 * std::max(0.0, fit_->value - value(place))); }

    /// The place on one side where the root is kReach; nothing if it is not reached at the end.
    std::optional<double> edge(double step, double end) {
        restart();
        if (std::isfinite(end) && root(end) < kReach) {
            return std::nullopt;
        }
        restart();
        Reading near{held_.at, 0.0};
        Reading far = near;
        for (int i = 0; i < 60 && far.value < kReach; ++i) {
            if (far.at == end) {
                return std::nullopt;
            }
            near = far;
            far.at = i == 0 ? far.at + step
                            : held_.at + (far.at - held_.at) *
                                             std::clamp(1.1 * kReach / far.value, 1.3, 3.0);
            far.at = step > 0.0 ? std::min(far.at, end) : std::max(far.at, end);
            far.value = root(far.at);
        }
        if (far.value < kReach) {
            return std::nullopt;
        }
        return crossing([this](double place) { return root(place); }, kReach, near, far, 1e-7);
    }

private:
    CurveModel model_;
    const CurveFit* fit_;
    FixedParameter held_;
    CurvePoint near_;
};

/// Curves whose slope has no end.
class Steps {
public:
    /// @param at  with the rates of these
    Steps(const CurveModel& model, const CurvePoint& at)
        : model_(&model), guess_(at[2]), top_(1.0 - at[3]) {}

    /// The log-likelihood of the best step there.
    [[nodiscard]] double value(double place) const {
        double sum = 0.0;
        for (std::size_t i = 0; i < model_->levels(); ++i) {
            const double z = model_->places()[i];
            const double n = model_->counts()[i];
            const double k = model_->hits()[i];
            const double p = z < place ? guess_
                           : z > place ? top_
                                       : std::clamp(k / n, std::min(guess_, top_), top_);
            sum += (k > 0.0 ? k * std::log(p) : 0.0) + (n > k ? (n - k) * std::log1p(-p) : 0.0);
        }
        return sum;
    }

    /// The hull of all places that lose no more than `loss` against the best, and the best; only
    /// levels and the gaps between them differ.
    [[nodiscard]] std::pair<Interval, double> within(double loss) const {
        const auto z = model_->places();
        double best = -kInfinity;
        for (const double place : z) {  // on a level a step can be as in the gaps beside it
            best = std::max(best, value(place));
        }
        Interval hull{kInfinity, -kInfinity};
        const auto take = [&](double inside, double low, double high) {
            if (value(inside) >= best - loss) {
                hull = {std::min(hull.low, low), std::max(hull.high, high)};
            }
        };
        for (std::size_t i = 0; i < z.size(); ++i) {
            take(z[i], z[i], z[i]);
            if (i + 1 < z.size() && std::isfinite(z[i])) {
                take(0.5 * (z[i] + z[i + 1]), z[i], z[i + 1]);
            }
        }
        return {hull, best};
    }

private:
    const CurveModel* model_;
    double guess_;
    double top_;
};

constexpr double kSame = 1e-7;  ///< of log-likelihood

/// The least loss of one threshold for both on a level of either, where a curve may be a step.
double least_of_steps(const CurveModel& one,
                      const CurveFit& fit_one,
                      Profile& left,
                      const CurveModel& two,
                      const CurveFit& fit_two,
                      Profile& right) {
    const auto loss = [](const CurveModel& model, const CurveFit& fit, Profile& profile,
                         double place) {
        return fit.value - (fit.maxima
                                ? std::max(profile.value(place), Steps(model, fit.at).value(place))
                                : profile.value(place));
    };
    const auto hull = [](const CurveFit& fit) {
        return fit.maxima.value_or(Interval{fit.at[0], fit.at[0]});
    };
    const double low = std::min(hull(fit_one).low, hull(fit_two).low);
    const double high = std::max(hull(fit_one).high, hull(fit_two).high);
    double least = kInfinity;
    for (const CurveModel* model : {&one, &two}) {
        for (const double place : model->places()) {
            if (place >= low && place <= high && std::isfinite(place)) {
                least = std::min(least, std::max(0.0, loss(one, fit_one, left, place)) +
                                            std::max(0.0, loss(two, fit_two, right, place)));
            }
        }
    }
    return least;
}

/// The best with the steepest slope.
Optimum steepest(const CurveModel& model, CurvePoint near) {
    CurveMask others = model.free();
    others[1] = false;
    near[1] = model.high()[1];
    return highest(model, near, others, Search::thorough, 1e-10).best;
}

}  // namespace

Checked checked_by_simplex(const CurveModel& model, const Highest& found) {
    const CurveMask free = model.free();
    const Optimum second = nelder_mead(model, found.start, free);
    Checked made{found.best, second.value, std::fabs(second.value - found.best.value) < 1e-6};
    if (second.value > found.best.value) {
        const Optimum again = climb(model, second.at, free);
        made.best = again.value > second.value ? again : second;
    }
    return made;
}

CurveFit fit_curve(const CurveModel& model) {
    const CurveSpec& spec = model.spec();
    const CurveMask free = model.free();
    const Highest found = highest(model, model.middle(), free, Search::thorough);
    const Checked checked = checked_by_simplex(model, found);
    const Optimum& best = checked.best;
    CurveFit fit{.second = checked.second, .agree = checked.agree};
    CurvePoint gradient;
    CurveMatrix information;
    fit.value = model.derivatives(best.at, gradient, information);
    CurveMask inner = free;
    for (std::size_t i = 0; i < kCurveParameters; ++i) {
        fit.parameters += free[i] ? 1 : 0;
        inner[i] = free[i] && best.at[i] > model.low()[i] && best.at[i] < model.high()[i];
    }
    fit.covariance = inverse(information, inner);
    fit.at = model.whole(best.at);
    fit.deviance = model.deviance(fit.at);
    // A likelihood that still grows is as good as its end long before it: within 0.5 of the log of
    // the slope.
    const Optimum end = steepest(model, best.at);
    fit.steep = end.value > fit.value - kSame;
    fit.shallow = !model.spec().slope_prior && fit.deviance > model.flat_deviance() - 1e-6;
    fit.far = fit.at[0] <= model.low()[0] || fit.at[0] >= model.high()[0];
    if (fit.steep && !fit.shallow && !fit.far && !spec.map() && spec.shared_rate() == 0) {
        const auto [maxima, value] = Steps(model, model.whole(end.at)).within(kSame);
        fit.maxima = value > fit.value - kSame ? std::optional(maxima) : std::nullopt;
    }
    return fit;
}

std::optional<Interval> profile_interval(const CurveModel& model,
                                         const CurveFit& fit,
                                         Quantity quantity,
                                         double share) {
    const std::optional<FixedParameter> place = held(model, fit, quantity, share);
    if (!place) {
        return std::nullopt;
    }
    Profile profile(model, fit, *place);
    const auto down = profile.edge(-place->step, place->low);
    const auto up = profile.edge(place->step, place->high);
    const bool rate = quantity == Quantity::guess || quantity == Quantity::lapse;
    const bool positive =
        quantity == Quantity::slope || quantity == Quantity::jnd || quantity == Quantity::weber ||
        (quantity == Quantity::threshold && model.spec().family == Family::weibull);
    const bool falls = (quantity == Quantity::jnd || quantity == Quantity::weber) &&
                       place->tie.kind == Tie::Kind::none;
    const double least = rate || positive ? 0.0 : -kInfinity;
    const double max = rate ? place->high : kInfinity;
    // Where a slope without end is not refuted, no JND is too small, though the model's slopes have
    // an end.
    bool endless = false;
    if (place->tie.kind == Tie::Kind::jnd || place->tie.kind == Tie::Kind::weber) {
        const Optimum end = steepest(model, fit.at);
        endless = 2.0 * (fit.value - end.value) < kReach * kReach &&
                  (place->tie.kind == Tie::Kind::jnd || end.at[0] > 0.0);
    }
    const double at_down = endless ? least : down ? place->quantity(*down) : falls ? max : least;
    // Where a threshold of 0 is not refuted, no Weber fraction is too large.
    bool through_zero = false;
    if (place->tie.kind == Tie::Kind::weber) {
        CurveMask others = model.free();
        others[0] = false;
        CurvePoint near = fit.at;
        near[0] = 0.0;
        const Optimum zero = highest(model, near, others, Search::thorough, 1e-10).best;
        through_zero = 2.0 * (fit.value - zero.value) < kReach * kReach;
    }
    const double at_up = through_zero ? max : up ? place->quantity(*up) : falls ? least : max;
    Interval found{std::min(at_down, at_up), std::max(at_down, at_up)};
    if (fit.maxima && (quantity == Quantity::threshold || quantity == Quantity::at_share)) {
        // The slopes that are searched have an end, and their curves end beside the steps.
        const Interval steps = Steps(model, fit.at).within(0.5 * kReach * kReach).first;
        found.low = std::min(found.low, place->quantity(steps.low));
        found.high = std::max(found.high, place->quantity(steps.high));
    }
    return found;
}

double equality_p(const CurveModel& one,
                  const CurveFit& fit_one,
                  const CurveModel& two,
                  const CurveFit& fit_two,
                  Quantity quantity) {
    const auto first = held(one, fit_one, quantity, 0.5);
    const auto second = held(two, fit_two, quantity, 0.5);
    if (!first || !second) {
        return kNoNumber;
    }
    Profile left(one, fit_one, *first);
    Profile right(two, fit_two, *second);
    const auto loss = [&](double place) {
        return fit_one.value - left.value(place) + fit_two.value - right.value(place);
    };
    double least = least_between(loss, first->at, second->at);
    if (quantity == Quantity::threshold && (fit_one.maxima || fit_two.maxima)) {
        least = std::min(least, least_of_steps(one, fit_one, left, two, fit_two, right));
    }
    const double chi_square = 2.0 * std::max(0.0, least);
    return 2.0 * protocols::normal_cdf(-std::sqrt(chi_square));
}

}  // namespace palpate::data

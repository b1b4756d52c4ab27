#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "engine/math/elementary.hpp"
#include "protocols/psychometric/exact_math.hpp"
#include "data/fit/curve_fit.hpp"

namespace palpate::data {
namespace {

using engine::natural_log;
using protocols::exponential;
using protocols::Family;

constexpr double kInverseSqrtTwoPi = 0.398942280401432677939946059934381868;
constexpr double kInverseSqrtTwo = 0.707106781186547524400844362104849039;
constexpr double kTiny = 1e-300;
/// How far outside the levels a threshold is looked for, in their range, and how steep a slope:
/// beyond 60 / gap no share between two levels changes by 1e-12 any more.
constexpr double kBeyond = 20.0;
constexpr double kSteepest = 60.0;
constexpr double kShallowest = 0.002;
/// Of stimuli and the reciprocals of their gaps: the squares of slopes and ranges stay finite.
constexpr double kLargest = 1e100;

bool gumbel_like(Family family) {
    return family != Family::normal && family != Family::logistic;
}

/// k ln p, which is 0 for k = 0.
double term(double k, double p) {
    return k > 0.0 ? k * natural_log(std::max(p, kTiny)) : 0.0;
}

}  // namespace

void check(const CurveSpec& spec) {
    const auto rate = [](const char* what, double value, double max) {
        refuse_if(!(value >= 0.0 && value <= max),
                  "the {} is {}: give a share from 0 to {}, or free", what, value, max);
    };
    rate("guess rate", spec.guess, kMaxGuess);
    rate("lapse rate", spec.lapse, kMaxLapse);
    const auto prior = [](const char* what, const std::optional<Prior>& one, bool beta) {
        const auto [first, second] = one.value_or(Prior{1.0, 1.0});
        refuse_if(!(std::isfinite(first) && std::isfinite(second) && second > 0.0),
                  "the prior of the {} is {}, {}: give finite numbers, the second above 0", what,
                  first, second);
        refuse_if(beta && !(first >= 1.0 && second >= 1.0),
                  "the prior of the {} is beta({}, {}): give two numbers from 1, so that its "
                  "density is finite",
                  what, first, second);
    };
    prior("threshold", spec.threshold_prior, false);
    prior("slope", spec.slope_prior, false);
    prior("guess rate", spec.guess_prior, true);
    prior("lapse rate", spec.lapse_prior, true);
    const double slope = spec.slope_prior.value_or(Prior{1.0}).first;
    refuse_if(!(slope > 0.0), "the prior median of the slope is {}: give one above 0", slope);
    const double threshold = spec.threshold_prior.value_or(Prior{1.0}).first;
    refuse_if(spec.family == Family::weibull && !(threshold > 0.0),
              "the prior median of a Weibull's threshold is {}: give one above 0", threshold);
}

CoreValue core_value(Family family, double u) noexcept {
    if (family == Family::normal) {
        // A fifth of the time of protocols::normal_cdf, which is the same to the bit everywhere.
        const double tail = 0.5 * std::erfc(kInverseSqrtTwo * std::fabs(u));
        const double density = kInverseSqrtTwoPi * exponential(-0.5 * u * u);
        return u < 0.0 ? CoreValue{tail, 1.0 - tail, density}
                       : CoreValue{1.0 - tail, tail, density};
    }
    if (family == Family::logistic) {
        const double e = exponential(-std::fabs(u));
        const double tail = e / (1.0 + e);
        const double rest = 1.0 / (1.0 + e);
        return u < 0.0 ? CoreValue{tail, rest, tail * rest} : CoreValue{rest, tail, tail * rest};
    }
    const double e = exponential(std::min(u, 700.0));
    const double above = exponential(-e);
    const double below = e < 1e-5 ? e * (1.0 - e * (0.5 - e / 6.0)) : 1.0 - above;
    return {below, above, e * above};
}

double core_quantile(Family family, double share) noexcept {
    const Family plain = gumbel_like(family) ? Family::gumbel : family;
    return protocols::core_inverse(plain, share, 0.0, 1.0);
}

double on_axis(Family family, double stimulus) noexcept {
    if (family != Family::weibull) {
        return stimulus;
    }
    return stimulus > 0.0 ? natural_log(stimulus) : -std::numeric_limits<double>::infinity();
}

double off_axis(Family family, double location) noexcept {
    return family == Family::weibull ? exponential(location) : location;
}

double slope_factor(Family family) noexcept {
    return family == Family::weibull_log10 ? protocols::kLn10
         : family == Family::weibull_db    ? protocols::kLn10 / 20.0
                                           : 1.0;
}

std::string stimulus_fault(double stimulus, Family family) {
    if (!std::isfinite(stimulus) || (family == Family::weibull && stimulus < 0.0)) {
        return family == Family::weibull
                 ? "give finite numbers from 0, or another function: a Weibull begins at 0"
                 : "give finite numbers";
    }
    return std::fabs(stimulus) > kLargest
             ? fmt::format("give stimuli up to {}, in a larger unit", kLargest)
             : "";
}

CurveModel::CurveModel(std::span<const Level> levels, const CurveSpec& spec)
    : spec_(spec),
      half_(core_quantile(spec.family, 0.5)),
      upper_(core_quantile(spec.family, 0.75) - half_),
      lower_(core_quantile(spec.family, 0.25) - half_) {
    check(spec);
    std::map<double, std::pair<double, double>> merged;
    for (const Level& level : levels) {
        if (const std::string fault = stimulus_fault(level.stimulus, spec.family); !fault.empty()) {
            throw std::invalid_argument(fmt::format("a stimulus is {}: {}", level.stimulus, fault));
        }
        refuse_if(level.k < 0 || level.k > level.n, "k is {} of n = {}: give a k from 0 to n",
                  level.k, level.n);
        if (level.n > 0) {
            auto& [n, k] = merged[on_axis(spec.family, level.stimulus)];
            n += static_cast<double>(level.n);
            k += static_cast<double>(level.k);
        }
    }
    double gap = std::numeric_limits<double>::infinity();
    for (const auto& [z, nk] : merged) {
        if (!z_.empty() && std::isfinite(z_.back())) {
            gap = std::min(gap, z - z_.back());
        }
        z_.push_back(z);
        n_.push_back(nk.first);
        k_.push_back(nk.second);
    }
    refuse_if(!std::isfinite(gap), "there {} with answers: it takes two different ones or more{}",
              z_.size() == 1 ? "is one stimulus"
              : z_.empty()   ? "is no stimulus"
                             : "are too few stimuli",
              spec.family == Family::weibull ? " above 0" : "");
    refuse_if(gap < 1.0 / kLargest,
              "two stimuli are {} apart: give stimuli further apart than {}, in a smaller unit",
              gap, 1.0 / kLargest);
    first_ = std::isfinite(z_.front()) ? z_.front() : z_[1];
    last_ = z_.back();
    const double range = last_ - first_;
    low_ = {first_ - kBeyond * range, natural_log(kShallowest / range), 0.0, 0.0};
    high_ = {last_ + kBeyond * range, natural_log(kSteepest / gap), kMaxGuess, kMaxLapse};
}

void CurveModel::tie(const Tie& tie) {
    tie_ = tie;
    shared_ = tie.kind == Tie::Kind::share ? core_quantile(spec_.family, tie.share) - half_ : 0.0;
}

CurveMask CurveModel::free() const {
    return {tie_.kind == Tie::Kind::none, true, spec_.guess_free && !spec_.two_sided,
            spec_.lapse_free};
}

Tied CurveModel::tied(const CurvePoint& point) const {
    const double b = exponential(point[1]);
    switch (tie_.kind) {
        case Tie::Kind::none:
            return {point[0], 0.0};
        case Tie::Kind::jnd: {  // of a weibull: e^location (e^(upper / b) - e^(lower / b)) / 2
            const double up = exponential(upper_ / b);
            const double down = exponential(lower_ / b);
            return {tie_.value - natural_log(0.5 * (up - down)),
                    (upper_ * up - lower_ * down) / b / (up - down)};
        }
        case Tie::Kind::weber: {  // of all others: (upper - lower) / (2 b location)
            const double location = 0.5 * (upper_ - lower_) / b * exponential(-tie_.value);
            return {location, -location};
        }
        case Tie::Kind::share: {
            const double away = shared_ / b;
            return {tie_.value - away, away};
        }
    }
    return {};
}

double CurveModel::log_slope_at(double location) const {
    double low = low_[1];
    double high = high_[1];
    const bool falls = tie_.kind == Tie::Kind::weber;
    while (high - low > 1e-6) {
        const double middle = 0.5 * (low + high);
        const bool beyond = (tied({0.0, middle, 0.0, 0.0}).location > location) != falls;
        (beyond ? high : low) = middle;
    }
    return 0.5 * (low + high);
}

CurvePoint CurveModel::middle() const {
    return {0.5 * (first_ + last_), natural_log(2.0 / (last_ - first_)), spec_.guess, spec_.lapse};
}

CurvePoint CurveModel::whole(CurvePoint point) const {
    point[0] = tied(point).location;
    point[2] = spec_.two_sided ? point[3] : point[2];
    return point;
}

void CurveModel::chances(const CurvePoint& point, std::span<double> p) const {
    const CurvePoint at = whole(point);
    const double b = exponential(at[1]);
    for (std::size_t i = 0; i < z_.size(); ++i) {
        const CoreValue core = core_value(spec_.family, b * (z_[i] - at[0]) + half_);
        p[i] = at[2] + (1.0 - at[2] - at[3]) * core.below;
    }
}

double CurveModel::prior(const CurvePoint& point,
                         CurvePoint* gradient,
                         CurveMatrix* information) const {
    double sum = 0.0;
    const auto normal = [&](std::size_t i, double mean, double sd) {
        const double away = (point[i] - mean) / sd;
        sum -= 0.5 * away * away;
        if (gradient != nullptr) {
            (*gradient)[i] -= away / sd;
            (*information)[i][i] += 1.0 / (sd * sd);
        }
    };
    const auto beta = [&](std::size_t i, const Prior& prior) {
        const double rate = std::max(point[i], 1e-12);
        sum += (prior.first - 1.0) * natural_log(rate) +
               (prior.second - 1.0) * natural_log(1.0 - point[i]);
        if (gradient != nullptr) {
            (*gradient)[i] += (prior.first - 1.0) / rate - (prior.second - 1.0) / (1.0 - point[i]);
            (*information)[i][i] += (prior.first - 1.0) / (rate * rate) +
                                    (prior.second - 1.0) / ((1.0 - point[i]) * (1.0 - point[i]));
        }
    };
    if (spec_.threshold_prior) {
        normal(0, on_axis(spec_.family, spec_.threshold_prior->first),
               spec_.threshold_prior->second);
    }
    if (spec_.slope_prior) {
        normal(1, natural_log(spec_.slope_prior->first * slope_factor(spec_.family)),
               spec_.slope_prior->second);
    }
    if (spec_.guess_prior && spec_.guess_free) {
        beta(2, *spec_.guess_prior);
    }
    if (spec_.lapse_prior && spec_.lapse_free) {
        beta(3, *spec_.lapse_prior);
    }
    if (others_) {
        const std::size_t rate = spec_.shared_rate();
        const SharedRate::At others = others_->at(point[rate]);
        sum += others.value;
        if (gradient != nullptr) {
            (*gradient)[rate] += others.slope;
            (*information)[rate][rate] += std::max(-others.curvature, 0.0);
        }
    }
    return sum;
}

double CurveModel::value(const CurvePoint& point) const {
    const CurvePoint at = whole(point);
    const double b = exponential(at[1]);
    const double width = 1.0 - at[2] - at[3];
    double sum = prior(at, nullptr, nullptr);
    for (std::size_t i = 0; i < z_.size(); ++i) {
        const CoreValue core = core_value(spec_.family, b * (z_[i] - at[0]) + half_);
        sum += term(k_[i], at[2] + width * core.below) +
               term(n_[i] - k_[i], at[3] + width * core.above);
    }
    return sum;
}

double CurveModel::derivatives(const CurvePoint& point,
                               CurvePoint& gradient,
                               CurveMatrix& information) const {
    const Tied tie = tied(point);
    const CurvePoint at = whole(point);
    const double b = exponential(at[1]);
    const double width = 1.0 - at[2] - at[3];
    gradient = {};
    information = {};
    double sum = prior(at, &gradient, &information);
    for (std::size_t i = 0; i < z_.size(); ++i) {
        const bool at_zero = !std::isfinite(z_[i]);
        const double away = at_zero ? 0.0 : z_[i] - at[0];
        const CoreValue core = at_zero ? CoreValue{} : core_value(spec_.family, b * away + half_);
        const double p = std::max(at[2] + width * core.below, kTiny);
        const double q = std::max(at[3] + width * core.above, kTiny);
        sum += term(k_[i], p) + term(n_[i] - k_[i], q);
        const double steep = width * core.density;
        CurvePoint by{-b * steep, b * away * steep, core.above, -core.below};
        if (spec_.two_sided) {
            by[3] += by[2];
            by[2] = 0.0;
        }
        const double score = k_[i] / p - (n_[i] - k_[i]) / q;
        // Where the chance is 0 or 1 to the last bit, n / (p q) knows nothing.
        const double weight = std::min(n_[i] / (p * q), 1e200);
        for (std::size_t r = 0; r < kCurveParameters; ++r) {
            gradient[r] += score * by[r];
            for (std::size_t c = 0; c <= r; ++c) {
                information[r][c] += weight * by[r] * by[c];
            }
        }
    }
    for (std::size_t r = 0; r < kCurveParameters; ++r) {
        for (std::size_t c = 0; c < r; ++c) {
            information[c][r] = information[r][c];
        }
    }
    if (tie_.kind != Tie::Kind::none) {  // the location moves with the slope
        const double t = tie.by_log_slope;
        gradient[1] += t * gradient[0];
        information[1][1] += 2.0 * t * information[0][1] + t * t * information[0][0];
        for (const std::size_t c : {2U, 3U}) {
            information[1][c] += t * information[0][c];
            information[c][1] = information[1][c];
        }
    }
    return sum;
}

double CurveModel::saturated() const {
    double sum = 0.0;
    for (std::size_t i = 0; i < z_.size(); ++i) {
        const double share = k_[i] / n_[i];
        sum += term(k_[i], share) + term(n_[i] - k_[i], 1.0 - share);
    }
    return sum;
}

double CurveModel::deviance(const CurvePoint& point) const {
    const double likelihood = value(point) - prior(whole(point), nullptr, nullptr);
    return std::max(0.0, 2.0 * (saturated() - likelihood));
}

double CurveModel::flat_deviance() const {
    double n = 0.0;
    double k = 0.0;
    for (std::size_t i = 0; i < z_.size(); ++i) {
        n += n_[i];
        k += k_[i];
    }
    const double least = spec_.two_sided  ? (spec_.lapse_free ? 0.0 : spec_.lapse)
                       : spec_.guess_free ? 0.0
                                          : spec_.guess;
    const double max = spec_.lapse_free ? 1.0 : 1.0 - spec_.lapse;
    const double share = std::clamp(k / n, least, max);
    return std::max(0.0, 2.0 * (saturated() - term(k, share) - term(n - k, 1.0 - share)));
}

}  // namespace palpate::data

#include "protocols/psychometric/psychometric_function.hpp"

#include <cmath>
#include <limits>

#include "engine/base/refuse.hpp"
#include "engine/math/elementary.hpp"
#include "protocols/psychometric/exact_math.hpp"

namespace palpate::protocols {
namespace {

using engine::natural_log;

constexpr double kDecibels = 20.0;  // a decade of amplitude
constexpr double kEnd = std::numeric_limits<double>::infinity();

/// 1 - e^-u. Its series where the difference would lose digits.
double one_minus_exp(double u) noexcept {
    if (u < 1e-5) {
        return u * (1.0 - u * (0.5 - u / 6.0));
    }
    return 1.0 - exponential(-u);
}

/// -ln(1 - share), for the inverse of 1 - e^-u.
double minus_log_rest(double share) noexcept {
    if (share < 1e-5) {
        return share * (1.0 + share * (0.5 + share / 3.0));
    }
    return -natural_log(1.0 - share);
}

}  // namespace

double core(Family family, double x, double threshold, double slope) noexcept {
    switch (family) {
        case Family::weibull:
            if (x == kEnd) {
                return 1.0;
            }
            return x > 0.0 ? one_minus_exp(exponential(slope * natural_log(x / threshold))) : 0.0;
        case Family::weibull_log10:
            return one_minus_exp(power_of_ten(slope * (x - threshold)));
        case Family::weibull_db:
            return one_minus_exp(power_of_ten(slope * (x - threshold) / kDecibels));
        case Family::gumbel:
            return one_minus_exp(exponential(slope * (x - threshold)));
        case Family::normal:
            return normal_cdf(slope * (x - threshold));
        case Family::logistic:
            return 1.0 / (1.0 + exponential(-slope * (x - threshold)));
    }
    return std::numeric_limits<double>::quiet_NaN();
}

double core_inverse(Family family, double share, double threshold, double slope) noexcept {
    if (!(share >= 0.0 && share <= 1.0)) {
        return std::numeric_limits<double>::quiet_NaN();
    }
    if (share == 0.0 || share == 1.0) {
        return share == 1.0 ? kEnd : (family == Family::weibull ? 0.0 : -kEnd);
    }
    switch (family) {
        case Family::weibull:
            return threshold * exponential(natural_log(minus_log_rest(share)) / slope);
        case Family::weibull_log10:
            return threshold + natural_log(minus_log_rest(share)) / (kLn10 * slope);
        case Family::weibull_db:
            return threshold + kDecibels * natural_log(minus_log_rest(share)) / (kLn10 * slope);
        case Family::gumbel:
            return threshold + natural_log(minus_log_rest(share)) / slope;
        case Family::normal:
            return threshold + normal_quantile(share) / slope;
        case Family::logistic:
            return threshold + (natural_log(share) - natural_log(1.0 - share)) / slope;
    }
    return std::numeric_limits<double>::quiet_NaN();
}

double bottom(const PsychometricFunction& f) noexcept {
    return f.form == LapseForm::two_sided ? f.lapse : f.guess;
}

double top(const PsychometricFunction& f) noexcept {
    return f.form == LapseForm::guessing ? 1.0 - f.lapse * (1.0 - f.guess) : 1.0 - f.lapse;
}

double probability(const PsychometricFunction& f, double x) noexcept {
    const double low = bottom(f);
    const double share = core(f.family, x, f.threshold, f.slope);
    // From the nearer end, so that rounding cannot leave the range.
    const double high = top(f);
    return share < 0.5 ? low + (high - low) * share : high - (high - low) * (1.0 - share);
}

double stimulus_at(const PsychometricFunction& f, double p) {
    const double low = bottom(f);
    const double high = top(f);
    refuse_if(!(p > low && p < high),
              "the probability {} is never reached: give one above {} and below {}", p, low, high);
    return core_inverse(f.family, (p - low) / (high - low), f.threshold, f.slope);
}

void check(const PsychometricFunction& f) {
    const auto share = [](double value) {
        return value >= 0.0 && value < 1.0;
    };
    refuse_if(!std::isfinite(f.threshold) || (f.family == Family::weibull && f.threshold <= 0.0),
              "the threshold is {}: give a finite number{}", f.threshold,
              f.family == Family::weibull ? " above 0 on a linear Weibull axis" : "");
    refuse_if(!std::isfinite(f.slope) || f.slope <= 0.0,
              "the slope is {}: give a finite number above 0", f.slope);
    refuse_if(!share(f.guess) || !share(f.lapse),
              "the guess rate is {} and the lapse rate {}: give shares from 0 to below 1", f.guess,
              f.lapse);
    refuse_if(bottom(f) >= top(f),
              "lapse and guess leave nothing between {} and {}: give smaller rates", bottom(f),
              top(f));
}

}  // namespace palpate::protocols

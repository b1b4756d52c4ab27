#include "protocols/procedure/outcome_model.hpp"

#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "protocols/psychometric/exact_math.hpp"

namespace palpate::protocols {
namespace {

std::vector<std::string> parameter_names(LapseForm form, SlopeAs slope_as, bool tilted) {
    std::vector<std::string> names;
    names.reserve(5);
    names.emplace_back("threshold");
    if (tilted) {
        names.emplace_back("tilt");
    }
    names.emplace_back(kSlopeWords.at(static_cast<std::size_t>(slope_as)));
    if (form != LapseForm::two_sided) {
        names.emplace_back("guess");
    }
    names.emplace_back("lapse");
    return names;
}

OutcomeModel two_outcomes(Family family, LapseForm form, SlopeAs slope_as, bool tilted) {
    OutcomeModel model;
    model.stimulus = {"stimulus"};
    if (tilted) {
        model.stimulus.emplace_back("covariate");
    }
    model.parameters = parameter_names(form, slope_as, tilted);
    model.chances = [=](std::span<const double> x, std::span<const double> s,
                        std::span<double> chances) {
        PsychometricFunction f{.family = family, .form = form, .threshold = s[0]};
        std::size_t next = 1;
        if (tilted) {
            f.threshold += s[next++] * x[1];
        }
        f.slope = slope_of(slope_as, s[next++]);
        f.guess = form == LapseForm::two_sided ? 0.0 : s[next++];
        f.lapse = s[next];
        check(f);
        chances[1] = probability(f, x[0]);
        chances[0] = 1.0 - chances[1];
    };
    return model;
}

/// How much of a percept's distribution lies on either side of a criterion.
struct Sides {
    double below = 0.0;
    double above = 1.0;
};

Sides sides_of(double z) {
    const double tail = normal_cdf(-std::fabs(z));
    return z <= 0.0 ? Sides{tail, 1.0 - tail} : Sides{1.0 - tail, tail};
}

/// Share between two criteria, taken in the tail where the difference loses no digits.
double between(const Sides& left, const Sides& right) {
    return left.below > 0.5 ? left.above - right.above : right.below - left.below;
}

}  // namespace

double slope_of(SlopeAs as, double value) {
    switch (as) {
        case SlopeAs::slope:
            return value;
        case SlopeAs::log10_slope:
            return power_of_ten(value);
        case SlopeAs::sd:
            return 1.0 / value;
    }
    return value;
}

OutcomeModel psychometric_model(Family family, LapseForm form, SlopeAs slope_as) {
    OutcomeModel model = two_outcomes(family, form, slope_as, false);
    model.shape = OutcomeModel::Shape{family, form, slope_as};
    return model;
}

OutcomeModel covariate_model(Family family, LapseForm form, SlopeAs slope_as) {
    return two_outcomes(family, form, slope_as, true);
}

namespace {

/// Half-way between neighbours.
std::vector<double> criteria_between(const std::vector<double>& alternatives) {
    const std::size_t m = alternatives.size();
    std::vector<double> criteria;
    for (std::size_t j = 0; j + 1 < m; ++j) {
        if (!std::isfinite(alternatives[j]) || !(alternatives[j] < alternatives[j + 1])) {
            break;
        }
        criteria.push_back(0.5 * (alternatives[j] + alternatives[j + 1]));
    }
    if (m < 2 || criteria.size() + 1 != m || !std::isfinite(alternatives.back())) {
        throw std::invalid_argument(
            "the alternatives are no list of at least two increasing finite numbers: give one");
    }
    return criteria;
}

}  // namespace

OutcomeModel identification_model(const std::vector<double>& alternatives) {
    std::vector<double> criteria = criteria_between(alternatives);
    OutcomeModel model;
    model.stimulus = {"stimulus"};
    model.parameters = {"noise", "bias", "lapse"};
    model.outcomes = criteria.size() + 1;
    model.chances = [criteria = std::move(criteria)](std::span<const double> x,
                                                     std::span<const double> s,
                                                     std::span<double> chances) {
        const double noise = s[0];
        const double lapse = s[2];
        if (!(noise > 0.0) || !(lapse >= 0.0 && lapse <= 1.0)) {
            throw std::invalid_argument(fmt::format(
                "noise is {} and lapse {}: give a noise above 0 and a lapse from 0 to 1", noise,
                lapse));
        }
        const double guess = lapse / static_cast<double>(chances.size());
        Sides left;
        for (std::size_t j = 0; j < chances.size(); ++j) {
            const Sides right = j < criteria.size() ? sides_of((criteria[j] - x[0] - s[1]) / noise)
                                                    : Sides{1.0, 0.0};
            chances[j] = guess + (1.0 - lapse) * between(left, right);
            left = right;
        }
    };
    return model;
}

}  // namespace palpate::protocols

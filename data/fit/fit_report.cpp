#include "data/fit/fit_report.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

namespace palpate::data {
namespace {

constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();
constexpr double kEndless = std::numeric_limits<double>::infinity();
constexpr std::string_view kNotDetermined = "not determined:";
constexpr const char* kOfLogarithm = "none of a logarithmic stimulus";

bool of_steepness(Quantity quantity) {
    return quantity == Quantity::jnd || quantity == Quantity::weber || quantity == Quantity::slope;
}

/// Why a quantity of a curve, which is no rate, has no end; empty where it has one.
std::string unbounded_why(const CurveFit& fit, Quantity quantity) {
    return fit.shallow                               ? "unbounded: the share does not grow"
         : fit.far && quantity != Quantity::at_share ? "unbounded: the share hardly changes"
         : fit.steep && of_steepness(quantity) ? "unbounded: at most one level lies on the rise"
                                               : "";
}

/// Why the formula of a quantity gives no number.
std::string undefined_why(const FittedCurve& curve, Quantity quantity) {
    const CurveSpec& spec = curve.model.spec();
    if (quantity == Quantity::at_share) {
        const double guess = quantity_of(spec, curve.fit.at, Quantity::guess);
        return fmt::format("never reached: P goes from {:.4g} to {:.4g}", guess,
                           1.0 - curve.fit.at[3]);
    }
    if (spec.family == protocols::Family::weibull_log10 ||
        spec.family == protocols::Family::weibull_db) {
        return kOfLogarithm;
    }
    const std::string unbounded = unbounded_why(curve.fit, Quantity::threshold);
    return unbounded.empty() ? "none: the threshold is not above 0" : unbounded;
}

/// A ratio of stimuli that may be below 0 says nothing.
bool ratios(const Answers& answers) {
    return std::ranges::all_of(answers.levels,
                               [](const Level& level) { return level.stimulus >= 0.0; });
}

/// @param elsewhere  another curve of the person, which has the same shared rate, grows
FitEstimate estimate_of(const FittedCurve& curve,
                        const FitOptions& options,
                        Quantity quantity,
                        bool elsewhere) {
    const CurveSpec& spec = options.spec;
    const double share = options.at.value_or(0.5);
    FitEstimate estimate{.quantity = quantity, .value = kNoValue};
    if (quantity == Quantity::weber) {
        estimate.why = options.stimulus.starts_with("log10") ? kOfLogarithm
                     : ratios(curve.answers)                 ? ""
                                                             : "none: a stimulus is below 0";
        if (!estimate.why.empty()) {
            return estimate;
        }
    }
    estimate.value = quantity_of(spec, curve.fit.at, quantity, share);
    const bool rate = quantity == Quantity::guess || quantity == Quantity::lapse;
    const CurveMask free = curve.model.free();
    const std::size_t place = quantity == Quantity::lapse || spec.two_sided ? 3 : 2;
    estimate.fixed = rate && !free.at(place);
    if (estimate.fixed) {
        return estimate;
    }
    if (std::isnan(estimate.value)) {
        estimate.why = undefined_why(curve, quantity);
        return estimate;
    }
    if (!curve.fit.shallow) {
        estimate.profile = profile_interval(curve.model, curve.fit, quantity, share);
    }
    if (!rate) {
        estimate.why = unbounded_why(curve.fit, quantity);
    } else if (curve.fit.shallow && !(elsewhere && place == spec.shared_rate())) {
        estimate.why = "none: the share does not grow";
    }
    if (estimate.why.empty() && curve.fit.maxima && !rate && !of_steepness(quantity)) {
        estimate.value = off_axis(spec.family, curve.fit.maxima->low);
        const double high = off_axis(spec.family, curve.fit.maxima->high);
        estimate.why = estimate.value < high
                         ? fmt::format("{} {:.9g} to {:.9g}", kNotDetermined, estimate.value, high)
                         : "";
    }
    if (!estimate.why.empty()) {
        estimate.value = kNoValue;
        return estimate;
    }
    estimate.se = standard_error(spec, curve.fit, quantity, share);
    if (!curve.samples.at.empty() && !curve.fit.steep) {
        estimate.bootstrap =
            bootstrap_interval(of_all(spec, curve.samples, quantity, share),
                               quantity_of(spec, curve.samples.from, quantity, share));
        estimate.corrected = corrected(spec, curve.fit, curve.samples, quantity, share);
    }
    return estimate;
}

/// All that is said of a curve that is fitted.
/// @param elsewhere  as of estimate_of()
void tell(FittedCurve& curve, const FitOptions& options, bool elsewhere) {
    std::vector<Quantity> asked{Quantity::threshold, Quantity::jnd,   Quantity::weber,
                                Quantity::slope,     Quantity::guess, Quantity::lapse};
    if (options.at) {
        asked.insert(asked.begin() + 1, Quantity::at_share);
    }
    for (const Quantity quantity : asked) {
        curve.estimates.push_back(estimate_of(curve, options, quantity, elsewhere));
    }
}

FittedCurve fitted(const Answers& answers, const FitOptions& options) {
    FittedCurve curve{.answers = answers, .model = CurveModel(answers.levels, options.spec)};
    if (options.spec.shared_rate() != 0) {  // fit_shared() fits all of a person
        return curve;
    }
    curve.fit = fit_curve(curve.model);
    if (options.bootstrap > 0 && !curve.fit.shallow) {
        curve.samples =
            bootstrap(curve.model, curve.fit, options.bootstrap, options.seed, answers.stream);
    }
    tell(curve, options, false);
    return curve;
}

/// With one rate for the conditions of each person.
void fit_shared(FitReport& report) {
    const FitOptions& options = report.options;
    for (std::size_t first = 0; first < report.curves.size(); ++first) {
        const std::string& person = report.curves[first].answers.participant;
        std::vector<std::size_t> mine;
        std::vector<std::uint64_t> streams;
        std::vector<CurveModel> models;
        for (std::size_t i = 0; i < report.curves.size(); ++i) {
            if (report.curves[i].answers.participant == person) {
                mine.push_back(i);
                streams.push_back(report.curves[i].answers.stream);
                models.push_back(report.curves[i].model);
            }
        }
        if (mine.front() != first) {
            continue;
        }
        share_rate(models);
        std::vector<CurveFit> fits(models.size());
        std::ranges::transform(models, fits.begin(), fit_curve);
        std::vector<Bootstrap> samples(models.size());
        if (options.bootstrap > 0) {
            samples = shared_bootstrap(models, fits, options.bootstrap, options.seed, streams);
        }
        const bool grows =
            std::ranges::any_of(fits, [](const CurveFit& one) { return !one.shallow; });
        for (std::size_t i = 0; i < mine.size(); ++i) {
            FittedCurve& curve = report.curves[mine[i]];
            curve.model = models[i];
            curve.fit = fits[i];
            if (!curve.fit.shallow) {
                curve.samples = std::move(samples[i]);
            }
            tell(curve, options, grows);
        }
    }
}

/// equality_p(), with one rate where that is shared.
double p_of_equal(const FitReport& report,
                  const FittedCurve& one,
                  const FittedCurve& two,
                  Quantity quantity) {
    if (report.options.spec.shared_rate() == 0) {
        return equality_p(one.model, one.fit, two.model, two.fit, quantity);
    }
    std::size_t place_one = 0;
    std::size_t place_two = 0;
    std::vector<CurveModel> models;  // of the person, of whose rates one is the same for all
    for (const FittedCurve& curve : report.curves) {
        if (curve.answers.participant == one.answers.participant) {
            place_one = &curve == &one ? models.size() : place_one;
            place_two = &curve == &two ? models.size() : place_two;
            models.push_back(curve.model);
        }
    }
    return shared_equality_p(models, place_one, one.fit, place_two, two.fit, quantity);
}

const FitEstimate& estimate_in(const FittedCurve& curve, Quantity quantity) {
    return *std::ranges::find(curve.estimates, quantity, &FitEstimate::quantity);
}

std::optional<Interval> interval_of_difference(const CurveSpec& spec,
                                               const FittedCurve& one,
                                               const FittedCurve& two,
                                               Quantity quantity) {
    if (!estimate_in(one, quantity).bootstrap || !estimate_in(two, quantity).bootstrap) {
        return std::nullopt;
    }
    const std::vector<double> first = of_all(spec, one.samples, quantity);
    std::vector<double> second = of_all(spec, two.samples, quantity);
    if (first.size() != second.size()) {
        return std::nullopt;
    }
    for (std::size_t i = 0; i < second.size(); ++i) {
        second[i] -= first[i];
    }
    return bootstrap_interval(std::move(second), quantity_of(spec, two.samples.from, quantity) -
                                                     quantity_of(spec, one.samples.from, quantity));
}

const FittedCurve* find_curve(const FitReport& report,
                              const std::string& participant,
                              const std::string& condition) {
    const auto found = std::ranges::find_if(report.curves, [&](const FittedCurve& one) {
        return one.answers.participant == participant && one.answers.condition == condition;
    });
    return found == report.curves.end() ? nullptr : &*found;
}

void compare(FitReport& report, const std::string& condition) {
    const CurveSpec& spec = report.options.spec;
    for (const FittedCurve& two : report.curves) {
        const FittedCurve* one =
            find_curve(report, two.answers.participant, report.conditions.front());
        if (one == nullptr || two.answers.condition != condition || one->fit.shallow ||
            two.fit.shallow) {
            continue;
        }
        for (const Quantity quantity : {Quantity::threshold, Quantity::jnd}) {
            const double value =
                estimate_in(two, quantity).value - estimate_in(*one, quantity).value;
            report.differences.push_back(
                {.participant = two.answers.participant,
                 .condition = condition,
                 .quantity = quantity,
                 .value = value,
                 .determined =
                     quantity == Quantity::jnd || !std::isnan(value) || one->fit.far || two.fit.far,
                 .interval = interval_of_difference(spec, *one, two, quantity),
                 .p = p_of_equal(report, *one, two, quantity)});
        }
    }
}

/// Of the curve of a condition; without a name where the person gave no answers in it.
Score score_of(const FitReport& report,
               const std::string& person,
               const std::string& condition,
               Quantity quantity) {
    const auto missing = std::ranges::find_if(report.left_out, [&](const NotFitted& one) {
        return one.participant == person && one.condition == condition;
    });
    if (missing != report.left_out.end()) {
        return {.why = "cannot be fitted", .name = person};
    }
    const FittedCurve* curve = find_curve(report, person, condition);
    if (curve == nullptr) {
        return {.why = "no answers"};
    }
    const FitEstimate& estimate = estimate_in(*curve, quantity);
    Score known{estimate.value, estimate.value, estimate.why, person};
    if (std::isnan(estimate.value)) {
        const bool jnd = quantity == Quantity::jnd;
        known.rank = estimate.why.starts_with(kNotDetermined) ? kNoValue
                   : curve->fit.shallow                       ? (jnd ? kEndless : kNoValue)
                   : !jnd ? (curve->fit.at[0] > curve->model.last() ? kEndless : -kEndless)
                   : curve->fit.far ? kEndless
                                    : -kEndless;
    }
    return known;
}

/// The second less the first; without a name where the person has neither.
Score difference_of(const Score& first, const Score& second) {
    Score made{.value = second.value - first.value,
               .why = first.why.empty() || first.why == second.why ? second.why : first.why,
               .name = first.name.empty() ? second.name : first.name};
    if (first.name.empty() != second.name.empty()) {
        made.why = "one condition alone";
    }
    return made;
}

void add_people(FitReport& report, std::string what, std::vector<Score> all, bool test) {
    std::erase_if(all, [](const Score& one) { return one.name.empty(); });
    if (all.size() > 1) {
        report.people.push_back(over_people(std::move(what), all, test));
    }
}

void over_people(FitReport& report, const std::vector<std::string>& people) {
    for (const Quantity quantity : {Quantity::threshold, Quantity::jnd}) {
        const std::string name = quantity == Quantity::threshold ? "threshold" : "JND";
        std::vector<std::vector<Score>> known;
        for (const std::string& condition : report.conditions) {
            std::vector<Score>& all = known.emplace_back();
            for (const std::string& person : people) {
                all.push_back(score_of(report, person, condition, quantity));
            }
            add_people(report, condition.empty() ? name : name + ", " + condition, all, false);
        }
        for (std::size_t c = 1; c < report.conditions.size(); ++c) {
            std::vector<Score> differences;
            for (std::size_t i = 0; i < people.size(); ++i) {
                differences.push_back(difference_of(known[0][i], known[c][i]));
            }
            add_people(
                report,
                fmt::format("{}, {} - {}", name, report.conditions[c], report.conditions.front()),
                differences, true);
        }
    }
}

/// Those that are named, then the others by name.
std::vector<std::string> in_order(const std::vector<Answers>& all,
                                  const std::vector<std::string>& first) {
    const auto has = [&](const std::string& condition) {
        return std::ranges::find(all, condition, &Answers::condition) != all.end();
    };
    std::vector<std::string> conditions;
    std::ranges::copy_if(first, std::back_inserter(conditions), has);
    const auto named = static_cast<std::ptrdiff_t>(conditions.size());
    for (const Answers& one : all) {
        if (std::ranges::find(conditions, one.condition) == conditions.end()) {
            conditions.push_back(one.condition);
        }
    }
    std::sort(conditions.begin() + named, conditions.end());
    return conditions;
}

}  // namespace

FitReport fit_all(std::string source, const std::vector<Answers>& all, const FitOptions& options) {
    FitReport report{.source = std::move(source),
                     .options = options,
                     .conditions = in_order(all, options.conditions)};
    std::vector<std::string> people;
    for (const Answers& answers : all) {
        const std::string& person = answers.participant;
        if (!person.empty() && std::ranges::find(people, person) == people.end()) {
            people.push_back(person);
        }
        try {
            report.curves.push_back(fitted(answers, options));
        } catch (const std::invalid_argument& e) {
            report.left_out.push_back({answers.participant, answers.condition, e.what()});
        }
    }
    if (options.spec.shared_rate() != 0 && !report.curves.empty()) {
        fit_shared(report);
    }
    for (std::size_t c = 1; c < report.conditions.size(); ++c) {
        compare(report, report.conditions[c]);
    }
    over_people(report, people);
    return report;
}

}  // namespace palpate::data

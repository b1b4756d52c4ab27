#include "data/fit/fit_report.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

namespace palpate::data {
namespace {

constexpr double kUnbounded = std::numeric_limits<double>::quiet_NaN();

Told told_of(const FittedCurve& curve, const FitOptions& options, Quantity quantity) {
    const CurveSpec& spec = options.spec;
    const double share = options.at.value_or(0.5);
    const double value = quantity_of(spec, curve.fit.at, quantity, share);
    const bool rate = quantity == Quantity::guess || quantity == Quantity::lapse;
    const CurveMask free = curve.model.free();
    Told told{.quantity = quantity, .value = value};
    told.fixed = rate && !(quantity == Quantity::lapse || spec.two_sided ? free[3] : free[2]);
    if (told.fixed) {
        return told;
    }
    told.se = standard_error(spec, curve.fit, quantity, share);
    if (!curve.fit.shallow) {
        told.profile = profile_interval(curve.model, curve.fit, quantity, share);
        if (!curve.samples.at.empty() && !curve.fit.steep) {
            told.bootstrap =
                bootstrap_interval(of_all(spec, curve.samples, quantity, share),
                                   quantity_of(spec, curve.samples.from, quantity, share));
            told.corrected = corrected(spec, curve.fit, curve.samples, quantity, share);
        }
    }
    const bool of_steepness =
        quantity == Quantity::jnd || quantity == Quantity::weber || quantity == Quantity::slope;
    if (curve.fit.shallow || (curve.fit.steep && of_steepness)) {
        told.value = kUnbounded;
    }
    return told;
}

FittedCurve fitted(const Answers& answers, const FitOptions& options, std::uint64_t stream) {
    FittedCurve curve{.answers = answers, .model = CurveModel(answers.levels, options.spec)};
    curve.fit = fit_curve(curve.model);
    if (options.bootstrap > 0 && !curve.fit.shallow) {
        curve.samples = bootstrap(curve.model, curve.fit, options.bootstrap, options.seed, stream);
    }
    std::vector<Quantity> asked{Quantity::threshold, Quantity::jnd,   Quantity::weber,
                                Quantity::slope,     Quantity::guess, Quantity::lapse};
    if (options.at) {
        asked.insert(asked.begin() + 1, Quantity::at_share);
    }
    // A ratio of stimuli that may be below 0 says nothing.
    const bool ratios = std::ranges::all_of(
        answers.levels, [](const Level& level) { return level.stimulus >= 0.0; });
    for (const Quantity quantity : asked) {
        const bool weber = quantity == Quantity::weber;
        if (weber && (!ratios || std::isnan(quantity_of(options.spec, curve.fit.at, quantity)))) {
            continue;
        }
        curve.told.push_back(told_of(curve, options, quantity));
    }
    return curve;
}

const Told& told_in(const FittedCurve& curve, Quantity quantity) {
    return *std::ranges::find(curve.told, quantity, &Told::quantity);
}

std::optional<Interval> interval_of_difference(const CurveSpec& spec,
                                               const FittedCurve& one,
                                               const FittedCurve& two,
                                               Quantity quantity) {
    if (!told_in(one, quantity).bootstrap || !told_in(two, quantity).bootstrap) {
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

void compare(FitReport& report) {
    const CurveSpec& spec = report.options.spec;
    for (const FittedCurve& two : report.curves) {
        const FittedCurve* one =
            find_curve(report, two.answers.participant, report.conditions.front());
        if (one == nullptr || two.answers.condition != report.conditions.back() ||
            one->fit.shallow || two.fit.shallow) {
            continue;
        }
        Difference made{.participant = two.answers.participant};
        made.threshold =
            told_in(two, Quantity::threshold).value - told_in(*one, Quantity::threshold).value;
        made.jnd = told_in(two, Quantity::jnd).value - told_in(*one, Quantity::jnd).value;
        made.threshold_interval = interval_of_difference(spec, *one, two, Quantity::threshold);
        made.jnd_interval = interval_of_difference(spec, *one, two, Quantity::jnd);
        made.threshold_p =
            equality_p(one->model, one->fit, two.model, two.fit, Quantity::threshold);
        made.slope_p = equality_p(one->model, one->fit, two.model, two.fit, Quantity::slope);
        report.differences.push_back(made);
    }
}

void add_people(FitReport& report, std::string what, const std::vector<double>& values, bool test) {
    std::vector<double> known = values;
    std::erase_if(known, [](double value) { return !std::isfinite(value); });
    if (known.size() < 2) {
        return;
    }
    report.people.push_back({.what = std::move(what),
                             .mean = mean_over_people(known),
                             .test = test ? std::optional(sign_flip(known)) : std::nullopt});
}

void over_people(FitReport& report) {
    for (const Quantity quantity : {Quantity::threshold, Quantity::jnd}) {
        const std::string name = quantity == Quantity::threshold ? "threshold" : "JND";
        for (const std::string& condition : report.conditions) {
            std::vector<double> values;
            for (const FittedCurve& curve : report.curves) {
                if (curve.answers.condition == condition && !curve.answers.participant.empty()) {
                    values.push_back(told_in(curve, quantity).value);
                }
            }
            add_people(report, condition.empty() ? name : name + ", " + condition, values, false);
        }
        std::vector<double> differences;
        for (const Difference& one : report.differences) {
            differences.push_back(quantity == Quantity::threshold ? one.threshold : one.jnd);
        }
        if (!differences.empty()) {
            add_people(report,
                       fmt::format("{}, {} - {}", name, report.conditions.back(),
                                   report.conditions.front()),
                       differences, true);
        }
    }
}

}  // namespace

std::string name_of(const Answers& answers) {
    const bool both = !answers.participant.empty() && !answers.condition.empty();
    return answers.participant + (both ? ", " : "") + answers.condition;
}

FitReport fit_all(std::string source, const std::vector<Answers>& all, const FitOptions& options) {
    FitReport report{.source = std::move(source), .options = options};
    for (const Answers& answers : all) {
        if (std::ranges::find(report.conditions, answers.condition) == report.conditions.end()) {
            report.conditions.push_back(answers.condition);
        }
        try {
            report.curves.push_back(fitted(answers, options, report.curves.size()));
        } catch (const std::invalid_argument& e) {
            const std::string who = name_of(answers);
            report.left_out.push_back(who.empty() ? e.what() : who + ": " + e.what());
        }
    }
    if (report.curves.empty()) {
        throw std::invalid_argument(fmt::format(
            "{}: {}", report.source,
            report.left_out.empty() ? "there are no answers" : report.left_out.front()));
    }
    if (report.conditions.size() == 2) {
        compare(report);
    }
    over_people(report);
    return report;
}

}  // namespace palpate::data

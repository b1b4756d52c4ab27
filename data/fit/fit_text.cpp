#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "engine/base/text.hpp"
#include "data/csv/json_text.hpp"
#include "data/fit/fit_report.hpp"

namespace palpate::data {
namespace {

using protocols::Family;

std::string_view core_of(Family family) {
    constexpr std::array<std::string_view, protocols::kFamilyWords.size()> kWords{
        "F = 1 - exp(-(x/t)^b)",
        "F = 1 - exp(-10^(b (x - t)))",
        "F = 1 - exp(-10^(b (x - t) / 20))",
        "F = 1 - exp(-e^(b (x - t)))",
        "F = Phi(b (x - t))",
        "F = 1 / (1 + e^(-b (x - t)))"};
    return kWords[static_cast<std::size_t>(family)];
}

std::string rate_text(bool free, double value) {
    return free ? std::string("free") : fmt::format("{:.4g} (given)", value);
}

/// "threshold ~ normal: mean, sd (5, 2), lapse ~ beta(2, 50)"; empty without priors.
std::string priors_text(const CurveSpec& spec) {
    std::vector<std::string> all;
    const auto add = [&](const char* what, const char* density, const std::optional<Prior>& prior) {
        if (prior) {
            all.push_back(
                fmt::format("{} ~ {}({:g}, {:g})", what, density, prior->first, prior->second));
        }
    };
    add("threshold",
        spec.family == Family::weibull ? "lognormal: median, sd of ln " : "normal: mean, sd ",
        spec.threshold_prior);
    add("slope b", "lognormal: median, sd of ln ", spec.slope_prior);
    add("guess", "beta", spec.guess_prior);
    add("lapse", "beta", spec.lapse_prior);
    return fmt::format("{}", fmt::join(all, ", "));
}

std::string head_text(const FitReport& report) {
    const CurveSpec& spec = report.options.spec;
    const std::string& stimulus = report.options.stimulus;
    std::string text = fmt::format(
        "{}: {} fitted\n{}"
        "  {}: P(x) = guess + (1 - guess - lapse) F, {}\n"
        "  guess {}, lapse {}; {}\n"
        "  threshold: x of F = 1/2 (of a comparison: the point of equality, PSE); JND: half the "
        "distance from F = 1/4 to\n  F = 3/4; Weber fraction: JND / threshold.\n"
        "  95 % intervals (inf: no end that the answers bound): profile likelihood",
        report.source, counted(report.curves.size(), "curve"),
        stimulus.empty() ? "" : fmt::format("  stimulus: {}\n", stimulus), word_of(spec.family),
        core_of(spec.family), guess_text(spec), lapse_text(spec),
        spec.map() ? "MAP with priors " + priors_text(spec) : "maximum likelihood, no priors");
    if (report.options.bootstrap > 0) {
        text += fmt::format(
            "; bias-corrected percentiles of {} bootstrap samples, seed {}\n"
            "  corrected: the estimate less its bias in these samples",
            report.options.bootstrap, report.options.seed);
    }
    return text + '\n';
}

std::string curve_text(const FitReport& report, const FittedCurve& curve) {
    const std::string name = name_of(curve.answers.participant, curve.answers.condition);
    const auto degrees = static_cast<std::int64_t>(curve.model.levels()) - curve.fit.parameters;
    std::string text =
        fmt::format("\n{}{}, {}; deviance {:.4g} on {} df", name.empty() ? "" : name + ": ",
                    counted(curve.model.levels(), "level"), counted(answers_of(curve), "answer"),
                    curve.fit.deviance, std::max<std::int64_t>(degrees, 0));
    if (single_answers(curve)) {
        text += fmt::format(": {}", kNoGoodness);
    } else if (!curve.samples.at.empty()) {
        text += fmt::format(", p = {:.3g} by simulation", curve.samples.deviance_p);
    }
    text += table_text(estimates_table(report, curve));
    for (const protocols::Estimate& one : curve.answers.believed) {
        text += fmt::format("  the rule's posterior, {}: mean {:.4g}", one.name,
                            one.mean.value_or(std::nan("")));
        text += one.low && one.high
                  ? fmt::format(", 2.5 % {:.4g}, 97.5 % {:.4g}\n", *one.low, *one.high)
                  : "\n";
    }
    for (const std::string& warning : warnings_of(report, curve)) {
        text += "  " + warning + ".\n";
    }
    return text;
}

Json curve_json(const FitReport& report, const FittedCurve& curve) {
    Json one = {{"participant", curve.answers.participant},
                {"condition", curve.answers.condition},
                {"levels", curve.model.levels()},
                {"answers", answers_of(curve)}};
    put_table(one, estimates_table(report, curve));
    one["deviance"] = curve.fit.deviance;
    one["parameters"] = curve.fit.parameters;
    one["deviance_p"] = curve.samples.at.empty() || single_answers(curve)
                          ? Json(nullptr)
                          : Json(curve.samples.deviance_p);
    one["deviance_why"] = single_answers(curve) ? Json(kNoGoodness) : Json(nullptr);
    one["log_likelihood"] = curve.fit.value;
    one["log_likelihood_of"] =
        report.options.spec.shared_rate() != 0 ? "all conditions of the person" : "this curve";
    one["log_likelihood_nelder_mead"] = curve.fit.second;
    one["optimisers_agree"] = curve.fit.agree;
    for (const protocols::Estimate& believed : curve.answers.believed) {
        one["posterior"].push_back({{"name", believed.name},
                                    {"mean", believed.mean.value_or(std::nan(""))},
                                    {"low_95", believed.low.value_or(std::nan(""))},
                                    {"high_95", believed.high.value_or(std::nan(""))}});
    }
    one["warnings"] = warnings_of(report, curve);
    return one;
}

}  // namespace

std::string name_of(const std::string& participant, const std::string& condition) {
    const bool both = !participant.empty() && !condition.empty();
    return participant + (both ? ", " : "") + condition;
}

std::string text_of(const NotFitted& one) {
    const std::string who = name_of(one.participant, one.condition);
    return who.empty() ? one.why : who + ": " + one.why;
}

std::string_view word_of(Quantity quantity) {
    constexpr std::array<std::string_view, 7> kWords{
        "threshold", "JND", "Weber fraction", "slope b", "guess", "lapse", "stimulus at a share"};
    return kWords[static_cast<std::size_t>(quantity)];
}

std::string guess_text(const CurveSpec& spec) {
    return spec.two_sided    ? "as the lapse rate"
         : spec.guess_shared ? "free, one for all conditions of a person"
                             : rate_text(spec.guess_free, spec.guess);
}

std::string lapse_text(const CurveSpec& spec) {
    return spec.lapse_shared ? "free, one for all conditions of a person"
                             : rate_text(spec.lapse_free, spec.lapse);
}

std::vector<std::string> warnings_of(const FitReport& report, const FittedCurve& curve) {
    std::vector<std::string> all;
    const CurveFit& fit = curve.fit;
    if (fit.shallow) {
        all.emplace_back(
            "the share of 1 does not grow with the stimulus: there is no curve to fit; if it "
            "should fall, give n - k as k");
        return all;
    }
    if (fit.steep) {
        all.emplace_back(
            "at most one level lies on the rise, so the slope has no end: add levels near the "
            "threshold, or "
            "give --prior slope=MEDIAN,SD");
    }
    if (fit.far) {
        all.emplace_back(
            "the threshold is more than 20 times the levels' range away from them: the share "
            "hardly changes");
    }
    if (!fit.agree) {
        all.push_back(
            fmt::format("the two optimisers differ: Nelder-Mead ended {:.3g} {} in log-likelihood; "
                        "the higher maximum is given",
                        std::fabs(fit.second - fit.value),
                        fit.second >= fit.value ? "higher than Fisher scoring" : "lower"));
    }
    if (curve.samples.steep > 0 && !fit.steep) {
        all.push_back(fmt::format(
            "{} of {} bootstrap samples are steps: their JND counts as 0, their slope as infinite",
            curve.samples.steep, report.options.bootstrap));
    }
    if (curve.samples.far > 0 && !fit.far) {
        all.push_back(fmt::format(
            "{} of {} bootstrap samples hardly rise: their threshold and JND count as infinite",
            curve.samples.far, report.options.bootstrap));
    }
    if (fit.parameters > static_cast<std::int64_t>(curve.model.levels())) {
        all.emplace_back(
            "there are more parameters than levels: other curves fit as well; give rates instead "
            "of free");
    }
    return all;
}

std::int64_t answers_of(const FittedCurve& curve) {
    const auto counts = curve.model.counts();
    return static_cast<std::int64_t>(std::accumulate(counts.begin(), counts.end(), 0.0));
}

bool single_answers(const FittedCurve& curve) {
    const auto alone = std::ranges::count(curve.model.counts(), 1.0);
    return 2 * alone >= answers_of(curve);
}

std::string_view word_of(Family family) {
    return protocols::kFamilyWords.at(static_cast<std::size_t>(family));
}

std::string fit_text(const FitReport& report) {
    std::string text = head_text(report);
    text += report.file_left_out ? left_out_text(*report.file_left_out) : std::string();
    for (const FittedCurve& curve : report.curves) {
        text += curve_text(report, curve);
    }
    for (const NotFitted& one : report.left_out) {
        text += "\nNot fitted: " + text_of(one) + ".\n";
    }
    text += table_text(differences_table(report)) +
            table_text(over_people_table("people/-", report.people));
    const auto agreed =
        std::ranges::count_if(report.curves, [](const FittedCurve& one) { return one.fit.agree; });
    text += fmt::format(
        "\nFisher scoring and Nelder-Mead agree on {} of {} (log-likelihood within 1e-6).\n",
        agreed, counted(report.curves.size(), "curve"));
    const std::string versions = versions_text(report.versions);
    return versions.empty() ? text : text + '\n' + versions;
}

std::string fit_json(const FitReport& report) {
    const CurveSpec& spec = report.options.spec;
    const std::string& stimulus = report.options.stimulus;
    Json all = {
        {"source", report.source},
        {"stimulus", stimulus.empty() ? Json(nullptr) : Json(stimulus)},
        {"function", word_of(spec.family)},
        {"guess", guess_text(spec)},
        {"lapse", lapse_text(spec)},
        {"priors", priors_text(spec)},
        {"bootstrap", report.options.bootstrap},
        {"seed", report.options.seed},
        {"curves", Json::array()},
        {"conditions", report.conditions},
        {"not_fitted", Json::array()},
        {"differences", Json::array()},
        {"people", Json::array()},
        {"versions", versions_json(report.versions)},
        {"left_out", report.file_left_out ? left_out_json(*report.file_left_out) : Json(nullptr)}};
    for (const NotFitted& one : report.left_out) {
        all["not_fitted"].push_back(text_of(one));
    }
    for (const FittedCurve& curve : report.curves) {
        all["curves"].push_back(curve_json(report, curve));
    }
    put_table(all, differences_table(report));
    put_table(all, over_people_table("people/-", report.people));
    return json_text(all) + '\n';
}

}  // namespace palpate::data

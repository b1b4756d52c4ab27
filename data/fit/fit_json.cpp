#include <cmath>

#include <nlohmann/json.hpp>

#include "data/export/json_text.hpp"
#include "data/fit/fit_words.hpp"

namespace palpate::data {
namespace {

Json number(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json interval_json(const std::optional<Interval>& interval) {
    return interval ? Json::array({number(interval->low), number(interval->high)}) : Json(nullptr);
}

/// Which ends are null because the answers do not bound them.
Json open_json(const std::optional<Interval>& interval) {
    const bool low = interval && std::isinf(interval->low);
    const bool high = interval && std::isinf(interval->high);
    return low && high ? Json("both") : low ? Json("low") : high ? Json("high") : Json(nullptr);
}

std::string key_of(Quantity quantity) {
    switch (quantity) {
        case Quantity::threshold:
            return "threshold";
        case Quantity::jnd:
            return "jnd";
        case Quantity::weber:
            return "weber_fraction";
        case Quantity::slope:
            return "slope";
        case Quantity::guess:
            return "guess";
        case Quantity::lapse:
            return "lapse";
        case Quantity::at_share:
            return "stimulus_at";
    }
    return "";
}

Json curve_json(const FitReport& report, const FittedCurve& curve) {
    Json one = {{"participant", curve.answers.participant},
                {"condition", curve.answers.condition},
                {"levels", curve.model.levels()},
                {"answers", answers_of(curve)}};
    for (const FitEstimate& estimate : curve.estimates) {
        one[key_of(estimate.quantity)] = {
            {"estimate", number(estimate.value)},
            {"why", estimate.why.empty() ? Json(nullptr) : Json(estimate.why)},
            {"given", estimate.fixed},
            {"se", estimate.se ? number(*estimate.se) : Json(nullptr)},
            {"profile_95", interval_json(estimate.profile)},
            {"profile_open", open_json(estimate.profile)},
            {"bootstrap_95", interval_json(estimate.bootstrap)},
            {"bootstrap_open", open_json(estimate.bootstrap)},
            {"corrected", estimate.corrected ? number(*estimate.corrected) : Json(nullptr)}};
    }
    one["deviance"] = curve.fit.deviance;
    one["parameters"] = curve.fit.parameters;
    one["deviance_p"] = curve.samples.at.empty() || single_answers(curve)
                          ? Json(nullptr)
                          : Json(curve.samples.deviance_p);
    one["deviance_why"] = single_answers(curve) ? Json(kNoGoodness) : Json(nullptr);
    one["log_likelihood"] = curve.fit.value;
    one["log_likelihood_nelder_mead"] = curve.fit.second;
    one["optimisers_agree"] = curve.fit.agree;
    for (const protocols::Estimate& believed : curve.answers.believed) {
        one["posterior"].push_back({{"name", believed.name},
                                    {"mean", number(believed.mean.value_or(std::nan("")))},
                                    {"low_95", number(believed.low.value_or(std::nan("")))},
                                    {"high_95", number(believed.high.value_or(std::nan("")))}});
    }
    one["warnings"] = warnings_of(report, curve);
    return one;
}

}  // namespace

std::string fit_json(const FitReport& report) {
    const CurveSpec& spec = report.options.spec;
    Json all = {
        {"source", report.source},
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
    for (const Difference& one : report.differences) {
        all["differences"].push_back(
            {{"participant", one.participant},
             {"of", one.condition},
             {"less", report.conditions.front()},
             {"threshold", number(one.threshold)},
             {"threshold_why", !one.determined ? Json("not determined: that of a condition is not")
                               : std::isnan(one.threshold)
                                   ? Json("unbounded: that of a condition is")
                                   : Json(nullptr)},
             {"threshold_bootstrap_95", interval_json(one.threshold_interval)},
             {"threshold_bootstrap_open", open_json(one.threshold_interval)},
             {"threshold_p", number(one.threshold_p)},
             {"jnd", number(one.jnd)},
             {"jnd_why",
              std::isnan(one.jnd) ? Json("unbounded: that of a condition is") : Json(nullptr)},
             {"jnd_bootstrap_95", interval_json(one.jnd_interval)},
             {"jnd_bootstrap_open", open_json(one.jnd_interval)},
             {"slope_p", number(one.slope_p)}});
    }
    for (const OverPeople& one : report.people) {
        Json left_out = Json::array();
        for (const LeftOutPerson& person : one.left_out) {
            left_out.push_back({{"participant", person.name}, {"why", person.why}});
        }
        all["people"].push_back({{"what", one.what},
                                 {"people", one.mean.people},
                                 {"left_out", left_out},
                                 {"median", one.median ? number(*one.median) : Json(nullptr)},
                                 {"mean", number(one.mean.mean)},
                                 {"interval_95", interval_json(one.mean.interval)},
                                 {"sign_flip_p", one.test ? number(one.test->p) : Json(nullptr)}});
    }
    return json_text(all) + '\n';
}

}  // namespace palpate::data

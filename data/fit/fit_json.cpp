#include <cmath>

#include <nlohmann/json.hpp>

#include "data/csv/json_text.hpp"
#include "data/fit/fit_words.hpp"

namespace palpate::data {
namespace {

Json number(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
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
    put_table(all, differences_table(report));
    put_table(all, over_people_table("people/-", report.people));
    return json_text(all) + '\n';
}

}  // namespace palpate::data

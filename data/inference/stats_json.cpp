#include <cmath>

#include <nlohmann/json.hpp>

#include "protocols/file/keys.hpp"
#include "data/export/json_text.hpp"
#include "data/inference/stats_parts.hpp"

namespace palpate::data {
namespace {

Json finite(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json finite(const std::optional<double>& value) {
    return value ? finite(*value) : Json(nullptr);
}

Json ends(const std::optional<Interval>& interval) {
    return interval ? Json::array({finite(interval->low), finite(interval->high)}) : Json(nullptr);
}

Json cell_json(const PersonCell& cell) {
    Json one = {
        {"n", cell.n},
        {"k", cell.k},
        {"share", cell.n > 0 ? Json(static_cast<double>(cell.k) / static_cast<double>(cell.n))
                             : Json(nullptr)},
        {"wilson_95", ends(cell.wilson)},
        {"clopper_pearson_95", ends(cell.clopper_pearson)},
        {"d_prime", finite(cell.d_prime)},
        {"criterion", finite(cell.criterion)},
        {"log_rt", finite(cell.log_rt)},
        {"log_explore", finite(cell.log_explore)},
        {"confidence", finite(cell.confidence)},
        {"bits", nullptr}};
    if (cell.bits) {
        one["bits"] = {{"plug_in", cell.bits->bits.plug_in},
                       {"miller_madow", cell.bits->corrected},
                       {"null_mean", finite(cell.bits->null_mean)},
                       {"null_p", finite(cell.bits->null_p)},
                       {"interval_95", ends(cell.bits->interval)}};
    }
    return one;
}

Json test_json(const PeopleTest& test) {
    Json one = {{"people", test.values.size()},
                {"mean", finite(test.mean.mean)},
                {"interval_95", ends(test.mean.interval)},
                {"t", nullptr},
                {"df", nullptr},
                {"t_p", nullptr},
                {"dz", nullptr},
                {"sign_flip_p", test.flip.p},
                {"sign_flip_exact", test.flip.exact},
                {"wilcoxon_v", test.rank.v},
                {"wilcoxon_ranked", test.rank.ranked},
                {"wilcoxon_p", test.rank.p},
                {"wilcoxon_exact", test.rank.exact},
                {"bayes_factor_10", finite(test.bayes)}};
    if (test.t) {
        one["t"] = finite(test.t->t);
        one["df"] = test.t->df;
        one["t_p"] = test.t->p;
        one["dz"] = finite(test.t->dz);
    }
    return one;
}

Json measure_json(const StatsReport& report, const StatsPart& part, const Measure& measure) {
    Json one = {{"title", measure.title}, {"means", Json::object()}, {"effects", Json::object()}};
    for (std::size_t f = 0; f < measure.means.size(); ++f) {
        const std::string& friction = report.table.frictions[f];
        if (const auto& mean = measure.means[f]) {
            one["means"][friction] = {{"people", mean->people},
                                      {"mean", finite(mean->mean)},
                                      {"interval_95", ends(mean->interval)}};
        }
        if (measure.effects[f]) {
            one["effects"][friction] = test_json(*measure.effects[f]);
            one["effects"][friction]["left_out"] = without_both(part, measure, f);
        }
    }
    return one;
}

Json fit_json_of(const MixedFit& fit) {
    const auto ended = [](bool unbounded, const auto& value) {
        return unbounded ? Json(nullptr) : finite(value);
    };
    return {{"intercept", ended(fit.intercept_unbounded, fit.intercept)},
            {"intercept_se", ended(fit.intercept_unbounded, fit.intercept_se)},
            {"effect", ended(fit.unbounded, fit.effect)},
            {"effect_se", ended(fit.unbounded, fit.effect_se)},
            {"why", fit.unbounded ? Json("unbounded: a condition has answers of one kind alone")
                                  : Json(nullptr)},
            {"sd_intercept", finite(fit.sd_intercept)},
            {"sd_effect", finite(fit.sd_slope)},
            {"correlation", finite(fit.correlation)},
            {"log_likelihood", finite(fit.log_likelihood)},
            {"singular", fit.singular},
            {"unbounded", fit.unbounded},
            {"converged", fit.converged}};
}

Json ratio_json(const MixedFit& full, const MixedFit& less) {
    const double ratio = likelihood_ratio(full, less);
    return {{"chi_square", finite(ratio)}, {"df", 1}, {"p", chi_square_p(ratio, 1)}};
}

Json mixed_json(const MixedStats& mixed) {
    const double slopes = likelihood_ratio(mixed.laplace, mixed.laplace_intercept);
    Json one = {{"people", mixed.people},
                {"laplace", fit_json_of(mixed.laplace)},
                {"quadrature", fit_json_of(mixed.quadrature)}};
    one["quadrature"]["nodes"] = mixed.quadrature.spec.nodes;
    one["laplace"]["no_effect"] = ratio_json(mixed.laplace, mixed.laplace_null);
    one["quadrature"]["no_effect"] = ratio_json(mixed.quadrature, mixed.quadrature_null);
    one["laplace"]["no_effect"]["simulated_p"] =
        mixed.simulated ? Json(mixed.simulated->p) : Json(nullptr);
    one["laplace"]["no_spread"] = {{"chi_square", finite(slopes)},
                                   {"mixture_p", slope_variance_p(slopes)}};
    one["warnings"] = warnings_of(mixed);
    return one;
}

Json part_json(const StatsReport& report, const StatsPart& part) {
    Json one = {{"answers", part.trials},      {"people", Json::object()},
                {"measures", Json::object()},  {"mixed_model", Json::object()},
                {"confidence", Json::array()}, {"within_person", Json::object()}};
    for (const PersonStats& person : part.people) {
        Json& entry = one["people"][person.subject];
        for (std::size_t f = 0; f < person.cells.size(); ++f) {
            entry["friction"][report.table.frictions[f]] = cell_json(person.cells[f]);
        }
        entry["confidence_area"] = finite(person.confidence_area);
        entry["overconfidence"] = finite(person.overconfidence);
        entry["brier"] = finite(person.brier);
        entry["share_per_trial"] = finite(person.answers.trial);
        entry["share_since_break"] = finite(person.answers.since_break);
        entry["log_rt_per_trial"] = finite(person.log_rt.trial);
        entry["log_rt_since_break"] = finite(person.log_rt.since_break);
    }
    for (const Measure& measure : part.measures) {
        one["measures"][measure.key] = measure_json(report, part, measure);
    }
    for (const MixedStats& mixed : part.mixed) {
        one["mixed_model"][report.table.frictions[mixed.friction]] = mixed_json(mixed);
    }
    for (const ConfidenceLevel& level : part.levels) {
        one["confidence"].push_back({{"level", level.level},
                                     {"answers", level.n},
                                     {"people", level.share.people},
                                     {"share", level.share.mean},
                                     {"interval_95", ends(level.share.interval)}});
    }
    for (const auto& [key, test] : part.tests) {
        one["within_person"][key] = test_json(test);
    }
    return one;
}

}  // namespace

std::string stats_json(const StatsReport& report) {
    const TrialTable& table = report.table;
    const StatsOptions& options = report.options;
    Json all = {
        {"source", table.source},
        {"study", table.study.empty() ? Json(nullptr) : Json(table.study)},
        {"kind", table.kind.empty() ? Json(nullptr) : Json(table.kind)},
        {"answers", report.yes_no ? "yes_no" : "identification"},
        {"alternatives", report.yes_no ? Json(nullptr) : Json(table.alternatives)},
        {"signals", options.signals},
        {"outcome", report.right_known ? "correct" : "yes"},
        {"frictions", table.frictions},
        {"primary_test", table.primary ? Json(protocols::word_of(*table.primary)) : Json(nullptr)},
        {"seed", options.seed},
        {"permutations", options.permutations},
        {"simulations", options.simulations},
        {"bayes_prior", {{"name", "JZS"}, {"scale_r", options.prior_scale}}},
        {"versions", versions_json(table.versions)},
        {"left_out", table.left_out ? left_out_json(*table.left_out) : Json(nullptr)},
        {"excluded", Json::array()}};
    for (const ExcludedTrials& one : report.excluded) {
        all["excluded"].push_back(
            {{"subject", one.subject}, {"why", one.why}, {"trials", one.trials}});
    }
    all["applied"] = part_json(report, report.applied);
    all["not_applied"] =
        report.not_applied ? part_json(report, *report.not_applied) : Json(nullptr);
    return json_text(all) + '\n';
}

}  // namespace palpate::data

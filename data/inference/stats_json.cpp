#include <nlohmann/json.hpp>

#include "protocols/file/keys.hpp"
#include "data/csv/json_text.hpp"
#include "data/inference/stats_tables.hpp"

namespace palpate::data {
namespace {

Json part_json(const StatsReport& report, const StatsPart& part) {
    Json one = {{"answers", part.trials},         {"primary", Json::object()},
                {"people", Json::object()},       {"measures", Json::object()},
                {"mixed_model", Json::object()},  {"confidence", Json::array()},
                {"within_person", Json::object()}};
    for (const Table& table : stats_tables(report, part)) {
        put_table(one, table);
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

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "engine/base/text.hpp"
#include "protocols/file/keys.hpp"
#include "data/csv/json_text.hpp"
#include "data/inference/stats_report.hpp"
#include "data/inference/stats_tables.hpp"

namespace palpate::data {
namespace {

std::string title_text(const StatsReport& report) {
    const TrialTable& table = report.table;
    std::string text = table.source;
    if (!table.study.empty()) {
        text += text == "study " + table.study ? "" : ": study " + table.study;
        text += fmt::format(", {} data", table.kind);
        text += table.kind == "simulated" ? ": participant and device are SIMULATED"
              : table.kind == "pilot"     ? ": PILOT, not for analysis"
                                          : "";
    }
    if (report.yes_no) {
        text += "\n  Answers are yes and no; ";
        text += report.right_known
                  ? fmt::format("yes is right for {}", fmt::join(report.options.signals, ", "))
                  : "none is right or wrong: --signal SHAPE says for which yes is right";
    } else {
        text += fmt::format("\n  Answers name one of {} shapes: chance is {:.3f}",
                            table.alternatives, 1.0 / static_cast<double>(table.alternatives));
    }
    return text + fmt::format(
                      ".\n  Intervals are of 95 %. Nothing here pools the trials of several "
                      "people: the person is the unit. Seed {}.\n",
                      report.options.seed);
}

std::string excluded_text(const StatsReport& report) {
    const auto& account = report.table.left_out;
    std::string text = account ? left_out_text(*account) : std::string();
    if (report.excluded.empty()) {
        return text +
               (account ? "  Rules and marks leave nothing out: with and without these it is the "
                          "same.\n"
                        : "  Nothing is excluded: with and without exclusions it is the same.\n");
    }
    text += "  Excluded, and below left out first, then left in:\n";
    for (const ExcludedTrials& one : report.excluded) {
        text += fmt::format("    {}  {}: {}\n", one.subject, counted(one.trials, "trial"), one.why);
    }
    return text;
}

std::string part_text(const StatsReport& report, const StatsPart& part, const std::string& title) {
    std::string text =
        fmt::format("\n{}: {}, {}\n", title, counted(part.people.size(), "person", "people"),
                    counted(part.trials, "answer"));
    for (const Table& table : stats_tables(report, part)) {
        text += table_text(table);
    }
    return text;
}

}  // namespace

std::string stats_text(const StatsReport& report) {
    std::string text = title_text(report) + excluded_text(report);
    text += part_text(report, report.applied,
                      report.not_applied ? "Exclusions applied" : "All answers");
    if (report.not_applied) {
        text += part_text(report, *report.not_applied, "Exclusions NOT applied");
    }
    const std::string versions = versions_text(report.table.versions);
    return versions.empty() ? text : text + '\n' + versions;
}

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

std::string_view stats_script();  // stats.R

namespace {

/// A string of R, in ASCII: read the same in every locale.
std::string r_string(std::string_view text) {
    std::string out = "\"";
    while (!text.empty()) {
        const Character one = first_character(text);
        const bool plain =
            one.code >= U' ' && one.code < 127 && one.code != U'"' && one.code != U'\\';
        out += plain ? std::string(1, text.front())
             : one.code == U'"' || one.code == U'\\'
                 ? fmt::format("\\{}", text.front())
                 : fmt::format("\\U{{{:x}}}", static_cast<unsigned>(one.code));
        text.remove_prefix(std::max<std::size_t>(one.length, 1));
    }
    return out + '"';
}

std::string list_of(const std::vector<std::string>& all) {
    std::string text = "c(";
    for (const std::string& one : all) {
        text += (&one == all.data() ? "" : ", ") + r_string(one);
    }
    return text + ")";
}

}  // namespace

std::string stats_r(const StatsReport& report, const std::string& trials) {
    const auto& account = report.table.left_out;
    return fmt::format(
        "# The numbers of `palpate stats --json` again, by R, from the trials beside this "
        "script.\n{}# Each line that it prints is a place in that JSON (a JSON pointer), a tab, "
        "and the number.\n"
        "# Base R; the mixed model by Laplace needs lme4 (r-cran-lme4). What palpate draws by "
        "chance\n"
        "# (permutations, the simulated null) is not drawn again.\n"
        "data <- {}\nfrictions <- {}  # differences are from the first\nyes_no <- {}\n"
        "signals <- {}  # of yes/no: for which yes is right\nalternatives <- {}\n"
        "prior_scale <- {}\n\n{}",
        account ? remarked(left_out_text(without_words(*account))) : std::string(),
        r_string(trials), list_of(report.table.frictions), report.yes_no ? "TRUE" : "FALSE",
        list_of(report.options.signals), report.table.alternatives, report.options.prior_scale,
        stats_script());
}

}  // namespace palpate::data

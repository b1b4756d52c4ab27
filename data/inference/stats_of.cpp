#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "data/inference/stats_report.hpp"
#include "data/inference/stats_tables.hpp"

namespace palpate::data {
namespace {

void check_signals(const TrialTable& table, const StatsOptions& options) {
    for (const std::string& signal : options.signals) {
        if (std::ranges::find(table.shapes, signal) == table.shapes.end()) {
            throw std::invalid_argument(fmt::format("--signal is {}: give one of {}", signal,
                                                    fmt::join(table.shapes, ", ")));
        }
    }
    if (!options.signals.empty() && table.alternatives > 0) {
        throw std::invalid_argument(
            "--signal is for answers of yes and no alone: these are names of shapes, which are "
            "right or wrong by themselves");
    }
}

void check_alternatives(const TrialTable& table, const StatsOptions& options) {
    if (options.alternatives == 0) {
        return;
    }
    if (table.alternatives == 0) {
        throw std::invalid_argument(
            "--alternatives is for named shapes: these answers are yes and no");
    }
    if (options.alternatives < table.responses.size()) {
        throw std::invalid_argument(fmt::format(
            "--alternatives is {}: {} different answers were given; give as many or more",
            options.alternatives, table.responses.size()));
    }
}

bool is_probability(const TrialTable& table) {
    bool between = false;
    for (const Trial& one : table.trials) {
        const double sure = one.confidence.value_or(0.0);
        if (sure < 0.0 || sure > 1.0) {
            return false;
        }
        between = between || (sure > 0.0 && sure < 1.0);
    }
    return between;
}

std::vector<ExcludedTrials> excluded_of(const TrialTable& table) {
    std::vector<ExcludedTrials> all;
    for (const Trial& one : table.trials) {
        if (one.excluded.empty()) {
            continue;
        }
        const std::string& subject = table.subjects[one.subject];
        auto found = std::ranges::find_if(all, [&](const ExcludedTrials& other) {
            return other.subject == subject && other.why == one.excluded;
        });
        if (found == all.end()) {
            found = all.insert(all.end(), {.subject = subject, .why = one.excluded});
        }
        ++found->trials;
    }
    return all;
}

}  // namespace

PeopleTest test_of(std::vector<double> values, double nothing, double prior_scale) {
    PeopleTest made{.mean = mean_over_people(values)};
    std::vector<double> differences = values;
    for (double& one : differences) {
        one -= nothing;
    }
    made.values = std::move(values);
    made.t = paired_t(differences);
    made.flip = sign_flip(differences);
    made.rank = signed_rank(differences);
    if (made.t) {
        made.bayes = jzs_bayes_factor(made.t->t, differences.size(), prior_scale);
    }
    return made;
}

StatsReport stats_of(TrialTable table, const StatsOptions& options) {
    check_signals(table, options);
    check_alternatives(table, options);
    StatsReport report{.table = std::move(table), .options = options};
    const TrialTable& all = report.table;
    report.yes_no = all.alternatives == 0;
    report.right_known = !report.yes_no || !options.signals.empty();
    if (options.alternatives > 0) {
        report.table.alternatives = options.alternatives;
    }
    report.probability = is_probability(all);
    report.excluded = excluded_of(all);
    report.applied = part_of(report, [](const Trial& one) { return one.excluded.empty(); });
    if (report.applied.trials == 0) {
        throw std::invalid_argument(
            fmt::format("{}: all {} trials are excluded: nothing is left to compute", all.source,
                        all.trials.size()));
    }
    if (!report.excluded.empty()) {
        report.not_applied = part_of(report, [](const Trial&) { return true; });
    }
    return report;
}

}  // namespace palpate::data

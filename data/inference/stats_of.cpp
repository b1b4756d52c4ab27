#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "data/inference/stats_report.hpp"

namespace palpate::data {
namespace {

void check_signals(const TrialTable& table, const StatsOptions& options) {
    for (const std::string& signal : options.signals) {
        refuse_if(std::ranges::find(table.shapes, signal) == table.shapes.end(),
                  "--signal is {}: give one of {}", signal, fmt::join(table.shapes, ", "));
    }
    refuse_if(!options.signals.empty() && table.alternatives > 0,
              "--signal is for answers of yes and no alone: these are names of shapes, which are "
              "right or wrong by themselves");
}

void check_alternatives(const TrialTable& table, const StatsOptions& options) {
    if (options.alternatives == 0) {
        return;
    }
    refuse_if(table.alternatives == 0,
              "--alternatives is for named shapes: these answers are yes and no");
    refuse_if(options.alternatives < table.responses.size(),
              "--alternatives is {}: {} different answers were given; give as many or more",
              options.alternatives, table.responses.size());
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

using Of = std::optional<double> (*)(const PersonCell&);

template <std::optional<double> PersonCell::*Member>
std::optional<double> own(const PersonCell& cell) {
    return cell.*Member;
}

struct Kind {
    const char* key;
    const char* title;
    Of value;
};

constexpr Kind kKinds[] = {
    {"share", "",
     [](const PersonCell& cell) {
         return cell.n > 0
                  ? std::optional(static_cast<double>(cell.k) / static_cast<double>(cell.n))
                  : std::nullopt;
     }},
    {"d_prime", "d'", own<&PersonCell::alike_d_prime>},
    {"criterion", "criterion c", own<&PersonCell::alike_criterion>},
    {"bits", "transmitted bits (Miller-Madow)",
     [](const PersonCell& cell) {
         return cell.bits ? std::optional(cell.bits->bits.corrected) : std::nullopt;
     }},
    {"log_rt", "ln of response time in s", own<&PersonCell::log_rt>},
    {"log_explore", "ln of felt s (first contact to done)", own<&PersonCell::log_explore>},
    {"confidence", "confidence", own<&PersonCell::confidence>},
};

/// Of one value or more. @param size  as of mean_over_people()
PeopleTest test_of(std::vector<double> values,
                   double nothing,
                   double prior_scale,
                   double size = 0.0) {
    PeopleTest made{.mean = mean_over_people(values, size)};
    std::vector<double> differences = values;
    for (double& one : differences) {
        size = std::max(size, std::fabs(one));
        one -= nothing;
    }
    made.values = std::move(values);
    made.t = paired_t(differences, size);
    made.flip = sign_flip(differences);
    made.rank = signed_rank(differences);
    if (made.t) {
        made.bayes = jzs_bayes_factor(made.t->t, differences.size(), prior_scale);
    }
    return made;
}

Measure measure_of(const StatsReport& report, const StatsPart& part, const Kind& kind) {
    Measure made{.key = kind.key, .title = kind.title};
    for (const PersonStats& person : part.people) {
        auto& row = made.values.emplace_back();
        for (const PersonCell& cell : person.cells) {
            row.push_back(kind.value(cell));
        }
    }
    const bool share = made.key == "share";
    for (std::size_t friction = 0; friction < report.table.frictions.size(); ++friction) {
        std::vector<double> values;
        std::vector<double> differences;
        double size = 0.0;
        for (const auto& row : made.values) {
            if (row[friction]) {
                values.push_back(*row[friction]);
            }
            if (friction > 0 && row[friction] && row[0]) {
                size = std::max({size, std::fabs(*row[friction]), std::fabs(*row[0])});
                differences.push_back(difference_of(*row[0], *row[friction]));
            }
        }
        made.means.push_back(values.empty() ? std::nullopt
                             : share        ? std::optional(mean_share_over_people(values))
                                            : std::optional(mean_over_people(values)));
        made.effects.push_back(differences.empty()
                                   ? std::nullopt
                                   : std::optional(test_of(std::move(differences), 0.0,
                                                           report.options.prior_scale, size)));
    }
    return made;
}

}  // namespace

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
    refuse_if(report.applied.trials == 0,
              "{}: all {} trials are excluded: nothing is left to compute{}", all.source,
              all.trials.size(), below(all.left_out));
    if (!report.excluded.empty()) {
        report.not_applied = part_of(report, [](const Trial&) { return true; });
    }
    return report;
}

std::string share_title(const StatsReport& report) {
    return report.right_known ? "share correct" : "share of yes";
}

void add_measures(const StatsReport& report, StatsPart& part) {
    for (const Kind& kind : kKinds) {
        Measure measure = measure_of(report, part, kind);
        if (measure.key == "share") {
            measure.title = share_title(report);
        }
        if (std::ranges::any_of(measure.means, [](const auto& mean) { return mean.has_value(); })) {
            part.measures.push_back(std::move(measure));
        }
    }
}

void add_tests(const StatsReport& report, StatsPart& part) {
    const auto add = [&](const char* key, double nothing, const auto& value) {
        std::vector<double> values;
        for (const PersonStats& person : part.people) {
            if (const std::optional<double> one = value(person)) {
                values.push_back(*one);
            }
        }
        if (!values.empty()) {
            part.tests.emplace_back(
                key, test_of(std::move(values), nothing, report.options.prior_scale));
        }
    };
    add("confidence_area", 0.5, [](const PersonStats& one) { return one.confidence_area; });
    add("overconfidence", 0.0, [](const PersonStats& one) { return one.overconfidence; });
    add("share_per_trial", 0.0, [](const PersonStats& one) { return one.answers.trial; });
    add("share_since_break", 0.0, [](const PersonStats& one) { return one.answers.since_break; });
    add("log_rt_per_trial", 0.0, [](const PersonStats& one) { return one.log_rt.trial; });
    add("log_rt_since_break", 0.0, [](const PersonStats& one) { return one.log_rt.since_break; });
}

std::vector<std::string> without_both(const StatsPart& part,
                                      const Measure& measure,
                                      std::size_t friction) {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < part.people.size(); ++i) {
        const auto& row = measure.values[i];
        if (!row[0] || !row[friction]) {
            names.push_back(part.people[i].subject);
        }
    }
    return names;
}

}  // namespace palpate::data

#include <algorithm>
#include <cmath>

#include "data/inference/stats_tables.hpp"

namespace palpate::data {
namespace {

using Of = std::optional<double> (*)(const PersonCell&);

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
    {"d_prime", "d'",
     [](const PersonCell& cell) {
         return cell.alike_d_prime;
     }},
    {"criterion", "criterion c",
     [](const PersonCell& cell) {
         return cell.alike_criterion;
     }},
    {"bits", "transmitted bits (Miller-Madow)",
     [](const PersonCell& cell) {
         return cell.bits ? std::optional(cell.bits->corrected) : std::nullopt;
     }},
    {"log_rt", "ln of response time in s",
     [](const PersonCell& cell) {
         return cell.log_rt;
     }},
    {"log_explore", "ln of felt s (first contact to done)",
     [](const PersonCell& cell) {
         return cell.log_explore;
     }},
    {"confidence", "confidence",
     [](const PersonCell& cell) {
         return cell.confidence;
     }},
};

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
        for (const auto& row : made.values) {
            if (row[friction]) {
                values.push_back(*row[friction]);
            }
            if (friction > 0 && row[friction] && row[0]) {
                const double max = std::max(std::fabs(*row[friction]), std::fabs(*row[0]));
                const double difference = *row[friction] - *row[0];
                // Equal answers in another number differ in their last bits, and all to one side.
                differences.push_back(std::fabs(difference) <= 1e-12 * max ? 0.0 : difference);
            }
        }
        made.means.push_back(values.empty() ? std::nullopt
                             : share        ? std::optional(mean_share_over_people(values))
                                            : std::optional(mean_over_people(values)));
        made.effects.push_back(
            differences.empty()
                ? std::nullopt
                : std::optional(test_of(std::move(differences), 0.0, report.options.prior_scale)));
    }
    return made;
}

}  // namespace

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

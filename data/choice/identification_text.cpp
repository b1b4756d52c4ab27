#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "engine/base/text.hpp"
#include "data/choice/identification.hpp"
#include "data/csv/json_text.hpp"

namespace palpate::data {
namespace {

/// "concave and flat (up to 0.21)": pairs that were never confused.
std::string never_confused(const IdentificationReport& report,
                           const IdentifiedPerson& person,
                           std::size_t f) {
    std::string text;
    for (std::size_t i = 0; i < report.names.size(); ++i) {
        for (std::size_t j = i + 1; j < report.names.size(); ++j) {
            if (person.counts[f][i][j] + person.counts[f][j][i] == 0) {
                text += fmt::format("{}{} and {} (0 to {:.2g})", text.empty() ? "" : ", ",
                                    report.names[i], report.names[j],
                                    person.similarity[f]->intervals[i][j].high);
            }
        }
    }
    return text;
}

/// Names of the items of each group.
std::vector<std::vector<std::string>> named_groups(const IdentificationReport& report,
                                                   const SimilarityFit& fit) {
    std::vector<std::vector<std::string>> all;
    for (const auto& group : fit.groups) {
        auto& names = all.emplace_back();
        for (const std::size_t item : group) {
            names.push_back(report.names[item]);
        }
    }
    return all;
}

/// What the answers of a person leave at a boundary, and how the answers were biased.
void add_notes(const IdentificationReport& report,
               const IdentifiedPerson& person,
               std::size_t f,
               Table& table) {
    const auto& fit = person.similarity[f];
    const std::string& friction = report.table.frictions[f];
    if (!fit) {
        table.notes.push_back(
            fmt::format("{}, no similarities: {}", friction, person.no_similarity[f]));
        return;
    }
    std::string bias;
    for (std::size_t j = 0; j < report.names.size(); ++j) {
        bias += fmt::format("{} {} {:.2f}", j > 0 ? "," : "", report.names[j], fit->bias[j]);
    }
    table.notes.push_back(fmt::format("{}, bias:{}", friction, bias));
    if (fit->groups.size() > 1) {
        std::vector<std::string> groups;
        for (const auto& names : named_groups(report, *fit)) {
            groups.push_back(fmt::format("{}", fmt::join(names, ", ")));
        }
        table.notes.push_back(fmt::format(
            "{}, biases have a ratio within each of these alone, which no confusion links: {}",
            friction, fmt::join(groups, " | ")));
    }
    if (const std::string never = never_confused(report, person, f); !never.empty()) {
        table.notes.push_back(
            fmt::format("{}, at the boundary, never confused: {}", friction, never));
    }
    for (const auto& [i, j] : fit->one_way) {
        table.notes.push_back(fmt::format(
            "{}, at the boundary: {} and {} were confused one way alone: similarity 0 (to "
            "{:.2g}), and the biases on either side have no ratio",
            friction, report.names[i], report.names[j], fit->intervals[i][j].high));
    }
}

/// A row a friction; changes are against the first.
Table conditions_table(const IdentificationReport& report, const IdentifiedPerson& person) {
    Table table{.place = "conditions/-",
                .title = person.name,
                .columns = heads({"friction", "sigma|sigma|s", "sigma_95|interval|so",
                                  "ratio|ratio|s", "ratio_95|interval|so", "ratio_p|p|p",
                                  "shift|shift|s", "shift_95|interval|so", "shift_p|p|p",
                                  "mean_similarity|mean similarity|s", "similarity_deviance|"})};
    for (std::size_t f = 0; f < report.table.frictions.size(); ++f) {
        const ThurstonePart& part = person.thurstone.parts[f];
        const auto& fit = person.similarity[f];
        const bool changes = f > 0 && part.end != SigmaEnd::unknown;
        const ThurstoneChange change = changes ? person.changes[f - 1] : ThurstoneChange{};
        const auto of_change = [&](Cell cell) {
            return changes ? std::move(cell) : Cell(Nothing{});
        };
        table.rows.push_back(
            {report.table.frictions[f],
             part.end == SigmaEnd::both ? cell_of(part.sigma)
                                        : Cell(Nothing{why_unbounded(part.end)}),
             cell_of(part.sigma_interval), of_change(cell_of(change.ratio, "no end")),
             of_change(change.ratio_interval), of_change(change.ratio_p),
             of_change(cell_of(change.shift, "no end")), of_change(change.shift_interval),
             of_change(change.shift_p), fit ? cell_of(mean_similarity(*fit)) : Cell(Nothing{}),
             fit ? cell_of(fit->deviance) : Cell(Nothing{})});
        add_notes(report, person, f, table);
    }
    const ThurstoneFit& fit = person.thurstone;
    table.notes.push_back(fit.df > 0
                              ? fmt::format("Deviance {:.1f} of {} df.", fit.deviance, fit.df)
                              : "No goodness of fit: no answers are left to say it.");
    if (!person.thurstone.agree) {
        table.notes.push_back(
            fmt::format("The optimisers end apart, at log-likelihoods of {:.9g} and {:.9g}: the "
                        "larger is taken.",
                        person.thurstone.first, person.thurstone.second));
    }
    return table;
}

/// Of a condition, what is no number: tables of items by items.
void add_matrices(const IdentificationReport& report,
                  const IdentifiedPerson& person,
                  std::size_t f,
                  Json& friction) {
    friction["counts"] = person.counts[f];
    friction["similarity_why"] =
        person.no_similarity[f].empty() ? Json(nullptr) : Json(person.no_similarity[f]);
    if (const auto& fit = person.similarity[f]; fit) {
        friction["bias"] = fit->bias;
        friction["bias_groups"] = named_groups(report, *fit);
        friction["similarity"] = fit->similarity;
        friction["similarity_95"] = Json::array();
        for (const auto& row : fit->intervals) {
            Json ends = Json::array();
            for (const Interval& both : row) {
                ends.push_back({both.low, both.high});
            }
            friction["similarity_95"].push_back(ends);
        }
        friction["similarity_one_way"] = Json::array();
        for (const auto& [i, j] : fit->one_way) {
            friction["similarity_one_way"].push_back({report.names[i], report.names[j]});
        }
    }
}

Json person_json(const IdentificationReport& report, const IdentifiedPerson& person) {
    Json one = {{"participant", person.name},
                {"log_likelihood", person.thurstone.log_likelihood},
                {"log_likelihood_climbed", person.thurstone.first},
                {"log_likelihood_nelder_mead", person.thurstone.second},
                {"optimisers_agree", person.thurstone.agree},
                {"deviance", person.thurstone.deviance},
                {"df", person.thurstone.df}};
    const bool scale = std::ranges::any_of(person.thurstone.parts, [](const ThurstonePart& part) {
        return part.end == SigmaEnd::both || part.end == SigmaEnd::sharp;
    });
    for (const double criterion : person.thurstone.criteria) {
        one["criteria"].push_back(scale ? Json(criterion) : Json(nullptr));
    }
    put_table(one, conditions_table(report, person));
    for (std::size_t f = 0; f < report.table.frictions.size(); ++f) {
        add_matrices(report, person, f, one["conditions"][f]);
    }
    return one;
}

}  // namespace

std::string identification_text(const IdentificationReport& report) {
    std::string out = fmt::format("{}: {}, {}\n", report.table.source,
                                  counted(report.people.size(), "person", "people"),
                                  counted(report.names.size(), "item"));
    out += report.table.left_out ? left_out_text(*report.table.left_out) : std::string();
    out += "Items:";
    for (std::size_t i = 0; i < report.names.size(); ++i) {
        out += fmt::format("{} {} ({:g})", i > 0 ? "," : "", report.names[i], report.values[i]);
    }
    out += fmt::format(
        "\nThurstone: sigma in the unit of the items, one a friction; criteria the same in all; "
        "lapses {:g}.\n"
        "Similarity choice: 0 never confused, 1 alike; biases of the answers sum to 1.\n"
        "Intervals: 95 %, by profile likelihood; inf: no end that the answers bound. Changes are "
        "against {}.\n",
        report.options.lapse, report.table.frictions.front());
    for (const IdentifiedPerson& person : report.people) {
        out += table_text(conditions_table(report, person));
    }
    out += table_text(over_people_table("over_people/-", report.over_people));
    for (const std::string& who : report.left_out) {
        out += fmt::format("\nLeft out: {}\n", plain(who));
    }
    const std::string versions = versions_text(report.table.versions);
    return versions.empty() ? out : out + '\n' + versions;
}

std::string identification_json(const IdentificationReport& report) {
    Json all = {{"source", report.table.source},
                {"items", report.names},
                {"values", report.values},
                {"lapse", report.options.lapse},
                {"frictions", report.table.frictions},
                {"versions", versions_json(report.table.versions)},
                {"left_out",
                 report.table.left_out ? left_out_json(*report.table.left_out) : Json(nullptr)}};
    for (const IdentifiedPerson& person : report.people) {
        all["people"].push_back(person_json(report, person));
    }
    put_table(all, over_people_table("over_people/-", report.over_people));
    all["not_fitted"] = report.left_out;
    return json_text(all);
}

}  // namespace palpate::data

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "protocols/file/protocol_file.hpp"
#include "data/analysis/summary.hpp"
#include "data/statistics/paired.hpp"

namespace palpate::data {
namespace {

std::string why_none(std::size_t people) {
    return people == 1
             ? "one person: how people differ is not known"
             : fmt::format("{} people with the same value: how people differ is not known", people);
}

/// Those who have both conditions.
struct Pairs {
    std::vector<double> differences;
    std::optional<Interval> own;  ///< of the only person's trials
};

Pairs pairs_of(const PeopleTable& table, const std::string& first, const std::string& other) {
    Pairs pairs;
    for (const auto& [person, has] : table.people) {
        const auto a = has.find(first);
        const auto b = has.find(other);
        if (a == has.end() || b == has.end()) {
            continue;
        }
        pairs.differences.push_back(b->second.mean - a->second.mean);
        pairs.own = std::nullopt;
        if (table.share && pairs.differences.size() == 1) {
            pairs.own = newcombe(a->second.sum, a->second.n, b->second.sum, b->second.n);
        }
    }
    return pairs;
}

/// What the sign-flip tests of so many people are, and what so few cannot show.
/// @param tested  how many people a test has, and whether all patterns were counted
void add_flip_notes(Table& table, const std::map<std::size_t, bool>& tested) {
    for (const auto& [people, exact] : tested) {
        const double patterns = std::ldexp(1.0, static_cast<int>(people));
        table.notes.push_back(
            fmt::format("sign-flip{}: {} patterns of signs",
                        tested.size() > 1 ? fmt::format(" of {} people", people) : std::string(),
                        exact ? fmt::format("all {:.0f}", patterns) : "1,000,000 drawn"));
    }
    for (const auto& [people, exact] : tested) {
        const double least = std::ldexp(1.0, 1 - static_cast<int>(people));
        if (least > 0.05) {
            table.notes.push_back(fmt::format(
                "{} people are too few to show a difference: no sign-flip p is below {:g}", people,
                least));
        }
    }
}

Table persons_table(const PeopleTable& table) {
    Table made{
        .place = "people/*/*",
        .title = fmt::format("  {}, person by person{}", table.what,
                             table.share ? " (95 % Wilson interval of the person's share)" : ""),
        .columns = {{.key = "person", .words = "person"},
                    {.key = table.factor, .words = table.factor},
                    {.key = "k", .words = "k"},
                    {.key = "n", .words = table.share ? "of n" : "n"},
                    {.key = "mean", .words = table.share ? "share" : "mean"},
                    {.key = "interval_95", .words = "interval"}},
        .index = 2};
    for (const auto& [person, has] : table.people) {
        for (const std::string& condition : table.conditions) {
            const auto own = has.find(condition);
            if (own == has.end()) {
                continue;
            }
            const auto& [mean, sum, n] = own->second;
            made.rows.push_back({person, condition, table.share ? Cell(sum) : Cell(Nothing{}), n,
                                 cell_of(mean),
                                 table.share ? Cell(wilson(sum, n)) : Cell(Nothing{})});
        }
    }
    return made;
}

Table means_table(const PeopleTable& table) {
    Table made{.place = "means/*",
               .title = fmt::format("  {}, mean over people (95 % interval over people, t{})",
                                    table.what, table.share ? " of the logit" : ""),
               .columns = {{.key = table.factor, .words = " "},
                           {.key = "mean", .words = "mean"},
                           {.key = "interval_95", .words = "interval"},
                           {.key = "people", .words = "people"}}};
    for (const std::string& condition : table.conditions) {
        std::vector<double> values;
        for (const auto& [person, has] : table.people) {
            const auto own = has.find(condition);
            if (own != has.end()) {
                values.push_back(own->second.mean);
            }
        }
        if (values.empty()) {
            continue;
        }
        const PeopleMean mean =
            table.share ? mean_share_over_people(values) : mean_over_people(values);
        made.rows.push_back({Named{condition, fmt::format("{} {}", table.factor, condition)},
                             cell_of(mean.mean), cell_of(mean.interval, why_none(mean.people)),
                             cell_of(mean.people)});
    }
    return made;
}

/// Each condition against the first, within person.
Table differences_table(const PeopleTable& table) {
    Table made{.place = "differences/*",
               .title = "  within person",
               .columns = heads({"comparison| ", "mean", "interval_95|interval", "people",
                                 "sign_flip_p|sign-flip p|p",
                                 "own_95|of this person's own trials (Newcombe), not of people"})};
    std::map<std::size_t, bool> tested;
    for (std::size_t i = 1; i < table.conditions.size(); ++i) {
        const std::string& other = table.conditions[i];
        const Pairs pairs = pairs_of(table, table.conditions.front(), other);
        const std::size_t n = pairs.differences.size();
        const Named name{other, fmt::format("{} - {}", other, table.conditions.front())};
        if (n == 0) {
            made.rows.push_back(
                {name, Nothing{"nobody has both"}, Nothing{}, cell_of(n), Nothing{}, Nothing{}});
            continue;
        }
        const PeopleMean mean = mean_over_people(pairs.differences, table.share ? 1.0 : 0.0);
        const SignFlip test = sign_flip(pairs.differences);
        made.rows.push_back({name, cell_of(mean.mean), cell_of(mean.interval, why_none(n)),
                             cell_of(n), n > 1 ? Cell(test.p) : Cell(Nothing{}),
                             n == 1 ? cell_of(pairs.own) : Cell(Nothing{})});
        if (n > 1) {
            tested[n] = test.exact;
        }
    }
    add_flip_notes(made, tested);
    return made;
}

/// How a study asks, as its responses say.
enum class Asks : std::uint8_t { correct, yes, level };

/// Where answers are neither right nor wrong, yes/no and ratings are distinguished by the last
/// protocol.
Asks asks(Database& database, const Group& group) {
    Statement row = database.prepare(
        "SELECT protocol_toml FROM study WHERE study_name = ?1 ORDER BY study_id DESC LIMIT 1");
    try {
        const auto kind = row.bind(1, group.study).step()
                            ? protocols::stored_protocol(row.text(0)).response.kind
                            : protocols::ResponseKind::identification;
        return kind == protocols::ResponseKind::yes_no ? Asks::yes
             : kind == protocols::ResponseKind::rating ? Asks::level
                                                       : Asks::correct;
    } catch (const protocols::ProtocolError&) {
        return Asks::correct;  // palpate verify says it
    }
}

/// @param object  empty: of all objects
PeopleTable table_of(Database& database,
                     const Group& group,
                     Asks what,
                     const std::string& object,
                     const std::string& title) {
    PeopleTable table{.what = title,
                      .factor = "friction",
                      .share = what != Asks::level,
                      .conditions = planned(database, group, "friction", "mu_s")};
    const std::string value = what == Asks::correct ? "analysis_trial.correct"
                            : what == Asks::yes     ? "answer_code"
                                                    : "answer_code + 1";
    Statement row = database.prepare(
        "SELECT participant_code, friction, sum(" + value + "), count(" + value +
            ") FROM analysis_trial WHERE counts AND study_name = ?1 AND session_kind = ?2 AND "
            "phase = 'main' AND (?3 = '' OR analysis_trial.planned_object = ?3) AND " +
            value +
            " IS NOT NULL AND NOT EXISTS (SELECT 1 FROM adaptive_step WHERE adaptive_step.trial_id "
            "= analysis_trial.trial_id) GROUP BY 1, 2",
        group.study, group.kind, object);
    while (row.step()) {
        table.people[row.text(0)][row.text(1)] = {
            .mean = static_cast<double>(row.integer(2)) / static_cast<double>(row.integer(3)),
            .sum = row.integer(2),
            .n = row.integer(3)};
    }
    return table;
}

}  // namespace

PeopleTable without(PeopleTable table, const std::set<std::string>& left_out) {
    std::erase_if(table.people, [&](const auto& one) { return left_out.contains(one.first); });
    return table;
}

std::string people_text(const PeopleTable& table) {
    return table_text(means_table(table)) + table_text(differences_table(table));
}

Json people_json(const PeopleTable& table) {
    Json all = {{"what", table.what},       {"factor", table.factor},
                {"people", Json::object()}, {"means", Json::object()},
                {"less", Json(nullptr)},    {"differences", Json::object()}};
    if (table.conditions.size() > 1) {
        all["less"] = table.conditions.front();
    }
    for (const Table& one : {persons_table(table), means_table(table), differences_table(table)}) {
        put_table(all, one);
    }
    return all;
}

std::vector<std::string> planned(Database& database,
                                 const Group& group,
                                 const std::string& what,
                                 const std::string& by) {
    return texts(database.prepare(
        fmt::format("SELECT {0} FROM plan JOIN session USING (session_id) JOIN study USING "
                    "(study_id) WHERE study_name = ?1 AND session_kind = ?2 AND phase = 'main' "
                    "GROUP BY 1 ORDER BY min({1}), {0}",
                    what, by),
        group.study, group.kind));
}

std::vector<PeopleTable> answers_tables(Database& database, const Group& group) {
    const Asks what = asks(database, group);
    std::vector<std::string> objects{""};
    if (what != Asks::correct) {
        objects = planned(database, group, "planned_object", "curvature_per_m");
    }
    std::vector<PeopleTable> tables;
    for (const std::string& object : objects) {
        tables.push_back(table_of(database, group, what, object,
                                  what == Asks::correct ? "share correct"
                                  : what == Asks::yes
                                      ? "share of yes to " + object
                                      : "mean level of " + object + ", 1 the lowest"));
    }
    std::erase_if(tables, [](const PeopleTable& table) { return table.people.empty(); });
    return tables;
}

std::string answers_text(Database& database,
                         const Group& group,
                         const std::set<std::string>& left_out) {
    std::string text;
    for (const PeopleTable& table : answers_tables(database, group)) {
        if (left_out.empty()) {
            text += table_text(persons_table(table));
        }
        text += people_text(without(table, left_out));
    }
    return text;
}

}  // namespace palpate::data

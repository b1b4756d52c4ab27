#include "data/analysis/people_text.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "protocols/file/protocol_file.hpp"
#include "data/statistics/over_people.hpp"

namespace palpate::data {
namespace {

std::string interval_text(const std::optional<Interval>& interval) {
    return interval ? fmt::format("{:.3f} to {:.3f}", interval->low, interval->high)
                    : std::string("no interval");
}

std::string why_none(std::size_t people) {
    return people == 1
             ? "one person: how people differ is not known"
             : fmt::format("{} people with the same value: how people differ is not known", people);
}

std::string line(std::string_view name, std::size_t width, double value, const std::string& rest) {
    return fmt::format("    {:<{}}  {:>6.3f}   {}\n", name, width, value, rest);
}

/// Those who have both conditions.
struct Pairs {
    std::vector<double> differences;
    std::optional<Interval> own;  ///< of the only person's trials
};

Pairs pairs_of(const PeopleTable& table,
               const std::set<std::string>& left_out,
               const std::string& first,
               const std::string& other) {
    Pairs pairs;
    for (const auto& [person, has] : table.people) {
        const auto a = has.find(first);
        const auto b = has.find(other);
        if (left_out.contains(person) || a == has.end() || b == has.end()) {
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

std::string test_text(const std::vector<double>& differences) {
    const SignFlip test = sign_flip(differences);
    const std::size_t n = differences.size();
    const auto patterns = static_cast<int>(n);
    return fmt::format("{} people; sign-flip p = {:.3g} ({})", n, test.p,
                       test.exact
                           ? fmt::format("all {:.0f} patterns of signs", std::ldexp(1.0, patterns))
                           : "1,000,000 patterns of signs drawn");
}

/// What so few people cannot show.
std::string limit_text(const PeopleTable& table, const std::set<std::string>& left_out) {
    const auto kept = std::ranges::count_if(
        table.people, [&](const auto& one) { return !left_out.contains(one.first); });
    const double least = std::ldexp(1.0, 1 - static_cast<int>(kept));
    return kept < 2 || least <= 0.05 || table.conditions.size() < 2
             ? std::string()
             : fmt::format(
                   "    {} people are too few to show a difference: no sign-flip p is below {:g}\n",
                   kept, least);
}

std::string difference_text(const PeopleTable& table,
                            const std::set<std::string>& left_out,
                            const std::string& other,
                            std::size_t width) {
    const std::string& first = table.conditions.front();
    const std::string name = fmt::format("{} - {}", other, first);
    const Pairs pairs = pairs_of(table, left_out, first, other);
    const std::size_t n = pairs.differences.size();
    if (n == 0) {
        return fmt::format("    {:<{}}  nobody has both\n", name, width);
    }
    const PeopleMean mean = mean_over_people(pairs.differences);
    if (n == 1) {
        return line(name, width, mean.mean,
                    pairs.own ? interval_text(pairs.own) +
                                    "   of this person's own trials (Newcombe), not of people"
                              : "no interval   of this person, not of people");
    }
    return line(name, width, mean.mean,
                interval_text(mean.interval) + "   within person, " + test_text(pairs.differences));
}

std::string own_text(const Own& own, bool share) {
    if (!share) {
        return fmt::format("{:.2f} ({})", own.mean, counted(own.n, "answer"));
    }
    const Interval ci = wilson(own.sum, own.n);
    return fmt::format("{:>3} of {:>3} = {:.2f} ({:.2f} to {:.2f})", own.sum, own.n, own.mean,
                       ci.low, ci.high);
}

std::string persons_text(const PeopleTable& table) {
    std::string text;
    std::size_t width = 4;
    for (const auto& [person, has] : table.people) {
        width = std::max(width, person.size());
    }
    const int column = table.share ? 32 : 20;
    text += fmt::format("    {:<{}}", "", width);
    for (const std::string& condition : table.conditions) {
        text += fmt::format("   {:<{}}", table.factor + ' ' + condition, column);
    }
    text = text.substr(0, text.find_last_not_of(' ') + 1) + '\n';
    for (const auto& [person, has] : table.people) {
        std::string row = fmt::format("    {:<{}}", person, width);
        for (const std::string& condition : table.conditions) {
            const auto own = has.find(condition);
            row += fmt::format("   {:<{}}",
                               own == has.end() ? "no answer" : own_text(own->second, table.share),
                               column);
        }
        text += row.substr(0, row.find_last_not_of(' ') + 1) + '\n';
    }
    return text;
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

std::vector<std::string> names(Database& database, const Group& group, const std::string& order) {
    Statement row = database.prepare(
        "SELECT " + order.substr(0, order.find(' ')) +
        " FROM plan JOIN session USING (session_id) JOIN study USING (study_id) WHERE study_name = "
        "?1 AND session_kind = ?2 AND phase = 'main' GROUP BY 1 ORDER BY " +
        order.substr(order.find(' ') + 1));
    row.bind(1, group.study).bind(2, group.kind);
    std::vector<std::string> all;
    while (row.step()) {
        all.push_back(row.text(0));
    }
    return all;
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
                      .conditions = names(database, group, "friction min(mu_s), friction")};
    const std::string value = what == Asks::correct ? "analysis_trial.correct"
                            : what == Asks::yes     ? "answer_code"
                                                    : "answer_code + 1";
    Statement row = database.prepare(
        "SELECT participant_code, friction, sum(" + value + "), count(" + value +
        ") FROM analysis_trial WHERE counts AND study_name = ?1 AND session_kind = ?2 AND phase = "
        "'main' AND (?3 = '' OR analysis_trial.planned_object = ?3) AND " +
        value +
        " IS NOT NULL AND NOT EXISTS (SELECT 1 FROM adaptive_step WHERE adaptive_step.trial_id = "
        "analysis_trial.trial_id) GROUP BY 1, 2");
    row.bind(1, group.study).bind(2, group.kind).bind(3, object);
    while (row.step()) {
        table.people[row.text(0)][row.text(1)] = {
            .mean = static_cast<double>(row.integer(2)) / static_cast<double>(row.integer(3)),
            .sum = row.integer(2),
            .n = row.integer(3)};
    }
    return table;
}

}  // namespace

std::string table_text(const PeopleTable& table, const std::set<std::string>& left_out) {
    std::size_t width = 0;
    for (const std::string& condition : table.conditions) {
        width = std::max({width, table.factor.size() + 1 + condition.size(),
                          condition.size() + 3 + table.conditions.front().size()});
    }
    std::string text =
        fmt::format("\n  {}, mean over people (95 % interval over people, t)\n", table.what);
    for (const std::string& condition : table.conditions) {
        std::vector<double> values;
        for (const auto& [person, has] : table.people) {
            const auto own = has.find(condition);
            if (own != has.end() && !left_out.contains(person)) {
                values.push_back(own->second.mean);
            }
        }
        if (values.empty()) {
            continue;
        }
        const PeopleMean mean =
            table.share ? mean_share_over_people(values) : mean_over_people(values);
        text += line(fmt::format("{} {}", table.factor, condition), width, mean.mean,
                     mean.interval
                         ? fmt::format("{}   {} people", interval_text(mean.interval), mean.people)
                         : "no interval   " + why_none(mean.people));
    }
    for (std::size_t i = 1; i < table.conditions.size(); ++i) {
        text += difference_text(table, left_out, table.conditions[i], width);
    }
    return text + limit_text(table, left_out);
}

std::string answers_text(Database& database,
                         const Group& group,
                         const std::set<std::string>& left_out) {
    const Asks what = asks(database, group);
    std::vector<std::string> objects{""};
    if (what != Asks::correct) {
        objects = names(database, group, "planned_object min(curvature_per_m), planned_object");
    }
    std::string text;
    for (const std::string& object : objects) {
        const PeopleTable table =
            table_of(database, group, what, object,
                     what == Asks::correct ? "share correct"
                     : what == Asks::yes   ? "share of yes to " + object
                                           : "mean level of " + object + ", 1 the lowest");
        if (table.people.empty()) {
            continue;
        }
        if (left_out.empty()) {
            text +=
                fmt::format("\n  {}, person by person{}\n", table.what,
                            table.share ? " (95 % Wilson interval of the person's share)" : "") +
                persons_text(table);
        }
        text += table_text(table, left_out);
    }
    return text;
}

std::string no_correct_text(Database& database, const Group& group) {
    Statement row = database.prepare(
        "SELECT count(*) - count(correct), count(*) FROM analysis_trial WHERE counts AND "
        "study_name = ?1 AND session_kind = ?2 AND phase = 'main'");
    row.bind(1, group.study).bind(2, group.kind).step();
    return row.integer(0) == 0
             ? std::string()
             : fmt::format("\n  {} of {} have no correct (NULL): neither right nor wrong\n",
                           row.integer(0), counted(row.integer(1), "answer"));
}

}  // namespace palpate::data

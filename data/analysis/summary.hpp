#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "protocols/protocol/protocol.hpp"
#include "data/csv/json_text.hpp"
#include "data/store/database.hpp"
#include "data/tables/table.hpp"

namespace palpate::data {

/// What a person wants to see first, for a terminal: by study and run kind the confusion matrix;
/// the share correct person by person, its mean over people, and friction as a difference within a
/// person (people_text()); what a rule estimates; and what the file is called. Simulated and
/// pilot data are never added to real ones, and say so in their title. Where the protocol has rules
/// of exclusion what is said over people comes twice: of everybody who consents, and without those
/// whom the rules leave out. left_out.hpp says who that is.
[[nodiscard]] std::string summary_text(Database& database);
/// The same for programs: a member of `studies` for each study and run kind.
[[nodiscard]] std::string summary_json(Database& database);

/// Two queries to try, as they may be pasted into a shell; `file` is quoted.
[[nodiscard]] std::string example_queries(const std::string& file);

// -------------------------------------------------------------------------------------------------
// What a summary says of people: each for themselves, all together, and differences within a
// person.

/// The sessions of a study (the protocol's id) of one run kind.
struct Group {
    std::string study;
    std::string kind;  ///< real, pilot, simulated
};

/// What a person has under a condition.
struct Own {
    double mean = 0.0;
    std::int64_t sum = 0;  ///< of a share: how many were correct, or yes
    std::int64_t n = 0;    ///< answers that count
};

struct PeopleTable {
    std::string what;                       ///< "share correct"
    std::string factor;                     ///< "friction", "run"
    bool share = true;                      ///< the means are shares of answers, from 0 to 1
    std::vector<std::string> conditions{};  ///< differences are from the first
    std::map<std::string, std::map<std::string, Own>> people{};  ///< by pseudonym, then condition
};

/// The mean over people of each condition with a 95 % interval over people, and each condition
/// against the first: the difference within a person, its interval, and an exact sign-flip p. With
/// one person the difference is that of their own trials, and it says that nothing follows for
/// others.
[[nodiscard]] std::string people_text(const PeopleTable& table);
/// The same for programs, with each person's own.
[[nodiscard]] Json people_json(const PeopleTable& table);
/// The table of the others.
[[nodiscard]] PeopleTable without(PeopleTable table, const std::set<std::string>& left_out);

/// What the plans of main trials have of a column, all of it, by the least number of another.
[[nodiscard]] std::vector<std::string> planned(Database& database,
                                               const Group& group,
                                               const std::string& what,
                                               const std::string& by);

/// Of main trials without a rule, by friction: the share correct; of yes/no answers the share of
/// yes and of ratings the mean level, object by object. Person by person (unless somebody is left
/// out: then it stands above), then over people. Empty without such an answer.
[[nodiscard]] std::vector<PeopleTable> answers_tables(Database& database, const Group& group);
[[nodiscard]] std::string answers_text(Database& database,
                                       const Group& group,
                                       const std::set<std::string>& left_out = {});

/// What the rule of a study came to in each run: thresholds, JNDs, sd and 95 % interval of the
/// posterior, by the answers that count; of a rule that estimates nothing the shares.
struct RuleRuns {
    Table runs{};                      ///< how many answers each has
    Table estimates{};                 ///< a row an estimate
    Table shares{};                    ///< a row a stimulus
    std::vector<PeopleTable> means{};  ///< of each estimate, a condition a run
};
/// What graded stimuli of a study are, as "log10 of compliance in mm/N"; without a rule of planned
/// objects the curvature.
[[nodiscard]] std::string stimulus_text(const protocols::Protocol& protocol);

/// Empty without a rule.
[[nodiscard]] RuleRuns rule_runs(Database& database, const Group& group);
/// Run by run, unless somebody is left out (then it stands above), then over people.
[[nodiscard]] std::string runs_text(const RuleRuns& found,
                                    const std::set<std::string>& left_out = {});

}  // namespace palpate::data

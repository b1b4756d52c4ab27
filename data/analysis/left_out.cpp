#include "data/analysis/left_out.hpp"

#include <algorithm>
#include <map>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "engine/base/text.hpp"
#include "protocols/design/object_outline.hpp"
#include "protocols/design/plan.hpp"
#include "protocols/file/protocol_file.hpp"

namespace palpate::data {
namespace {

using protocols::ExclusionSpec;
using protocols::Protocol;

/// A row a participant with a session: sessions begun and not finished; answers in main trials,
/// which of them do not count; of those that count how many are correct, timed out, and right or
/// wrong.
constexpr std::string_view kCounts = R"sql(
WITH one AS (SELECT session_id, participant_id, finished FROM session WHERE study_id = ?1 AND session_kind = ?2),
answered AS (
    SELECT participant_id, count(*) AS answers, sum(invalid_reason IS NOT NULL) AS invalid,
           sum(invalid_reason IS NULL AND correct) AS correct,
           sum(invalid_reason IS NULL AND outcome = 'timed_out') AS timed_out,
           sum(invalid_reason IS NULL AND correct IS NOT NULL) AS judged
    FROM one JOIN trial USING (session_id) JOIN response USING (trial_id)
         JOIN plan USING (session_id, plan_position)
    WHERE phase = 'main' GROUP BY participant_id)
SELECT participant_code, sum(finished = 0), answers, invalid, correct, timed_out, judged
FROM one JOIN participant USING (participant_id) LEFT JOIN answered USING (participant_id)
GROUP BY participant_code)sql";

/// The picture that whoever attends chooses for an object that is not pictured. All are of two
/// curves, as catch_correct_min needs it.
std::string outermost(const Protocol& protocol, const std::string& felt) {
    const auto object = std::ranges::find(protocol.objects, felt, &protocols::ObjectSpec::name);
    if (object == protocol.objects.end()) {
        return {};
    }
    const double side = *curvature_of(*object) > 0.0 ? 1.0 : -1.0;
    const protocols::ObjectSpec* extreme = nullptr;
    for (const std::size_t i : objects_of(protocol, true)) {
        const protocols::ObjectSpec& picture = protocol.objects[i];
        if (extreme == nullptr || side * *curvature_of(picture) > side * *curvature_of(*extreme)) {
            extreme = &picture;
        }
    }
    return extreme == nullptr ? "" : extreme->name;
}

/// Catch trials of a participant with an answer that counts.
struct Catches {
    std::int64_t all = 0;
    std::int64_t right = 0;
};

std::map<std::string, Catches> catches_of(Database& database,
                                          std::int64_t study,
                                          std::string_view kind,
                                          const Protocol& protocol) {
    std::map<std::string, Catches> people;
    for (const Statement& row : database.prepare(
             "SELECT participant_code, plan.planned_object, response.chosen_object FROM trial JOIN "
             "response USING (trial_id) JOIN plan USING (session_id, plan_position) JOIN session "
             "USING (session_id) JOIN participant USING (participant_id) WHERE study_id = ?1 AND "
             "session_kind = ?2 AND phase = 'catch' AND invalid_reason IS NULL",
             study, kind)) {
        Catches& one = people[row.text(0)];
        ++one.all;
        one.right += row.text(2) == outermost(protocol, row.text(1)) ? 1 : 0;
    }
    return people;
}

/// The rules that a participant breaks. @param row  of kCounts
std::vector<std::string> broken_rules(const Statement& row,
                                      const Catches& catches,
                                      const ExclusionSpec& rules) {
    std::vector<std::string> broken;
    const auto check = [&](std::string_view rule, std::int64_t some, std::int64_t all,
                           double extreme, bool is_max) {
        const double share = static_cast<double>(some) / static_cast<double>(all);
        if (all > 0 && (is_max ? share > extreme : share < extreme)) {
            broken.push_back(fmt::format("{}: {} of {} = {:.3g}, {} {}", rule, some, all, share,
                                         is_max ? "above" : "below", extreme));
        }
    };
    const std::int64_t answers = row.integer(2);
    const std::int64_t invalid = row.integer(3);
    check("catch_correct_min", catches.right, catches.all, rules.catch_correct_min, false);
    check("share_correct_min", row.integer(4), row.integer(6), rules.share_correct_min, false);
    check("timed_out_share_max", row.integer(5), answers - invalid, rules.timed_out_share_max,
          true);
    check("invalid_share_max", invalid, answers, rules.invalid_share_max, true);
    if (rules.sessions_finished && row.integer(1) > 0) {
        broken.push_back("sessions_finished: " + counted(row.integer(1), "is not", "are not"));
    }
    return broken;
}

/// A row a session, those that analyses do not see too.
constexpr std::string_view kSessions = R"sql(
SELECT participant_code, printf('sub-%010d', subject), consent IS 0, session_number, withdrawn_reason,
       count(answered.trial_id), sum(marked), sum(invalid AND NOT marked)
FROM main.session AS one JOIN study USING (study_id) JOIN main.participant USING (participant_id)
LEFT JOIN (SELECT trial.session_id AS session_id, trial.trial_id AS trial_id, invalid_reason IS NOT NULL AS invalid,
                  iif(invalid_reason IS NULL, 0, EXISTS (SELECT 1 FROM main.event WHERE event.trial_id =
                      trial.trial_id AND event_kind = 'mark')) AS marked
           FROM main.trial JOIN main.plan USING (session_id, plan_position) JOIN main.response USING (trial_id)
           WHERE phase = 'main') AS answered ON answered.session_id = one.session_id
WHERE study_name = ?1 AND session_kind = ?2 GROUP BY one.session_id ORDER BY subject, session_number)sql";

struct Person {
    std::string name;
    bool refused = false;
    bool withdrawn = true;  ///< all sessions
    bool broke = false;     ///< a rule
    std::int64_t counting = 0;
};

using ByCode = std::map<std::string, Person>;  // by code

/// Answers of one session, each in its place; those that count are the person's.
void add_session(const Statement& row, bool codes, ByCode& people, LeftOut& account) {
    Person& person = people[row.text(0)];
    person.name = row.text(codes ? 0 : 1);
    const std::int64_t answers = row.integer(5);
    account.in_file.answers += answers;
    if (row.integer(2) != 0) {
        person.refused = true;
        account.no_consent.answers += answers;
    } else if (!row.null(4)) {
        account.withdrawn.answers += answers;
        account.withdrawals.push_back(
            {fmt::format("{} session {}", person.name, row.integer(3)), row.text(4)});
    } else {
        person.withdrawn = false;
        account.marked += row.integer(6);
        account.invalid += row.integer(7);
        person.counting += answers - row.integer(6) - row.integer(7);
    }
}

/// Those of them whose sessions analyses see, by each version of the protocol.
void judge_people(Database& database, ByCode& people, LeftOut& account) {
    for (const Statement& row : database.prepare(
             "SELECT study_id, protocol_toml FROM study WHERE study_name = ?1", account.study)) {
        Protocol protocol;
        try {
            protocol = protocols::stored_protocol(row.text(1));
        } catch (const protocols::ProtocolError&) {
            continue;  // palpate verify says it
        }
        account.rules = account.rules || protocol.exclusion != ExclusionSpec{};
        std::map<std::string, Catches> catches;
        if (protocol.exclusion.catch_correct_min > 0.0) {
            catches = catches_of(database, row.integer(0), account.kind, protocol);
        }
        for (const Statement& one : database.prepare(kCounts, row.integer(0), account.kind)) {
            Person& person = people.at(one.text(0));
            for (const std::string& rule :
                 broken_rules(one, catches[one.text(0)], protocol.exclusion)) {
                if (!person.refused && !person.withdrawn) {
                    person.broke = true;
                    account.broken.push_back({person.name, rule});
                }
            }
        }
    }
    // The order of the lab's codes is no business of whoever reads numbers.
    std::ranges::stable_sort(account.broken, {}, &LeftOut::Reason::person);
}

void count_people(const ByCode& people, LeftOut& account) {
    for (const auto& [code, person] : people) {
        ++account.in_file.people;
        if (person.refused) {
            ++account.no_consent.people;
        } else if (person.withdrawn) {
            ++account.withdrawn.people;
        } else if (person.broke) {
            ++account.by_rule.people;
            account.by_rule.answers += person.counting;
        } else if (person.counting == 0) {
            ++account.no_answer;
        } else {
            ++account.analysed.people;
            account.analysed.answers += person.counting;
        }
    }
}

/// "1 does not consent, 2 without an answer that counts": nothing where all are 0.
std::string parts_text(const std::vector<std::pair<std::int64_t, std::string>>& parts) {
    std::string text;
    for (const auto& [count, words] : parts) {
        text += count == 0 ? "" : fmt::format("{}{} {}", text.empty() ? "" : ", ", count, words);
    }
    return text;
}

}  // namespace

bool LeftOut::leaves_out(std::string_view person) const {
    return std::ranges::find(broken, person, &Reason::person) != broken.end();
}

LeftOut left_out_of(Database& database, std::string_view study, std::string_view kind, bool codes) {
    const Snapshot now(database);
    LeftOut account{.study = std::string(study), .kind = std::string(kind)};
    ByCode people;
    for (const Statement& row : database.prepare(kSessions, study, kind)) {
        add_session(row, codes, people, account);
    }
    judge_people(database, people, account);
    count_people(people, account);
    Statement other = database.prepare(
        "SELECT study_name, session_kind, count(DISTINCT participant_id), min(protocol_sha256) "
        "FROM main.session JOIN study USING (study_id) WHERE study_name <> ?1 OR session_kind <> "
        "?2 GROUP BY 1, 2 ORDER BY 1, 2",
        study, kind);
    account.elsewhere = other.all([](const Statement& row) {
        return StudyVersion{row.text(0), row.text(3), row.text(1), row.integer(2)};
    });
    return account;
}

std::vector<LeftOut> left_out_everywhere(Database& database, std::string_view kind, bool codes) {
    const Snapshot now(database);
    std::vector<LeftOut> all;
    for (const Statement& row : database.prepare(
             "SELECT DISTINCT study_name, session_kind FROM main.session JOIN study USING "
             "(study_id) WHERE ?1 IN ('all', session_kind) ORDER BY session_kind, study_name",
             kind)) {
        all.push_back(left_out_of(database, row.text(0), row.text(1), codes));
    }
    return all;
}

LeftOut without_words(LeftOut account) {
    account.withdrawals.clear();
    return account;
}

std::string left_out_text(const LeftOut& account) {
    const std::string people =
        parts_text({{account.no_consent.people,
                     account.no_consent.people == 1 ? "does not consent" : "do not consent"},
                    {account.withdrawn.people, "withdrawn"},
                    {account.by_rule.people, "by the rules of [exclusion]"},
                    {account.no_answer, "without an answer that counts"}});
    const std::string answers =
        parts_text({{account.no_consent.answers, "of who does not consent"},
                    {account.withdrawn.answers, "of withdrawn sessions"},
                    {account.marked, "marked"},
                    {account.invalid, "invalid"},
                    {account.by_rule.answers, "of who is left out by rule"}});
    std::string text = fmt::format("  Who and what is left out of study {}, {} sessions\n",
                                   plain(account.study), account.kind);
    text += fmt::format("    people: {} in the file; left out: {}; analysed: {}\n",
                        account.in_file.people, people.empty() ? "nobody" : people,
                        account.analysed.people);
    text += fmt::format("    answers of main trials: {} in the file; left out: {}; analysed: {}\n",
                        account.in_file.answers, answers.empty() ? "none" : answers,
                        account.analysed.answers);
    for (const LeftOut::Reason& one : account.broken) {
        text += fmt::format("    by rule: {}  {}\n", plain(one.person), plain(one.why));
    }
    for (const LeftOut::Reason& one : account.withdrawals) {
        text += fmt::format("    withdrawn: {}  {}\n", plain(one.person), plain(one.why));
    }
    for (const StudyVersion& one : account.elsewhere) {
        text += fmt::format("    not in these numbers: {}, {} sessions: {}\n", plain(one.study),
                            one.kind, counted(one.people, "person", "people"));
    }
    return text;
}

std::string below(const std::optional<LeftOut>& account) {
    return account ? '\n' + left_out_text(*account) : std::string();
}

Json left_out_json(const LeftOut& account) {
    const auto reasons = [](const std::vector<LeftOut::Reason>& all) {
        Json list = Json::array();
        for (const LeftOut::Reason& one : all) {
            list.push_back({{"person", one.person}, {"why", one.why}});
        }
        return list;
    };
    Json elsewhere = Json::array();
    for (const StudyVersion& one : account.elsewhere) {
        elsewhere.push_back({{"study", one.study}, {"kind", one.kind}, {"people", one.people}});
    }
    return {{"study", account.study},
            {"kind", account.kind},
            {"people",
             {{"in_file", account.in_file.people},
              {"no_consent", account.no_consent.people},
              {"withdrawn", account.withdrawn.people},
              {"by_rule", account.by_rule.people},
              {"no_answer", account.no_answer},
              {"analysed", account.analysed.people}}},
            {"answers",
             {{"in_file", account.in_file.answers},
              {"no_consent", account.no_consent.answers},
              {"withdrawn", account.withdrawn.answers},
              {"marked", account.marked},
              {"invalid", account.invalid},
              {"by_rule", account.by_rule.answers},
              {"analysed", account.analysed.answers}}},
            {"by_rule", reasons(account.broken)},
            {"withdrawn", reasons(account.withdrawals)},
            {"elsewhere", std::move(elsewhere)}};
}

Json left_out_json(const std::vector<LeftOut>& accounts) {
    Json all = Json::array();
    for (const LeftOut& one : accounts) {
        all.push_back(left_out_json(one));
    }
    return all;
}

std::string remarked(std::string_view text) {
    std::string out = "# ";
    for (const char c : plain(text.substr(0, text.find_last_not_of('\n') + 1), Lines::kept)) {
        out += c == '\n' ? std::string("\n# ") : std::string(1, c);
    }
    return out + '\n';
}

Json versions_json(const std::vector<StudyVersion>& versions) {
    Json all = Json::array();
    for (const StudyVersion& one : versions) {
        all.push_back({{"study", one.study},
                       {"protocol_sha256", one.protocol_sha256},
                       {"kind", one.kind},
                       {"people", one.people}});
    }
    return all;
}

std::string none_left_text(Database& database, std::string_view study, std::string_view kind) {
    std::string text;
    for (const LeftOut& one : left_out_everywhere(database, kind, false)) {
        if ((study.empty() || one.study == study) && one.in_file.answers > one.analysed.answers) {
            text += '\n' + left_out_text(one);
        }
    }
    return text;
}

std::string of_study(const AnswerChoice& choice) {
    return choice.study.empty() ? "" : fmt::format(" of the study {}", choice.study);
}

std::string one_study(Database& database,
                      const AnswerChoice& choice,
                      const std::set<std::string>& found,
                      std::string_view what,
                      std::string_view instead) {
    if (found.empty()) {
        throw std::invalid_argument(
            fmt::format("{} has no answer {} in {} sessions{}: --kind chooses others; {}{}",
                        database.file(), what, choice.kind, of_study(choice), instead,
                        none_left_text(database, choice.study, choice.kind)));
    }
    if (found.size() > 1) {
        throw std::invalid_argument(several_studies(database, found));
    }
    return *found.begin();
}

}  // namespace palpate::data

#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>

#include <fmt/format.h>

#include "protocols/file/protocol_file.hpp"
#include "data/inference/trials.hpp"
#include "data/store/analysed.hpp"

namespace palpate::data {
namespace {

/// Answers without a rule: named pictures, or yes and no.
constexpr std::string_view kAnswered = R"sql(
SELECT study_name, participant_code, subject, analysis_trial.planned_object, friction,
       coalesce(chosen_object, iif(answer_code = 1, 'yes', 'no')), reaction_s, done_s - first_contact_s, confidence,
       trials_since_break, iif(counts, '', coalesce(exclusion, 'does not count'))
FROM analysis_trial JOIN participant USING (participant_code)
WHERE phase = 'main' AND session_kind = ?1 AND answer_code IS NOT NULL AND run_number IS NULL
      AND (chosen_object IS NOT NULL OR study_name IN
           (SELECT study_name FROM study WHERE protocol_toml LIKE '%kind = "yes_no"%'))
ORDER BY study_name, participant_code, session_number, trial_number)sql";

std::optional<double> above_zero(const Statement& row, int column) {
    return row.real(column) > 0.0 ? row.real_or_none(column) : std::nullopt;
}

/// Whom the protocol's rules leave out, and why.
std::map<std::string, std::string> whys_of(const LeftOut& account) {
    std::map<std::string, std::string> whys;
    for (const auto& [person, rule] : account.broken) {
        std::string& why = whys[person];
        why += (why.empty() ? "" : "; ") + rule;
    }
    return whys;
}

/// By the least static friction of the conditions' plans, as everywhere.
std::string least_friction(Database& database, const AnswerChoice& choice) {
    Statement row = database.first(
        "SELECT friction FROM plan JOIN session USING (session_id) JOIN study USING (study_id) "
        "WHERE study_name = ?1 AND session_kind = ?2 AND phase = 'main' GROUP BY 1 ORDER BY "
        "min(mu_s), friction LIMIT 1",
        choice.study, choice.kind);
    return row.text(0);
}

/// As the newest version of the protocol says.
protocols::PrimaryTest primary_of(Database& database, const AnswerChoice& choice) {
    return protocols::stored_protocol(database
                                          .first("SELECT protocol_toml FROM study WHERE study_name "
                                                 "= ?1 ORDER BY study_id DESC LIMIT 1",
                                                 choice.study)
                                          .text(0))
        .analysis.primary;
}

std::size_t pictures_of(Database& database, const AnswerChoice& choice) {
    Statement row = database.first(
        "SELECT coalesce(max(n), 0) FROM (SELECT count(*) AS n FROM picture JOIN session USING "
        "(session_id) JOIN study USING (study_id) WHERE study_name = ?1 AND session_kind = ?2 "
        "GROUP BY session_id)",
        choice.study, choice.kind);
    return static_cast<std::size_t>(row.integer(0));
}

NamedTrial trial_of(const Statement& row, bool codes, std::int64_t number) {
    NamedTrial one{.subject = codes ? row.text(1) : fmt::format("sub-{:010}", row.integer(2)),
                   .shape = row.text(3),
                   .friction = row.text(4),
                   .response = row.text(5)};
    one.trial = {.number = number,
                 .rt_s = above_zero(row, 6),
                 .explore_s = above_zero(row, 7),
                 .confidence = row.real_or_none(8),
                 .since_break = row.real_or_none(9),
                 .excluded = row.text(10)};
    return one;
}

}  // namespace

TrialTable stored_trials(Database& database, const AnswerChoice& asked) {
    const Snapshot now(database);
    AnswerChoice choice = asked;
    std::set<std::string> studies;
    std::vector<NamedTrial> all;
    std::string before;
    std::int64_t number = 0;
    for (const Statement& row : database.prepare(kAnswered, choice.kind)) {
        const std::string study = row.text(0);
        if (!choice.study.empty() && study != choice.study) {
            continue;
        }
        studies.insert(study);
        number = row.text(1) == before ? number + 1 : 1;
        before = row.text(1);
        all.push_back(trial_of(row, choice.codes, number));
    }
    if (all.empty()) {
        throw std::invalid_argument(fmt::format(
            "{} has no answer of identification or yes-no in {} sessions{}: --kind chooses others; "
            "palpate fit is for runs of a rule, palpate summary for ratings{}",
            database.file(), choice.kind,
            choice.study.empty() ? "" : fmt::format(" of the study {}", choice.study),
            none_left_text(database, choice.study, choice.kind)));
    }
    if (studies.size() > 1) {
        throw std::invalid_argument(several_studies(database, studies));
    }
    choice.study = *studies.begin();
    LeftOut account = left_out_of(database, choice.study, choice.kind, choice.codes);
    const auto whys = whys_of(account);
    for (NamedTrial& one : all) {
        if (const auto found = whys.find(one.subject); found != whys.end()) {
            one.trial.excluded = found->second;
        }
    }
    TrialTable table = table_of_names(std::move(all));
    table.source = choice.codes ? database.file() : fmt::format("study {}", choice.study);
    table.study = choice.study;
    table.versions = versions_of(database);
    table.left_out = std::move(account);
    table.kind = choice.kind;
    table.primary = primary_of(database, choice);
    if (table.alternatives > 0) {
        table.alternatives = std::max<std::size_t>(pictures_of(database, choice), 2);
    }
    const std::string least = least_friction(database, choice);
    if (std::ranges::find(table.frictions, least) != table.frictions.end()) {
        compare_with(table, least);
    }
    return table;
}

}  // namespace palpate::data

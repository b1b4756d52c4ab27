#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "data/store/database.hpp"

/// What analyses see of a file.
namespace palpate::data {

/// Sessions of one kind of one version of a protocol.
struct StudyVersion {
    std::string study;  ///< as analyses call it: "shapes", or "shapes@1a2b3c4d" beside others
    std::string protocol_sha256;
    std::string kind;
    std::int64_t people = 0;  ///< in the file with a trial, left out or not

    friend bool operator==(const StudyVersion&, const StudyVersion&) = default;
};

enum class Versions { apart, together };

/// From here on all queries of this connection see the file as analyses do, whatever they ask:
/// where people of one kind ran several versions of a protocol, each is a study of its own, by its
/// id and hash, unless they are to be together; sessions that were withdrawn and those of who does
/// not consent are not there: data/analysis/left_out.hpp says who. Nothing in the file changes.
/// @pre nothing was prepared that is still used
/// @param study  as given; empty: not
/// @throws std::invalid_argument if the file has none of that name, or several versions of it, kept
/// apart: which there are
void analyse(Database& database, Versions versions, const std::string& study = {});

/// For who asks many times of the view analysis_trial and of events, after analyse(): from here on
/// this connection has their rows at hand, in memory. What comes of a question stays the same.
void keep_attempts(Database& database);

/// Whether the file has a session that no analysis sees.
[[nodiscard]] bool hides(Database& database);

/// Why no tick of a trial is shown: "of somebody who is noted as not consenting", "of a session
/// that was withdrawn". @return empty: nothing speaks against it, or there is no such trial
[[nodiscard]] std::string why_hidden(Database& database, std::int64_t trial);
/// @throws std::invalid_argument why its ticks are not shown
void require_shown(Database& database, std::int64_t trial);

/// Versions of protocols of which there are several with people of one kind; else nothing. After
/// analyse().
[[nodiscard]] std::vector<StudyVersion> versions_of(Database& database);
/// Of a file where one study is to be chosen: which there are.
[[nodiscard]] std::string several_studies(Database& database, const std::set<std::string>& studies);
/// For people: which there are with how many; empty where there are no several.
[[nodiscard]] std::string versions_text(const std::vector<StudyVersion>& versions);

/// A query of all answers on a graded stimulus, main trials that count: session_id, study_name,
/// session_kind, participant_code, condition, stimulus, and k, which is 1 for yes or the
/// comparison. Two kinds of rows of analysis_trial: where a rule chose the level of two intervals
/// or of yes-no, the run by name and its stimulus; with yes-no on planned objects the friction and
/// the curvature in 1/m.
inline constexpr std::string_view kGradedAnswers = R"sql(
SELECT session_id, study_name, session_kind, participant_code, coalesce(run_name, '') AS condition, stimulus,
       rule_outcome AS k
FROM analysis_trial
WHERE counts AND phase = 'main' AND run_trial_number IS NOT NULL
      AND study_name IN (SELECT study_name FROM study
                         WHERE protocol_toml LIKE '%kind = "yes_no"%' OR protocol_toml LIKE '%kind = "two_interval"%')
UNION ALL
SELECT session_id, study_name, session_kind, participant_code, friction, curvature_per_m, answer_code
FROM analysis_trial
WHERE counts AND phase = 'main' AND run_name IS NULL AND comparison_chosen IS NULL AND chosen_object IS NULL
      AND answer_code IS NOT NULL AND curvature_per_m IS NOT NULL
      AND study_name IN (SELECT study_name FROM study WHERE protocol_toml LIKE '%kind = "yes_no"%'))sql";

}  // namespace palpate::data

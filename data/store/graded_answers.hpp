#pragma once

#include <string_view>

namespace palpate::data {

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

#include "data/store/views.hpp"

#include <string>

#include "data/store/adaptive_store.hpp"

namespace palpate::data {
namespace {

/// Answers, one by one and counted; and faults.
constexpr const char* kAnswers = R"sql(
CREATE VIEW trial_result AS
-- One row per answered trial that counts, practice and catch trials included: filter by phase and kind.
SELECT trial.trial_id AS trial_id,                           -- trial.trial_id
       study.study_name AS study_name,                         -- study.study_name
       participant.participant_code AS participant_code,             -- pseudonym
       session.session_number AS session_number,                   -- number of the participant's session
       session.session_kind AS session_kind,                        -- real, pilot, simulated
       plan.plan_position AS plan_position,                   -- in the plan, from 0
       plan.phase AS phase,                         -- practice, main, catch
       plan.planned_object AS planned_object,                       -- what was felt
       plan.curvature_per_m AS curvature_per_m,     -- > 0 convex, 0 straight, < 0 concave
       plan.friction AS friction,                   -- the condition's name
       response.chosen_object AS chosen_object,                   -- what it was taken for
       response.correct AS correct,                 -- 1: chosen_object is what was felt
       trial.outcome AS outcome,                    -- complete or timed_out
       trial.first_contact_s AS first_contact_s,    -- first tick -> first contact
       trial.done_s AS done_s,                      -- first tick -> done
       response.reaction_s AS reaction_s,           -- question shown -> the press that gave this answer
       response.reaction_uncertainty_s AS reaction_uncertainty_s,     -- of reaction_s: it may be up to this much less
       response.changes AS changes,                 -- of the answer before it was confirmed; NULL: not asked for
       response.early_presses AS early_presses,     -- within the guard time, no answers: was somebody in a hurry?
       trial.path_length_m AS path_length_m,        -- of HIP
       trial.contact_ticks / session.rate_hz AS contact_s,  -- time in contact
       trial.slip_ticks * 1.0 / NULLIF(trial.contact_ticks, 0) AS slip_share,  -- of contact
       trial.mean_normal_force_n AS mean_normal_force_n,  -- over contact
       trial.max_normal_force_n AS max_normal_force_n,    -- largest
       trial.saturated_ticks * 1.0 / NULLIF(trial.ticks, 0) AS saturated_share,  -- of ticks
       trial.late_ticks * 1.0 / NULLIF(trial.ticks, 0) AS late_share  -- of ticks
FROM trial
JOIN response USING (trial_id)
JOIN plan USING (session_id, plan_position)
JOIN session USING (session_id)
JOIN participant USING (participant_id)
JOIN study USING (study_id)
WHERE trial.invalid_reason IS NULL;

CREATE VIEW confusion AS
-- How often each object was taken for which, main trials only.
SELECT study_name,       -- study.study_name
       session_kind,         -- real, pilot, simulated
       friction,     -- the condition's name
       planned_object,       -- what was felt
       chosen_object,       -- what it was taken for
       count(*) AS n -- trials
FROM trial_result WHERE phase = 'main' AND chosen_object IS NOT NULL  -- without pictures nothing is confused
GROUP BY study_name, session_kind, friction, planned_object, chosen_object;

CREATE VIEW invalid_trial AS
-- One row per answered trial that does not count, with its answer and the reason.
SELECT trial.trial_id AS trial_id,                  -- trial.trial_id
       study.study_name AS study_name,                -- study.study_name
       participant.participant_code AS participant_code,    -- pseudonym
       session.session_number AS session_number,          -- number of the participant's session
       session.session_kind AS session_kind,               -- real, pilot, simulated
       trial.plan_position AS plan_position,         -- in the plan, from 0
       trial.attempt AS attempt,           -- at this position
       plan.phase AS phase,                -- practice, main, catch
       plan.planned_object AS planned_object,              -- what was felt
       plan.friction AS friction,          -- the condition's name
       response.chosen_object AS chosen_object,          -- what it was taken for
       response.correct AS correct,        -- 1: chosen_object is what was felt
       trial.invalid_reason AS invalid_reason             -- why it does not count
FROM trial
JOIN response USING (trial_id)
JOIN plan USING (session_id, plan_position)
JOIN session USING (session_id)
JOIN participant USING (participant_id)
JOIN study USING (study_id)
WHERE trial.invalid_reason IS NOT NULL;

CREATE VIEW fault AS
-- One row per faulted trial: whose, which, why, and when.
SELECT trial.trial_id AS trial_id,                  -- trial.trial_id
       study.study_name AS study_name,                -- study.study_name
       participant.participant_code AS participant_code,    -- pseudonym
       session.session_number AS session_number,          -- number of the participant's session
       session.session_kind AS session_kind,               -- real, pilot, simulated
       trial.plan_position AS plan_position,         -- in the plan, from 0
       trial.attempt AS attempt,           -- at this position
       plan.phase AS phase,                -- practice, main, catch
       trial.fault_cause AS fault_cause,               -- why the force went off, e.g. over_speed
       trial.done_s AS fault_s,               -- first tick -> fault
       trial.ended_utc AS ended_utc,       -- wall clock, ISO 8601
       (SELECT count(*) FROM fault_tick WHERE fault_tick.trial_id = trial.trial_id) AS ticks_kept  -- in fault_tick
FROM trial
JOIN plan USING (session_id, plan_position)
JOIN session USING (session_id)
JOIN participant USING (participant_id)
JOIN study USING (study_id)
WHERE trial.outcome = 'faulted';
)sql";

/// Since schema 5, for people without the SQL extension.
constexpr const char* kViews = R"sql(
CREATE VIEW trial_summary AS
-- One row per attempt at a trial, answered or not. For analysis take those that count:
-- WHERE invalid_reason IS NULL AND chosen_object IS NOT NULL AND phase = 'main' AND session_kind = 'real'.
SELECT trial.trial_id AS trial_id,                           -- trial.trial_id
       study.study_name AS study_name,                         -- study.study_name
       participant.participant_code AS participant_code,             -- pseudonym
       session.session_number AS session_number,                   -- number of the participant's session
       session.session_kind AS session_kind,                        -- real, pilot, simulated
       trial.plan_position AS plan_position,                  -- in the plan, from 0
       trial.attempt AS attempt,                    -- at this position
       plan.phase AS phase,                         -- practice, main, catch
       plan.planned_object AS planned_object,                       -- what was felt
       plan.curvature_per_m AS curvature_per_m,     -- > 0 convex, 0 straight, < 0 concave
       plan.friction AS friction,                   -- the condition's name
       trial.outcome AS outcome,                    -- complete and timed_out have an answer
       trial.invalid_reason AS invalid_reason,                    -- why the answer does not count; NULL: it does
       response.chosen_object AS chosen_object,                   -- what it was taken for; NULL: no answer
       response.correct AS correct,                 -- 1: chosen_object is what was felt
       trial.first_contact_s AS first_contact_s,    -- first tick -> first contact
       trial.done_s AS done_s,                      -- first tick -> done
       response.reaction_s AS reaction_s,           -- question shown -> the press that gave this answer
       response.changes AS changes,                 -- of the answer before it was confirmed; NULL: not asked for
       response.early_presses AS early_presses,     -- within the guard time, no answers: was somebody in a hurry?
       trial.path_length_m AS path_length_m,        -- of HIP
       trial.strokes AS strokes,                    -- along the surface, 5 mm or more in one direction
       trial.mean_normal_force_n AS mean_normal_force_n,  -- over contact, 0 without
       trial.max_normal_force_n AS max_normal_force_n,    -- largest
       trial.mean_speed_m_per_s AS mean_speed_m_per_s,    -- of HIP in contact
       trial.contact_ticks / session.rate_hz AS contact_s,                -- time in contact
       trial.slip_ticks * 1.0 / NULLIF(trial.contact_ticks, 0) AS slip_share,  -- of contact: slip or transition
       trial.before_vertex_ticks / session.rate_hz AS before_vertex_s,    -- in contact with segment 0, before vertex 0
       trial.after_vertex_ticks / session.rate_hz AS after_vertex_s,      -- in contact with segment 1, after vertex 0
       trial.late_ticks * 1.0 / NULLIF(trial.ticks, 0) AS late_share,     -- of ticks
       trial.saturated_ticks * 1.0 / NULLIF(trial.ticks, 0) AS saturated_share  -- of ticks
FROM trial
JOIN plan USING (session_id, plan_position)
JOIN session USING (session_id)
JOIN participant USING (participant_id)
JOIN study USING (study_id)
LEFT JOIN response USING (trial_id);

CREATE VIEW session_health AS
-- One row per session: how far it went, and how well the rig kept up.
SELECT session.session_id AS session_id,                    -- session.session_id
       study.study_name AS study_name,                         -- study.study_name
       participant.participant_code AS participant_code,             -- pseudonym
       session.session_number AS session_number,                   -- number of the participant's session
       session.session_kind AS session_kind,                        -- real, pilot, simulated
       session.finished AS finished,                -- 1: every planned trial is done
       (SELECT count(*) FROM plan WHERE plan.session_id = session.session_id) AS planned,  -- trials of the plan
       count(response.trial_id) AS answered,           -- attempts with an answer, invalid ones too
       count(trial.invalid_reason) AS invalid_answers,             -- answers that do not count
       sum(response.early_presses) AS early_presses,  -- within the guard time, no answers
       count(*) FILTER (WHERE trial.outcome = 'faulted') AS faulted,          -- the force went off
       count(*) FILTER (WHERE trial.outcome = 'aborted') AS aborted,          -- ended by the experimenter
       count(*) FILTER (WHERE trial.outcome = 'interrupted') AS interrupted,  -- found unfinished later
       sum(trial.late_ticks) * 1.0 / NULLIF(sum(trial.ticks), 0) AS late_share,  -- of ticks
       sum(trial.saturated_ticks) * 1.0 / NULLIF(sum(trial.ticks), 0) AS saturated_share,  -- of ticks
       (SELECT coalesce(sum(event.count), 0) FROM event
        WHERE event.session_id = session.session_id AND event.event_kind = 'ticks lost') AS lost_ticks,  -- found no room on their way to the disk
       sum(trial.ticks) / session.rate_hz AS felt_s,  -- on the servo's clock, all attempts that ended
       (julianday(coalesce(session.finished_utc, max(trial.ended_utc), max(trial.started_utc)))
        - julianday(session.started_utc)) * 86400.0 AS duration_s,  -- wall clock, pauses included
       (SELECT count(*) FROM event WHERE event.session_id = session.session_id AND event.event_kind = 'break') AS breaks  -- taken
FROM session
JOIN participant USING (participant_id)
JOIN study USING (study_id)
LEFT JOIN trial USING (session_id)
LEFT JOIN response USING (trial_id)
GROUP BY session.session_id;
)sql";

}  // namespace

std::string_view views_sql() noexcept {
    static const std::string all = std::string(kAnswers) + kViews + kAdaptiveViews;
    return all;
}

}  // namespace palpate::data

CREATE VIEW analysis_trial AS
-- One row an attempt at a trial, answered or not, with all that an analysis asks for: no join is needed. For
-- analysis take those that count: WHERE counts AND phase = 'main' AND session_kind = 'real'.
SELECT study.study_name AS study_name,
       participant.participant_code AS participant_code,
       session.session_id AS session_id,
       session.session_number AS session_number,
       session.session_kind AS session_kind,
       trial.trial_id AS trial_id,
       row_number() OVER (PARTITION BY trial.session_id ORDER BY trial.trial_id) AS trial_number,  -- attempts of the session, counted from 1 in the order run
       iif(trial.seal_events IS NULL, NULL, row_number() OVER (PARTITION BY trial.session_id, coalesce(rested.breaks, 0),
           trial.seal_events IS NULL ORDER BY trial.trial_id) - 1)
           AS trials_since_break,  -- attempts before it since the session's begin or last break; NULL: it has not ended
       plan.phase AS phase,
       plan.block AS block,
       trial.plan_position AS plan_position,
       trial.attempt AS attempt,
       trial.device AS device,
       trial.calibration_sha256 AS calibration_sha256,
       plan.planned_object AS planned_object,
       plan.friction AS friction,
       plan.curvature_per_m AS curvature_per_m,
       felt_1.felt_object AS object_1,  -- what the first interval let one feel
       felt_2.felt_object AS object_2,  -- what the second interval let one feel; NULL: there is none
       felt_1.friction AS friction_1,  -- as felt in the first interval
       felt_2.friction AS friction_2,  -- as felt in the second interval
       felt_1.curvature_per_m AS curvature_1_per_m,  -- as felt in the first interval
       felt_2.curvature_per_m AS curvature_2_per_m,  -- as felt in the second interval
       felt_1.mu_s AS mu_s_1,  -- static coefficient of friction, as felt in the first interval
       felt_2.mu_s AS mu_s_2,  -- static coefficient of friction, as felt in the second interval
       adaptive_plan.run_number AS run_number,
       adaptive_plan.run_name AS run_name,
       iif(adaptive_step.trial_id IS NULL, NULL, row_number() OVER (PARTITION BY trial.session_id,
           adaptive_plan.run_number, adaptive_step.trial_id IS NULL ORDER BY trial.trial_id))
           AS run_trial_number,  -- answers that the run's rule took in, from 1
       adaptive_plan.comparison_interval AS comparison_interval,
       compared.stimulus AS stimulus,  -- the level that the rule chose, in the protocol's unit; NULL: no rule
       compared.curvature_per_m AS comparison_curvature_per_m,  -- of what the rule chose, as felt
       compared.mu_s AS comparison_mu_s,  -- of what the rule chose, as felt
       response.answer_code AS answer_code,
       iif(felt_2.trial_id IS NULL, NULL, response.answer_code + 1 = adaptive_plan.comparison_interval)
           AS comparison_chosen,  -- of two intervals: 1 if the comparison was named
       response.chosen_object AS chosen_object,
       response.correct AS correct,
       response.confidence AS confidence,
       trial.outcome AS outcome,
       trial.fault_cause AS fault_cause,
       trial.invalid_reason AS invalid_reason,
       CASE WHEN session.withdrawn_reason IS NOT NULL THEN 'withdrawn'
            WHEN trial.invalid_reason IS NOT NULL
                 AND marked.trial_id IS NOT NULL THEN 'marked' ELSE trial.invalid_reason
       END AS exclusion,  -- why the answer does not count; marked: somebody said so; withdrawn: of its session
       response.trial_id IS NOT NULL AND trial.invalid_reason IS NULL AND session.withdrawn_reason IS NULL
           AS counts,  -- 1: answered, and the answer counts {0 = no; 1 = yes}
       trial.first_contact_s AS first_contact_s,
       trial.done_s AS done_s,
       trial.done_uncertainty_s AS done_uncertainty_s,
       response.reaction_s AS reaction_s,
       response.reaction_uncertainty_s AS reaction_uncertainty_s,
       response.confidence_reaction_s AS confidence_reaction_s,
       response.changes AS changes,
       response.early_presses AS early_presses,
       trial.path_length_m AS path_length_m,
       trial.strokes AS strokes,
       trial.mean_speed_m_per_s AS mean_speed_m_per_s,
       trial.mean_normal_force_n AS mean_normal_force_n,
       trial.max_normal_force_n AS max_normal_force_n,
       trial.contact_ticks / session.rate_hz AS contact_s,  -- time in contact
       trial.slip_ticks * 1.0 / NULLIF(trial.contact_ticks, 0) AS slip_share,  -- of contact: slip or transition
       trial.before_vertex_ticks / session.rate_hz AS before_vertex_s,  -- in contact with segment 0, before vertex 0
       trial.after_vertex_ticks / session.rate_hz AS after_vertex_s,  -- in contact with segment 1, after vertex 0
       trial.late_ticks * 1.0 / NULLIF(trial.ticks, 0) AS late_share,  -- of ticks
       trial.saturated_ticks * 1.0 / NULLIF(trial.ticks, 0) AS saturated_share,  -- of ticks
       adaptive_step.rule_outcome AS rule_outcome,
       adaptive_step.staircase AS staircase,
       adaptive_step.estimate AS estimate,
       adaptive_step.estimates AS estimates,
       adaptive_step.state_sha256 AS state_sha256,
       trial.started_utc AS started_utc,
       trial.ended_utc AS ended_utc
FROM trial
JOIN plan USING (session_id, plan_position)
JOIN session USING (session_id)
JOIN participant USING (participant_id)
JOIN study USING (study_id)
LEFT JOIN response USING (trial_id)
LEFT JOIN adaptive_plan USING (session_id, plan_position)
LEFT JOIN adaptive_step USING (trial_id)
LEFT JOIN presentation AS felt_1 ON felt_1.trial_id = trial.trial_id AND felt_1.interval = 1
LEFT JOIN presentation AS felt_2 ON felt_2.trial_id = trial.trial_id AND felt_2.interval = 2
LEFT JOIN presentation AS compared
    ON compared.trial_id = trial.trial_id AND compared.interval = adaptive_plan.comparison_interval
LEFT JOIN (SELECT session_id,
                  CAST(row_number() OVER (PARTITION BY session_id ORDER BY event_id) AS INTEGER) AS events,  -- found by an index
                  sum(event_kind = 'break') OVER (PARTITION BY session_id ORDER BY event_id) AS breaks
           FROM event) AS rested
    ON rested.session_id = trial.session_id AND rested.events = trial.seal_events
LEFT JOIN (SELECT DISTINCT trial_id FROM event WHERE event_kind = 'mark') AS marked
    ON marked.trial_id = trial.trial_id;

CREATE VIEW exploration AS
-- One row per interval that was felt: what the hand did there.
SELECT trial.trial_id AS trial_id,
       study.study_name AS study_name,
       participant.participant_code AS participant_code,
       session.session_number AS session_number,
       session.session_kind AS session_kind,
       trial.plan_position AS plan_position,
       trial.attempt AS attempt,
       trial.device AS device,
       trial.calibration_sha256 AS calibration_sha256,
       plan.phase AS phase,
       presentation.interval AS interval,
       presentation.felt_object AS felt_object,
       presentation.curvature_per_m AS curvature_per_m,
       presentation.friction AS friction,
       trial.outcome AS outcome,
       response.trial_id IS NOT NULL AND trial.invalid_reason IS NULL AND session.withdrawn_reason IS NULL
           AS counts,  -- 1: answered, and the answer counts {0 = no; 1 = yes}
       presentation.done_s AS done_s,
       presentation.first_contact_s AS first_contact_s,
       presentation.start_x_m AS start_x_m,
       presentation.start_y_m AS start_y_m,
       presentation.contact_ticks / session.rate_hz AS contact_s,  -- time in contact
       presentation.before_vertex_ticks / session.rate_hz AS before_vertex_s,  -- in contact with segment 0, before vertex 0
       presentation.vertex_ticks / session.rate_hz AS vertex_s,  -- in contact on vertex 0 itself
       presentation.after_vertex_ticks / session.rate_hz AS after_vertex_s,  -- in contact with segment 1, after vertex 0
       presentation.late_ticks * 1.0 / NULLIF(presentation.ticks, 0) AS late_share,  -- of ticks
       presentation.saturated_ticks * 1.0 / NULLIF(presentation.ticks, 0) AS saturated_share,  -- of ticks
       presentation.strokes AS strokes,
       presentation.strokes_before_vertex AS strokes_before_vertex,
       presentation.strokes_after_vertex AS strokes_after_vertex,
       presentation.reversals AS reversals,
       presentation.stick_events AS stick_events,
       presentation.path_length_m AS path_length_m,
       presentation.speed_p10_m_per_s AS speed_p10_m_per_s,
       presentation.speed_p50_m_per_s AS speed_p50_m_per_s,
       presentation.speed_p90_m_per_s AS speed_p90_m_per_s,
       presentation.normal_force_p10_n AS normal_force_p10_n,
       presentation.normal_force_p50_n AS normal_force_p50_n,
       presentation.normal_force_p90_n AS normal_force_p90_n,
       presentation.covered_share AS covered_share
FROM presentation
JOIN trial USING (trial_id)
JOIN plan USING (session_id, plan_position)
JOIN session USING (session_id)
JOIN participant USING (participant_id)
JOIN study USING (study_id)
LEFT JOIN response USING (trial_id)
WHERE presentation.ticks IS NOT NULL;

CREATE VIEW confusion AS
-- How often each object was taken for which, main trials only, by who consents.
SELECT study_name,      -- the protocol's id
       session_kind,    -- real, pilot, simulated
       friction,        -- the condition's name
       planned_object,  -- what was felt
       chosen_object,   -- what it was taken for
       count(*) AS n    -- trials
FROM analysis_trial WHERE counts AND phase = 'main' AND chosen_object IS NOT NULL  -- without pictures nothing is confused
      AND participant_code NOT IN (SELECT participant_code FROM participant WHERE consent = 0)
GROUP BY study_name, session_kind, friction, planned_object, chosen_object;

CREATE VIEW fault AS
-- One row per faulted trial: whose, which, why, and when.
SELECT trial.trial_id AS trial_id,
       study.study_name AS study_name,
       participant.participant_code AS participant_code,
       session.session_number AS session_number,
       session.session_kind AS session_kind,
       trial.plan_position AS plan_position,
       trial.attempt AS attempt,
       trial.device AS device,
       trial.calibration_sha256 AS calibration_sha256,
       plan.phase AS phase,
       trial.fault_cause AS fault_cause,
       trial.done_s AS fault_s,  -- first tick -> fault, of two intervals added up
       trial.ended_utc AS ended_utc,
       (SELECT count(*) FROM fault_tick WHERE fault_tick.trial_id = trial.trial_id) AS ticks_kept  -- in fault_tick
FROM trial
JOIN plan USING (session_id, plan_position)
JOIN session USING (session_id)
JOIN participant USING (participant_id)
JOIN study USING (study_id)
WHERE trial.outcome = 'faulted';

CREATE VIEW session_health AS
-- One row per session: how far it went, and how well the rig kept up.
SELECT session.session_id AS session_id,
       study.study_name AS study_name,
       participant.participant_code AS participant_code,
       session.session_number AS session_number,
       session.session_kind AS session_kind,
       session.withdrawn_reason AS withdrawn_reason,
       session.finished AS finished,
       (SELECT count(*) FROM plan WHERE plan.session_id = session.session_id) AS planned,  -- trials of the plan
       count(response.trial_id) AS answered,        -- attempts with an answer, invalid ones too
       count(trial.invalid_reason) AS invalid_answers,  -- answers that do not count
       sum(response.early_presses) AS early_presses,  -- within the guard time, no answers
       count(*) FILTER (WHERE trial.outcome = 'faulted') AS faulted,          -- the force went off
       count(*) FILTER (WHERE trial.outcome = 'unanswered') AS unanswered,    -- nobody answered in time
       count(*) FILTER (WHERE trial.outcome = 'aborted') AS aborted,          -- ended by the experimenter
       count(*) FILTER (WHERE trial.outcome = 'interrupted') AS interrupted,  -- found unfinished later
       sum(trial.late_ticks) * 1.0 / NULLIF(sum(trial.ticks), 0) AS late_share,  -- of ticks
       sum(trial.saturated_ticks) * 1.0 / NULLIF(sum(trial.ticks), 0) AS saturated_share,  -- of ticks
       (SELECT coalesce(sum(event.count), 0) FROM event
        WHERE event.session_id = session.session_id AND event.event_kind = 'ticks lost') AS lost_ticks,  -- found no room on their way to the disk
       sum(trial.ticks) / session.rate_hz AS felt_s,  -- on the servo's clock, all attempts that ended
       CASE WHEN coalesce(session.finished_utc, max(trial.ended_utc), max(trial.started_utc)) >= session.started_utc
            THEN (julianday(coalesce(session.finished_utc, max(trial.ended_utc), max(trial.started_utc)))
                  - julianday(session.started_utc)) * 86400.0 END AS duration_s,  -- wall clock, pauses included; none where it was set back
       (SELECT count(*) FROM event WHERE event.session_id = session.session_id AND event.event_kind = 'break') AS breaks  -- taken
FROM session
JOIN participant USING (participant_id)
JOIN study USING (study_id)
LEFT JOIN trial USING (session_id)
LEFT JOIN response USING (trial_id)
GROUP BY session.session_id;

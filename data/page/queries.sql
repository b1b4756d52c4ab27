-- What the sections of the page ask of the file; {study}, {kind} and the like are filled in.

-- name: confusion
SELECT friction, felt, called, n, n * 1.0 / sum(n) OVER (PARTITION BY friction, felt) AS row_share,
       n_exclusions_not_applied
FROM (SELECT friction, planned_object AS felt, min(curvature_per_m) AS curvature,
             coalesce(chosen_object, iif(answer_code = 1, 'yes', 'no')) AS called,
             count(*) FILTER (WHERE counts AND NOT left_out) AS n, count(*) AS n_exclusions_not_applied
      FROM main WHERE answer_code IS NOT NULL AND run_number IS NULL
      GROUP BY friction, planned_object, called)
ORDER BY friction, curvature, felt, called

-- name: shares
SELECT person, left_out, friction, count(*) AS n, sum(hit) AS k, avg(hit) AS share,
       wilson_low(sum(hit), count(*)) AS wilson_low, wilson_high(sum(hit), count(*)) AS wilson_high
FROM (SELECT person, left_out, friction,
             {hit} AS hit
      FROM main WHERE counts AND run_number IS NULL)
GROUP BY person, friction ORDER BY person, friction

-- name: sensitivity
SELECT person, left_out, friction, count(*) FILTER (WHERE {signal}) AS signals,
       count(*) FILTER (WHERE {signal} AND answer_code = 1) AS hits,
       count(*) FILTER (WHERE NOT ({signal})) AS noises,
       count(*) FILTER (WHERE NOT ({signal}) AND answer_code = 1) AS false_alarms
FROM main WHERE counts AND run_number IS NULL AND chosen_object IS NULL AND answer_code IS NOT NULL
GROUP BY person, friction ORDER BY person, friction

-- name: felt
WITH felt AS (
    SELECT person, left_out, exploration.*, vertex_s / nullif(contact_s, 0) AS vertex_share
    FROM exploration JOIN person USING (participant_code)
    WHERE study_name = {study} AND session_kind = {kind} AND phase = 'main' AND counts)

-- name: kept
SELECT 1 FROM felt JOIN trace_chunk USING (trial_id) LIMIT 1

-- name: by_person
SELECT person, left_out, friction, count(*) AS intervals, avg(contact_s) AS contact_s,
       avg(strokes_before_vertex) AS strokes_before_vertex, avg(strokes_after_vertex) AS strokes_after_vertex,
       avg(reversals) AS reversals, avg(stick_events) AS stick_events, avg(vertex_share) AS vertex_share,
       avg(covered_share) AS covered_share,
       avg(speed_p10_m_per_s) AS speed_p10_m_per_s, avg(speed_p50_m_per_s) AS speed_p50_m_per_s,
       avg(speed_p90_m_per_s) AS speed_p90_m_per_s,
       avg(normal_force_p10_n) AS normal_force_p10_n, avg(normal_force_p50_n) AS normal_force_p50_n,
       avg(normal_force_p90_n) AS normal_force_p90_n
FROM felt GROUP BY person, friction ORDER BY person, friction

-- name: each_trial
SELECT person, trial_id, session_number, interval, felt_object AS felt, friction, contact_s,
       before_vertex_s, vertex_s, after_vertex_s, strokes_before_vertex, strokes_after_vertex, reversals,
       stick_events, covered_share, speed_p10_m_per_s, speed_p50_m_per_s, speed_p90_m_per_s,
       normal_force_p10_n, normal_force_p50_n, normal_force_p90_n
FROM felt ORDER BY person, trial_id, interval

-- name: health
SELECT person, session_number, finished, planned, answered, invalid_answers, early_presses, faulted, aborted,
       interrupted, late_share, saturated_share, lost_ticks, felt_s, breaks
FROM session_health JOIN person USING (participant_code)
WHERE study_name = {study} AND session_kind = {kind}
ORDER BY person, session_number

-- name: faults
SELECT fault_cause, phase, count(*) AS faults, count(DISTINCT person) AS people
FROM fault JOIN person USING (participant_code)
WHERE study_name = {study} AND session_kind = {kind}
GROUP BY fault_cause, phase ORDER BY faults DESC, fault_cause, phase

-- name: devices
SELECT person, session_number, calibration_sha256, attempts
FROM (SELECT person, session_number, device, calibration_sha256, count(*) AS attempts, min(trial_id) AS first,
             count(*) OVER (PARTITION BY session_id) AS devices
      FROM analysis_trial JOIN person USING (participant_code)
      WHERE study_name = {study} AND session_kind = {kind}
      GROUP BY session_id, device, calibration_sha256)
WHERE devices > 1 ORDER BY first

-- name: tracks
SELECT person, session_number, run_name, run_trial_number, stimulus, rule_outcome, estimate
FROM main WHERE counts AND run_trial_number IS NOT NULL
ORDER BY person, session_number, run_name, run_trial_number

-- name: flow
SELECT person.person, person.subject, person.left_out,
       (SELECT count(*) FROM plan JOIN session USING (session_id) JOIN study USING (study_id)
        WHERE session.participant_id = person.participant_id AND study_name = {study}
              AND session_kind = {kind} AND plan.phase = 'main') AS planned,
       count(main.trial_id) AS attempts,
       count(*) FILTER (WHERE outcome = 'faulted') AS faulted,
       count(*) FILTER (WHERE outcome = 'unanswered') AS unanswered,
       count(*) FILTER (WHERE outcome = 'aborted') AS aborted,
       count(*) FILTER (WHERE outcome IN ('interrupted', 'running')) AS broken_off,
       count(main.answer_code) AS answered,
       count(*) FILTER (WHERE answer_code IS NOT NULL AND exclusion = 'marked') AS marked,
       count(*) FILTER (WHERE answer_code IS NOT NULL AND NOT counts AND exclusion <> 'marked') AS invalid,
       count(*) FILTER (WHERE counts) AS counting,
       count(*) FILTER (WHERE counts AND NOT main.left_out) AS analysed
FROM person LEFT JOIN main USING (person)
GROUP BY person.person ORDER BY person.subject

-- The newest seal is that of the last end, event or attempt; and nothing that ended is without one.

-- name: seals
SELECT person, session_number, finished,
       (SELECT count(*) FROM trial WHERE trial.session_id = session.session_id) AS attempts,
       (SELECT count(*) FROM event WHERE event.session_id = session.session_id) AS events,
       (SELECT count(*) FROM trial WHERE trial.session_id = session.session_id
                                         AND trial.outcome <> 'running' AND trial.seal IS NULL)
         + (SELECT count(*) FROM event WHERE event.session_id = session.session_id AND event.seal IS NULL)
         + (finished AND seal IS NULL) AS without_seal,
       newest_seal IS NOT NULL AND newest_seal IN (
           SELECT session.seal UNION ALL
           SELECT trial.seal FROM trial WHERE trial.session_id = session.session_id UNION ALL
           SELECT event.seal FROM event WHERE event.session_id = session.session_id) AS newest_is_stored,
       protocol_sha256, newest_seal
FROM session JOIN person USING (participant_id) JOIN study USING (study_id)
WHERE study_name = {study} AND session_kind = {kind}
ORDER BY person, session_number

-- What held of which attempts of a session: those after the first `since` of them, up to number `until`.

-- name: held
WITH held AS (
    SELECT session_id, key, value, trials_begun AS since,
           lead(trials_begun) OVER (PARTITION BY session_id, key ORDER BY event_id) AS until
    FROM (SELECT session_id, key, value, 0 AS trials_begun, 0 AS event_id FROM session_provenance UNION ALL
          SELECT session_id, key, value, trials_begun, event_id FROM event
          WHERE event_kind = 'provenance' AND event_id > (
              SELECT coalesce(max(event_id), 0) FROM event AS again
              WHERE again.session_id = event.session_id AND again.event_kind = 'planned again')))

-- name: limits
SELECT coalesce(value, '') AS force_limit, count(*) AS attempts
FROM (SELECT session_id, row_number() OVER (PARTITION BY session_id ORDER BY trial_id) AS number FROM trial)
     JOIN session USING (session_id) JOIN person USING (participant_id) JOIN study USING (study_id)
     LEFT JOIN held ON held.session_id = session.session_id AND key = 'force limit' AND since < number
                       AND number <= coalesce(until, number)
WHERE study_name = {study} AND session_kind = {kind}
GROUP BY force_limit ORDER BY force_limit

-- What tells neither who nor when nor which machine.

-- name: made
SELECT key, value, count(DISTINCT session_id) AS sessions
FROM held JOIN session USING (session_id) JOIN person USING (participant_id) JOIN study USING (study_id)
WHERE study_name = {study} AND session_kind = {kind} AND value <> '' AND (until IS NULL OR until > since)
      AND key IN ('palpate', 'build id', 'compiler', 'libc', 'sqlite', 'zlib', 'nettle', 'calibration sha256')
GROUP BY key, value ORDER BY key, sessions DESC, value

-- name: levels
SELECT felt, friction, level, n, n * 1.0 / sum(n) OVER (PARTITION BY felt, friction) AS share
FROM (SELECT planned_object AS felt, friction, answer_code + 1 AS level, count(*) AS n,
             min(curvature_per_m) AS curvature
      FROM main WHERE counts AND NOT left_out AND run_number IS NULL AND answer_code IS NOT NULL
      GROUP BY planned_object, friction, level)
ORDER BY curvature, felt, friction, level

-- name: means
SELECT felt, friction, person, left_out, n, mean_level
FROM (SELECT planned_object AS felt, friction, person, left_out, count(*) AS n, avg(answer_code + 1) AS mean_level,
             min(curvature_per_m) AS curvature
      FROM main WHERE counts AND run_number IS NULL AND answer_code IS NOT NULL
      GROUP BY planned_object, friction, person)
ORDER BY curvature, felt, friction, person

-- name: times
SELECT person, left_out, friction, count(*) AS n,
       geometric_mean(iif(reaction_s > 0, reaction_s, NULL)) AS response_s,
       geometric_mean((SELECT nullif(sum(done_s - first_contact_s), 0) FROM presentation
                       WHERE presentation.trial_id = main.trial_id)) AS exploration_s
FROM main WHERE counts
GROUP BY person, friction ORDER BY person, friction

-- name: deciles
WITH own AS (
    SELECT person, friction, value AS share, quantile(reaction_s, value) AS response_s
    FROM main, (SELECT column1 AS value FROM (VALUES (0.1), (0.2), (0.3), (0.4), (0.5), (0.6), (0.7), (0.8), (0.9)))
    WHERE counts AND NOT left_out AND reaction_s > 0
    GROUP BY person, friction, value)
SELECT friction, share, count(*) AS people, geometric_mean(response_s) AS response_s
FROM own GROUP BY friction, share ORDER BY friction, share

-- name: confidence
WITH own AS (
    SELECT person, confidence AS level, count(*) AS n,
           avg({right}) AS share
    FROM main WHERE counts AND NOT left_out AND confidence IS NOT NULL
    GROUP BY person, confidence)
SELECT level, sum(n) AS answers, count(*) AS people, avg(share) AS share,
       people_share_low(share) AS share_low, people_share_high(share) AS share_high
FROM own GROUP BY level ORDER BY level

-- name: sure
SELECT person, left_out, friction, count(*) AS n, avg(confidence) AS confidence
FROM main WHERE counts AND confidence IS NOT NULL
GROUP BY person, friction ORDER BY person, friction

-- A trial is of the tenth in which its middle lies.

-- name: tenths
WITH numbered AS (
    SELECT *, (2 * row_number() OVER (PARTITION BY person ORDER BY session_number, trial_number) - 1) * 5
               / count(*) OVER (PARTITION BY person) + 1 AS tenth
    FROM main WHERE counts AND NOT left_out),

-- name: learning
own AS (
    SELECT person, tenth, avg({hit}) AS share, avg(ln(iif(reaction_s > 0, reaction_s, NULL))) AS log_rt
    FROM numbered GROUP BY person, tenth)
SELECT tenth, count(*) AS people, avg(share) AS share, people_share_low(share) AS share_low,
       people_share_high(share) AS share_high, exp(avg(log_rt)) AS response_s,
       exp(people_mean_low(log_rt)) AS response_low, exp(people_mean_high(log_rt)) AS response_high
FROM own GROUP BY tenth ORDER BY tenth

-- name: learning_times
own AS (
    SELECT person, tenth, avg(ln(iif(reaction_s > 0, reaction_s, NULL))) AS log_rt
    FROM numbered GROUP BY person, tenth)
SELECT tenth, count(*) AS people, exp(avg(log_rt)) AS response_s,
       exp(people_mean_low(log_rt)) AS response_low, exp(people_mean_high(log_rt)) AS response_high
FROM own GROUP BY tenth ORDER BY tenth

-- name: attempt
SELECT trial_id, session_number, trial_number, phase, block, plan_position, attempt, planned_object, friction,
       object_1, object_2, friction_1, friction_2, curvature_1_per_m, curvature_2_per_m, mu_s_1, mu_s_2,
       run_name, stimulus, answer_code, chosen_object, correct, confidence, outcome, fault_cause, exclusion, counts,
       first_contact_s, done_s, reaction_s, confidence_reaction_s
FROM analysis_trial

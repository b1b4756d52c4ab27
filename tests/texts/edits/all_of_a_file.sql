SELECT participant_code, handedness, consent, consent_utc FROM participant ORDER BY participant_code
SELECT participant_code, key, value FROM participant_detail JOIN participant USING (participant_id) ORDER BY participant_code, key
SELECT protocol_sha256, protocol_toml, study_name, study_title FROM study ORDER BY 1
SELECT uuid, protocol_sha256, participant_code, session_number, session_kind, seed, plan_sha256, shuffles, device, rate_hz, stiffness_n_per_m, started_utc, finished_utc, finished, operator FROM session JOIN study USING (study_id) JOIN participant USING (participant_id) ORDER BY uuid
SELECT uuid, key, value FROM session_provenance JOIN session USING (session_id) ORDER BY 1, 2
SELECT uuid, plan_position, phase, planned_object, curvature_per_m, friction, mu_s, mu_d, break_before, block FROM plan JOIN session USING (session_id) ORDER BY uuid, plan_position
SELECT uuid, plan_position, attempt, outcome, trial.started_utc, ended_utc, done_s, invalid_reason, trial.ticks, energy_j, chosen_place, chosen_object, correct, reaction_s, (SELECT group_concat(hex(data) || crc32 || first_tick, '/') FROM (SELECT * FROM trace_chunk WHERE trace_chunk.trial_id = trial.trial_id ORDER BY first_tick)) FROM trial JOIN session USING (session_id) LEFT JOIN response USING (trial_id) ORDER BY uuid, trial.trial_id
SELECT uuid, event.event_kind, at_utc, trial.plan_position, attempt, text FROM event JOIN session USING (session_id) LEFT JOIN trial USING (trial_id) ORDER BY uuid, event.event_id

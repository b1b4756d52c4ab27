INSERT INTO participant (participant_code, subject) VALUES ('Jane Doe', 1)
INSERT INTO participant (participant_code, subject) VALUES ('', 1)
UPDATE session SET session_kind = 'maybe'
UPDATE session SET rate_hz = 0
UPDATE plan SET mu_s = 0.1, mu_d = 0.5
UPDATE plan SET phase = 'other'
INSERT INTO trial (device, session_id, plan_position, attempt, outcome, started_utc) VALUES ('test', 1, 999, 1, 'running', '')
INSERT INTO trial (device, session_id, plan_position, attempt, outcome, started_utc) VALUES ('test', 1, 0, 1, 'lost', '')
INSERT INTO response VALUES (77, 0, 'convex', 1, 1.0, 0.0, 'key')
INSERT INTO trace_chunk VALUES (77, 1, 0, 1, 1, 1000000, '', 0, 0, x'00')
INSERT INTO trial (device, session_id, plan_position, attempt, outcome, started_utc, fault_cause) VALUES ('test', 1, 0, 1, 'complete', '', 'late')
INSERT INTO fault_tick (trial_id, tick, time_s, count_1, count_2, code_1, code_2, flags, mode, segment) VALUES (77, 0, 0, 0, 0, 0, 0, 0, 'free', 0)
INSERT INTO event (session_id, event_kind, text, at_utc, trials_begun) VALUES (99, 'note', 'b', 'c', 0)
INSERT INTO event (session_id, event_kind, text, at_utc, trials_begun) VALUES (1, 'a', 'b', 'c', 0)
DELETE FROM study
INSERT INTO study (study_name, study_title, protocol_sha256, protocol_toml) VALUES ('x', 'y', 'short', '')
UPDATE session SET session_number = 'one'

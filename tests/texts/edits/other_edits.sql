INSERT INTO trial (device, trial_id, session_id, plan_position, attempt, outcome, started_utc) SELECT device, 99, session_id, plan_position, attempt + 7, 'interrupted', started_utc FROM trial WHERE trial_id = 2
INSERT INTO session_provenance VALUES (1, 'zz', 'x')
INSERT INTO picture VALUES (2, 0, 'straight')
INSERT INTO plan SELECT session_id, 90, phase, planned_object, friction, mu_s, mu_d, break_before, block, curvature_per_m FROM plan WHERE session_id = 1 AND plan_position = 3
INSERT INTO adaptive_step SELECT 2, rule_outcome, staircase, estimate, estimates, state_sha256 FROM adaptive_step LIMIT 1
INSERT INTO trace_chunk SELECT trial_id, 2, first_tick, ticks, codec, period_ns, holds, crc32, derived, data FROM trace_chunk WHERE trial_id = 2
DELETE FROM event WHERE event_id = (SELECT min(event_id) FROM event)
DELETE FROM presentation WHERE trial_id = 2
DELETE FROM adaptive_plan WHERE plan_position = 2
DELETE FROM adaptive_step WHERE trial_id = (SELECT max(trial_id) FROM adaptive_step)
UPDATE trial SET seal = NULL, seal_events = NULL
DROP VIEW confusion; CREATE VIEW confusion AS SELECT * FROM analysis_trial WHERE counts
DROP VIEW session_health
UPDATE session SET session_kind = 'pilot' WHERE session_id = 2
UPDATE session SET seed = '7' WHERE session_id = 1
UPDATE plan SET phase = 'catch' WHERE plan_position = 1
UPDATE trial SET outcome = 'complete' WHERE outcome = 'timed_out'
UPDATE response SET input = 'key' WHERE trial_id = (SELECT max(trial_id) FROM response)
UPDATE trace_column SET type = 'u8' WHERE codec = 1 AND name = 'tick'
UPDATE trace_column SET rule = 'plain' WHERE codec = 1 AND name = 'tick'
UPDATE trace_column SET part = 'hip' WHERE codec = 1 AND name = 'tick'
ALTER TABLE response ADD COLUMN fake REAL DEFAULT 5
CREATE TRIGGER t AFTER INSERT ON response BEGIN UPDATE response SET correct = 1; END

UPDATE trial SET started_utc = '' WHERE trial_id = 1
UPDATE response SET input = 'mouse' WHERE trial_id = 3
UPDATE response SET chosen_place = 2, chosen_object = 'convex' WHERE trial_id = 4
UPDATE event SET text = 'before it' WHERE event_id = 3
UPDATE event SET operator = 'Bo' WHERE event_kind = 'mark'
UPDATE event SET seal = NULL WHERE event_id = 2
UPDATE session SET newest_seal = NULL
DELETE FROM event WHERE event_kind = 'mark'; UPDATE trial SET invalid_reason = NULL
DELETE FROM event WHERE event_id = 1
INSERT INTO event (event_id, session_id, event_kind, text, at_utc, trials_begun) VALUES (0, 1, 'note', 'b', '', 0)
UPDATE session SET device = 'another'
UPDATE session SET uuid = replace(uuid, substr(uuid, 1, 8), '00000000')
UPDATE session SET finished_utc = '2026'
UPDATE trace_chunk SET derived = derived + 1 WHERE trial_id = 5
DELETE FROM trace_chunk WHERE trial_id = 2
UPDATE trial SET seal = NULL
UPDATE trial SET seal = NULL WHERE trial_id = 3
UPDATE trial SET seal_events = seal_events + 1 WHERE trial_id = 3
UPDATE session SET seal = NULL
UPDATE participant SET participant_code = 'P02'
UPDATE plan SET mu_s = 0.9 WHERE plan_position = 3

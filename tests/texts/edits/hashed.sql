UPDATE response SET correct = 1 - correct WHERE trial_id = 3
UPDATE response SET reaction_s = reaction_s + 1e-15 WHERE trial_id = 1
UPDATE plan SET planned_object = planned_object || '2' WHERE plan_position = 2
UPDATE session SET seed = '8'
UPDATE presentation SET slip_decay = 0.5 WHERE trial_id = 2
UPDATE event SET text = 'another' WHERE event_kind = 'note'
DELETE FROM trace_chunk WHERE trial_id = 4 AND first_tick = 4096
UPDATE picture SET picture_place = 2 - picture_place + 10

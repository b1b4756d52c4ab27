UPDATE event SET text = ?1
UPDATE session SET device = ?1, operator = ?1
UPDATE session SET uuid = ?1
UPDATE participant_detail SET value = ?1
UPDATE study SET study_id = ?1
UPDATE session SET study_id = ?1
UPDATE participant SET participant_code = ?1
UPDATE plan SET phase = ?1

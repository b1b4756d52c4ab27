UPDATE trial SET fault_cause = 'late'
UPDATE trial SET fault_cause = NULL
UPDATE trial SET outcome = 'aborted', fault_cause = NULL
DELETE FROM fault_tick WHERE trial_id = 1 AND tick % 7 = 0

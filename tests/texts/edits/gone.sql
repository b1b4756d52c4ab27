DELETE FROM session_provenance WHERE key LIKE 'object sha256 straight'
UPDATE session_provenance SET value = upper(value) WHERE key LIKE 'object sha256 convex%'
UPDATE session_provenance SET value = replace(value, '50', '51') WHERE key = 'calibration'
DELETE FROM session_provenance WHERE key = 'calibration sha256'
DELETE FROM trace_chunk WHERE rowid IN (SELECT rowid FROM trace_chunk WHERE trial_id = 2 ORDER BY first_tick DESC LIMIT 1)
DELETE FROM response WHERE trial_id = 3; DELETE FROM trace_chunk WHERE trial_id = 3;DELETE FROM trial WHERE trial_id = 3

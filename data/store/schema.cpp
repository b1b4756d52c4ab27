#include "data/store/schema.hpp"

#include <string>

#include "data/store/adaptive_store.hpp"
#include "data/store/presentation.hpp"

namespace palpate::data {
namespace {

constexpr const char* kTables = R"sql(
-- palpate, schema 5. SI units, in the column names. Times *_utc are wall clock and for people;
-- every duration comes from the servo's monotonic clock.
PRAGMA application_id = 1885432944;
PRAGMA user_version = 5;

CREATE TABLE study (
    -- A protocol as it was read: the text is canonical, its SHA-256 the study's identity.
    id              INTEGER PRIMARY KEY,
    name            TEXT NOT NULL,
    title           TEXT NOT NULL,
    protocol_sha256 TEXT NOT NULL UNIQUE CHECK (length(protocol_sha256) = 64),
    protocol_toml   TEXT NOT NULL
) STRICT;

CREATE TABLE participant (
    -- Pseudonyms only.
    id          INTEGER PRIMARY KEY,
    code        TEXT NOT NULL UNIQUE CHECK (length(code) BETWEEN 1 AND 64 AND code NOT GLOB '*[^A-Za-z0-9_-]*'),
    handedness  INTEGER CHECK (handedness BETWEEN -100 AND 100),  -- Edinburgh score: -100 left, 100 right
    consent     INTEGER CHECK (consent IN (0, 1)),  -- to take part; NULL: nobody noted it
    consent_utc TEXT                                -- when that was noted
) STRICT;

)sql";

/// As of schema 5.
constexpr const char* kSession5 = R"sql(
CREATE TABLE session (
    id                  INTEGER PRIMARY KEY,
    study               INTEGER NOT NULL REFERENCES study,
    participant         INTEGER NOT NULL REFERENCES participant,
    number              INTEGER NOT NULL CHECK (number >= 1),
    kind                TEXT NOT NULL CHECK (kind IN ('real', 'pilot', 'simulated')),
    seed                TEXT NOT NULL               -- unsigned 64 bit, decimal
                            CHECK (length(seed) BETWEEN 1 AND 20 AND seed NOT GLOB '*[^0-9]*'),
    plan_sha256         TEXT NOT NULL CHECK (length(plan_sha256) = 64),
    shuffles            INTEGER NOT NULL CHECK (shuffles >= 1),  -- orders proposed until one kept the limits
    device              TEXT NOT NULL,
    rate_hz             REAL NOT NULL CHECK (rate_hz > 0),
    stiffness_n_per_m   REAL NOT NULL CHECK (stiffness_n_per_m > 0),
    started_utc         TEXT NOT NULL,
    finished_utc        TEXT,
    finished            INTEGER NOT NULL DEFAULT 0 CHECK (finished IN (0, 1)),
    operator            TEXT,                       -- who ran it, as given
    uuid                TEXT NOT NULL UNIQUE        -- RFC 9562, random (version 4); of a session from before
                            CHECK (length(uuid) = 36 AND uuid NOT GLOB '*[^0-9a-f-]*'),  -- schema 5: version 8
    UNIQUE (study, participant, number)
) STRICT;
)sql";

constexpr const char* kTables2 = R"sql(
CREATE TABLE session_provenance (
    -- What shaped the session besides its protocol: versions, compiler, kernel, the device's calibration,
    -- what the force loop was allowed (scheduling, memory).
    session INTEGER NOT NULL REFERENCES session,
    key     TEXT NOT NULL,
    value   TEXT NOT NULL,
    PRIMARY KEY (session, key)
) STRICT;

CREATE TABLE plan (
    -- The whole order, complete before the first trial.
    session          INTEGER NOT NULL REFERENCES session,
    position         INTEGER NOT NULL CHECK (position >= 0),
    phase            TEXT NOT NULL CHECK (phase IN ('practice', 'main', 'catch')),
    object           TEXT NOT NULL,
    curvature_per_m  REAL NOT NULL,                 -- > 0 convex, 0 straight, < 0 concave
    friction         TEXT NOT NULL,
    mu_s             REAL NOT NULL CHECK (mu_s >= mu_d),
    mu_d             REAL NOT NULL CHECK (mu_d >= 0),
    break_before     INTEGER NOT NULL CHECK (break_before IN (0, 1)),
    block            INTEGER NOT NULL DEFAULT 0 CHECK (block >= 0),  -- of the main phase; 0 in practice
    PRIMARY KEY (session, position)
) STRICT;

CREATE TABLE picture (
    -- The pictures from left to right, the same for all trials of a participant.
    session INTEGER NOT NULL REFERENCES session,
    place   INTEGER NOT NULL CHECK (place >= 0),
    object  TEXT NOT NULL,
    PRIMARY KEY (session, place),
    UNIQUE (session, object)
) STRICT;

CREATE TABLE trial (
    -- One attempt at a planned trial. Attempts that faulted or do not count stay, and the position is run
    -- again at a random later place of its block (practice, or main and catch); others at once.
    id                  INTEGER PRIMARY KEY,
    session             INTEGER NOT NULL,
    position            INTEGER NOT NULL,
    attempt             INTEGER NOT NULL CHECK (attempt >= 1),
    outcome             TEXT NOT NULL CHECK (outcome IN
                            ('running', 'complete', 'timed_out', 'aborted', 'interrupted', 'faulted')),
    slip_decay          REAL NOT NULL,              -- exp(-T/tau_slip) as computed on this machine
    heal_decay          REAL NOT NULL,              -- exp(-T/tau_heal)
    done_s              REAL,                       -- first tick -> done
    done_uncertainty_s  REAL,
    first_contact_s     REAL,                       -- first tick -> first contact
    ticks               INTEGER CHECK (ticks >= 0),
    contact_ticks       INTEGER,
    slip_ticks          INTEGER,
    late_ticks          INTEGER,
    saturated_ticks     INTEGER,
    path_length_m       REAL,
    mean_normal_force_n REAL,
    max_normal_force_n  REAL,
    energy_j            REAL,                       -- work done on the user
    started_utc         TEXT NOT NULL,
    ended_utc           TEXT,
    contact_episodes    INTEGER,                    -- times that HIP came into contact
    worst_episode_j     REAL,                       -- most energy an episode gave beyond K/2 sum |dh|^2; <= 0: passive
    skipped_ticks       INTEGER,                    -- out of reach: nothing was computed
    fault               TEXT CHECK (fault IS NULL OR outcome = 'faulted'),  -- why the force went off, e.g. over_speed
    slewed_ticks        INTEGER,                    -- the slew limit held the force back
    stale_ticks         INTEGER,                    -- without a new reading
    invalid             TEXT CHECK (length(invalid) > 0),  -- why its answer does not count; NULL: it does
    chain               TEXT CHECK (length(chain) = 64),   -- head of the session's chain of hashes at its end
    UNIQUE (session, position, attempt),
    FOREIGN KEY (session, position) REFERENCES plan (session, position)
) STRICT;

CREATE TABLE event (
    id      INTEGER PRIMARY KEY,
    session INTEGER NOT NULL REFERENCES session,
    trial   INTEGER REFERENCES trial,
    kind    TEXT NOT NULL,
    text    TEXT NOT NULL,
    at_utc  TEXT NOT NULL
) STRICT;
)sql";

/// As of schema 5.
constexpr const char* kTraces5 = R"sql(
CREATE TABLE trace_chunk (
    -- Servo ticks of one interval of a trial. While the trial runs its last chunk is replaced by a longer one.
    -- codec 2, up to 4096 ticks: data are the sizes of the columns' streams (u32le each), then the streams,
    -- columns in the order of trace_column without the parts that the chunk does not hold. A stream is a
    -- zlib stream of the values, bytes shuffled: all first bytes, all second bytes, ... Size 0: all bytes 0.
    -- codec 1, 256 ticks, of files from before schema 5: all columns, shuffled alike, as one zlib stream.
    trial      INTEGER NOT NULL REFERENCES trial,
    interval   INTEGER NOT NULL CHECK (interval BETWEEN 1 AND 2),  -- of a trial with two things to feel
    first_tick INTEGER NOT NULL CHECK (first_tick >= 0),
    ticks      INTEGER NOT NULL CHECK (ticks BETWEEN 1 AND 4096),
    codec      INTEGER NOT NULL CHECK (codec IN (1, 2)),
    period_ns  INTEGER NOT NULL,                    -- of the servo; codec 1: 0
    holds      TEXT NOT NULL,                       -- the parts of trace_column that are in here, by words
    crc32      INTEGER NOT NULL,                    -- codec 2: of data; codec 1: of the bytes before zlib
    derived    INTEGER CHECK (codec = 1 OR derived IS NOT NULL),  -- hash of the ticks as the servo had them:
                                                    -- data/trace/derived_hash.hpp
    data       BLOB NOT NULL,
    PRIMARY KEY (trial, interval, first_tick)
) STRICT;

CREATE TABLE trace_column (
    -- Number * scale is in the unit. Rules say what was taken from a value before it was written: plain
    -- nothing; delta the value before; after one more than the value before (before the first: first_tick - 1);
    -- clock tick * period_ns, then as delta; exact nothing. All but plain and exact are folded: 0, -1, 1, -2
    -- are 0, 1, 2, 3, in two's complement of the type. part: only chunks that hold it have the column; in
    -- others it follows by replay from the scene. *_xor_*: bits of the command XOR bits of fx_n, fy_n.
    -- -2147483648 in a column of 100 nm or 100 uN: not a number; 2147483647: that much or more.
    codec    INTEGER NOT NULL,
    position INTEGER NOT NULL,
    name     TEXT NOT NULL,
    type     TEXT NOT NULL CHECK (type IN ('f64le', 'f32le', 'i64le', 'u64le', 'i32le', 'i16le', 'u8')),
    unit     TEXT NOT NULL,
    scale    REAL NOT NULL,
    rule     TEXT NOT NULL CHECK (rule IN ('plain', 'after', 'clock', 'delta', 'exact')),
    part     TEXT NOT NULL CHECK (part IN ('', 'hip', 'contact', 'command', 'lateness')),
    PRIMARY KEY (codec, position)
) STRICT;
)sql";

/// What analysts read. As of schema 4.
constexpr const char* kViews = R"sql(
CREATE VIEW trial_result AS
-- One row per answered trial that counts, practice and catch trials included: filter by phase and kind.
SELECT trial.id AS trial, study.name AS study, participant.code AS participant, session.number AS session,
       session.kind AS kind, plan.position AS position, plan.phase AS phase, plan.object AS object,
       plan.curvature_per_m AS curvature_per_m, plan.friction AS friction, response.object AS choice,
       response.correct AS correct, trial.outcome AS outcome, trial.first_contact_s AS first_contact_s,
       trial.done_s AS done_s, response.reaction_s AS reaction_s, response.uncertainty_s AS uncertainty_s,
       trial.path_length_m AS path_length_m, trial.contact_ticks / session.rate_hz AS contact_s,
       trial.slip_ticks * 1.0 / NULLIF(trial.contact_ticks, 0) AS slip_share,
       trial.mean_normal_force_n AS mean_normal_force_n, trial.max_normal_force_n AS max_normal_force_n,
       trial.saturated_ticks * 1.0 / NULLIF(trial.ticks, 0) AS saturated_share,
       trial.late_ticks * 1.0 / NULLIF(trial.ticks, 0) AS late_share
FROM trial
JOIN response ON response.trial = trial.id
JOIN plan ON plan.session = trial.session AND plan.position = trial.position
JOIN session ON session.id = trial.session
JOIN participant ON participant.id = session.participant
JOIN study ON study.id = session.study
WHERE trial.invalid IS NULL;

CREATE VIEW confusion AS
-- How often each object was taken for which, main trials only.
SELECT study, kind, friction, object, choice, count(*) AS n
FROM trial_result WHERE phase = 'main'
GROUP BY study, kind, friction, object, choice;

CREATE VIEW invalid_trial AS
-- One row per answered trial that does not count, with its answer and the reason.
SELECT trial.id AS trial, study.name AS study, participant.code AS participant, session.number AS session,
       session.kind AS kind, trial.position AS position, trial.attempt AS attempt, plan.phase AS phase,
       plan.object AS object, plan.friction AS friction, response.object AS choice,
       response.correct AS correct, trial.invalid AS reason
FROM trial
JOIN response ON response.trial = trial.id
JOIN plan ON plan.session = trial.session AND plan.position = trial.position
JOIN session ON session.id = trial.session
JOIN participant ON participant.id = session.participant
JOIN study ON study.id = session.study
WHERE trial.invalid IS NOT NULL;
)sql";

/// Since schema 4.
constexpr const char* kPeople = R"sql(
CREATE TABLE participant_detail (
    -- What a study asks of its participants besides: age, gender, ... In a table of its own, so that what
    -- is handed on can leave it out.
    participant INTEGER NOT NULL REFERENCES participant,
    key         TEXT NOT NULL CHECK (length(key) BETWEEN 1 AND 64 AND key NOT GLOB '*[^a-z0-9_]*'),
    value       TEXT NOT NULL,
    PRIMARY KEY (participant, key)
) STRICT;
)sql";

/// Since schema 3: why forces went off.
constexpr const char* kFaults = R"sql(
CREATE TABLE fault_tick (
    -- The last ticks before the force went off by itself, at most 100, the last one the fault's own. Here
    -- also when the trace lost them; named as in trace_column, NULL for what was not a number.
    -- flags: 1 saturated, 2 late, 4 ramped, 8 fault, 16 skipped, 32 held, 64 slewed (the force changed as
    -- fast as it may), 128 stale (no new reading: the last HIP again).
    -- mode: 0 free, 1 stuck, 2 slip, 3 transition. feature: >= 0 a segment, -1 - j vertex j.
    trial       INTEGER NOT NULL REFERENCES trial,
    tick        INTEGER NOT NULL,
    time_ns     INTEGER NOT NULL,
    count_1     INTEGER NOT NULL,
    count_2     INTEGER NOT NULL,
    code_1      INTEGER NOT NULL,
    code_2      INTEGER NOT NULL,
    lateness_us REAL,
    flags       INTEGER NOT NULL,
    mode        INTEGER NOT NULL,
    feature     INTEGER NOT NULL,
    parameter   REAL,
    hip_x_m     REAL,
    hip_y_m     REAL,
    cp_x_m      REAL,
    cp_y_m      REAL,
    go_x_m      REAL,
    go_y_m      REAL,
    fx_n        REAL,
    fy_n        REAL,
    command_x_n REAL,
    command_y_n REAL,
    fn_n        REAL,
    ft_n        REAL,
    mu          REAL,
    PRIMARY KEY (trial, tick)
) STRICT;

CREATE VIEW fault AS
-- One row per faulted trial: whose, which, why, and when.
SELECT trial.id AS trial, study.name AS study, participant.code AS participant, session.number AS session,
       session.kind AS kind, trial.position AS position, trial.attempt AS attempt, plan.phase AS phase,
       trial.fault AS cause, trial.done_s AS at_s, trial.ended_utc AS ended_utc,
       (SELECT count(*) FROM fault_tick WHERE fault_tick.trial = trial.id) AS ticks_kept
FROM trial
JOIN plan ON plan.session = trial.session AND plan.position = trial.position
JOIN session ON session.id = trial.session
JOIN participant ON participant.id = session.participant
JOIN study ON study.id = session.study
WHERE trial.outcome = 'faulted';
)sql";

constexpr const char* kFrom1 = R"sql(
-- 1 -> 2: the energy ledger of every trial. Trials recorded before stay NULL.
ALTER TABLE trial ADD COLUMN contact_episodes INTEGER;
ALTER TABLE trial ADD COLUMN worst_episode_j REAL;
ALTER TABLE trial ADD COLUMN skipped_ticks INTEGER;
PRAGMA user_version = 2;
)sql";

constexpr const char* kFrom2 = R"sql(
-- 2 -> 3: faults. Trials that faulted before have no cause.
ALTER TABLE trial ADD COLUMN fault TEXT CHECK (fault IS NULL OR outcome = 'faulted');
ALTER TABLE trial ADD COLUMN slewed_ticks INTEGER;
ALTER TABLE trial ADD COLUMN stale_ticks INTEGER;
PRAGMA user_version = 3;
)sql";

constexpr const char* kFrom3 = R"sql(
-- 3 -> 4: answers that do not count, blocks, people. What was answered before counts.
ALTER TABLE participant ADD COLUMN handedness INTEGER CHECK (handedness BETWEEN -100 AND 100);
ALTER TABLE participant ADD COLUMN consent INTEGER CHECK (consent IN (0, 1));
ALTER TABLE participant ADD COLUMN consent_utc TEXT;
ALTER TABLE session ADD COLUMN operator TEXT;
ALTER TABLE plan ADD COLUMN block INTEGER NOT NULL DEFAULT 0 CHECK (block >= 0);
ALTER TABLE trial ADD COLUMN invalid TEXT CHECK (length(invalid) > 0);
DROP VIEW confusion;
DROP VIEW trial_result;
PRAGMA user_version = 4;
)sql";

/// Other tables and the views keep their references to session by name: foreign keys are off during a
/// migration. derived_uuid() is Database's own.
constexpr const char* kFrom4 = R"sql(
-- 4 -> 5: sessions have a name of their own; traces by replay, chunks of before stay as they are; chains.
ALTER TABLE trace_chunk RENAME TO trace_chunk_4;
ALTER TABLE trace_column RENAME TO trace_column_4;
ALTER TABLE trial ADD COLUMN chain TEXT CHECK (length(chain) = 64);
CREATE TEMP TABLE session_4 AS SELECT * FROM session;
DROP TABLE session;
CREATE TEMP TABLE response_4 AS SELECT * FROM response;
DROP TABLE response;
)sql";
constexpr const char* kFrom4Rows = R"sql(
INSERT INTO session SELECT session_4.id, study, participant, number, kind, seed, plan_sha256, shuffles, device,
    rate_hz, stiffness_n_per_m, started_utc, finished_utc, finished, operator,
    derived_uuid(protocol_sha256 || ' ' || code || ' ' || number || ' ' || started_utc)
FROM temp.session_4 JOIN study ON study.id = study JOIN participant ON participant.id = participant;
DROP TABLE temp.session_4;
INSERT INTO trace_chunk SELECT trial, 1, first_tick, ticks, codec, 0, '', crc32, NULL, data FROM trace_chunk_4
    ORDER BY trial, first_tick;
DROP TABLE trace_chunk_4;
INSERT INTO trace_column SELECT codec, position, name, type, unit, 1.0, 'exact', '' FROM trace_column_4;
DROP TABLE trace_column_4;
PRAGMA user_version = 5;
)sql";

}  // namespace

std::string_view schema_sql() noexcept {
    static const std::string all = std::string(kTables) + kSession5 + kTables2 + kResponse5 +
                                   kTraces5 + kPresentation5 + kAdaptive5 + kPeople + kViews +
                                   kFaults + kAdaptiveViews5;
    return all;
}

std::string_view migration_sql(std::int64_t from) noexcept {
    static const std::string from_2 = std::string(kFrom2) + kFaults;
    static const std::string from_3 = std::string(kFrom3) + kPeople + kViews;
    static const std::string from_4 = std::string(kFrom4) + kSession5 + kTraces5 + kResponse5 +
                                      kResponse5From4 + kPresentation5 + kPresentation5From4 +
                                      kAdaptive5 + kAdaptiveViews5 + kFrom4Rows;
    return from == 1 ? std::string_view(kFrom1) : from == 2 ? from_2 : from == 3 ? from_3 : from_4;
}

}  // namespace palpate::data

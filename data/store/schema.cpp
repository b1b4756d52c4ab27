#include "data/store/schema.hpp"

#include <initializer_list>
#include <string>

#include "data/store/adaptive_store.hpp"
#include "data/store/presentation.hpp"
#include "data/store/views.hpp"

namespace palpate::data {
namespace {

constexpr const char* kTables = R"sql(
-- palpate, schema 1. SI units, in the column names. Times *_utc are wall clock and for people;
-- every duration comes from the servo's monotonic clock.
PRAGMA application_id = 1885432944;
PRAGMA user_version = 1;

CREATE TABLE secret (
    -- Random numbers that enter every order and stream of a session beside protocol, participant, number and seed:
    -- who has not this file cannot compute an order, and so not say whose an exported one is. Never exported
    -- or pushed. One is made with the file; merged files bring theirs. New sessions take the first by its digits.
    hex TEXT PRIMARY KEY                            -- 128 bits
            CHECK (length(hex) = 32 AND hex NOT GLOB '*[^0-9a-f]*')
) STRICT;

CREATE TABLE study (
    -- A protocol as it was read: the text is canonical, its SHA-256 the study's identity.
    study_id        INTEGER PRIMARY KEY,            -- of this file alone; its identity is protocol_sha256
    study_name      TEXT NOT NULL,                  -- the protocol's id
    title           TEXT NOT NULL,                  -- for people
    protocol_sha256 TEXT NOT NULL UNIQUE CHECK (length(protocol_sha256) = 64),  -- of protocol_toml
    protocol_toml   TEXT NOT NULL                   -- the protocol's canonical text
) STRICT;

CREATE TABLE participant (
    -- Pseudonyms only.
    participant_id INTEGER PRIMARY KEY,                -- of this file alone; people are known by participant_code
    participant_code TEXT NOT NULL UNIQUE                -- the pseudonym
                    CHECK (length(participant_code) BETWEEN 1 AND 64 AND participant_code NOT GLOB '*[^A-Za-z0-9_-]*'),
    handedness  INTEGER CHECK (handedness BETWEEN -100 AND 100),  -- Edinburgh score: -100 left, 100 right
    consent     INTEGER CHECK (consent IN (0, 1)),  -- to take part; NULL: nobody noted it
    consent_utc TEXT,                               -- when that was noted
    subject     INTEGER NOT NULL UNIQUE             -- the number in exports: drawn, and never changed
                    CHECK (subject BETWEEN 1 AND 9999999999)
) STRICT;

)sql";

constexpr const char* kSession = R"sql(
CREATE TABLE session (
    -- One sitting of a participant with a study, resumed or not.
    session_id          INTEGER PRIMARY KEY,        -- of this file alone; its identity is uuid
    study_id            INTEGER NOT NULL REFERENCES study,        -- study.study_id
    participant_id      INTEGER NOT NULL REFERENCES participant,  -- participant.participant_id
    session_number      INTEGER NOT NULL CHECK (session_number >= 1),           -- counted within the participant and study; 1: the first
    session_kind        TEXT NOT NULL CHECK (session_kind IN ('real', 'pilot', 'simulated')),  -- real data, or not
    seed                TEXT NOT NULL               -- unsigned 64 bit, decimal
                            CHECK (length(seed) BETWEEN 1 AND 20 AND seed NOT GLOB '*[^0-9]*'),
    plan_sha256         TEXT NOT NULL CHECK (length(plan_sha256) = 64),  -- of the whole order
    shuffles            INTEGER NOT NULL CHECK (shuffles >= 1),  -- orders proposed until one kept the limits
    device              TEXT NOT NULL,              -- as given to --device
    rate_hz             REAL NOT NULL CHECK (rate_hz > 0),  -- of the servo
    stiffness_n_per_m   REAL NOT NULL CHECK (stiffness_n_per_m > 0),  -- of the contact
    started_utc         TEXT NOT NULL,              -- wall clock, ISO 8601
    finished_utc        TEXT,                       -- NULL: not finished
    finished            INTEGER NOT NULL DEFAULT 0 CHECK (finished IN (0, 1)),  -- 1: every planned trial is done
    operator            TEXT,                       -- who ran it, as given
    uuid                TEXT NOT NULL UNIQUE        -- RFC 9562, random (version 4)
                            CHECK (length(uuid) = 36 AND uuid NOT GLOB '*[^0-9a-f-]*'),
    secret              TEXT NOT NULL REFERENCES secret,   -- secret.hex with which its orders were drawn
    seal                TEXT CHECK (length(seal) = 64),   -- hash over all of its results when it was finished
    seal_events         INTEGER,                    -- how many of its events came before that
    newest_seal         TEXT CHECK (length(newest_seal) = 64),    -- newest seal: of its last trial, event or its end
    UNIQUE (study_id, participant_id, session_number)
) STRICT;
)sql";

constexpr const char* kTables2 = R"sql(
CREATE TABLE session_provenance (
    -- What shaped the session besides its protocol: versions, compiler, kernel, the device's calibration,
    -- what the force loop was allowed (scheduling, memory).
    session_id INTEGER NOT NULL REFERENCES session,    -- session.session_id
    key     TEXT NOT NULL,                          -- what, e.g. build id
    value   TEXT NOT NULL,                          -- as it was when the session began
    PRIMARY KEY (session_id, key)
) STRICT;

CREATE TABLE plan (
    -- The whole order, complete before the first trial.
    session_id       INTEGER NOT NULL REFERENCES session,  -- session.session_id
    plan_position    INTEGER NOT NULL CHECK (plan_position >= 0),  -- from 0, in the order planned
    phase            TEXT NOT NULL CHECK (phase IN ('practice', 'main', 'catch')),  -- analyse main
    planned_object   TEXT NOT NULL,                 -- its name in the protocol; of two intervals: the standard's
    friction         TEXT NOT NULL,                 -- the condition's name in the protocol
    mu_s             REAL NOT NULL CHECK (mu_s >= mu_d),  -- static friction coefficient
    mu_d             REAL NOT NULL CHECK (mu_d >= 0),     -- dynamic friction coefficient
    break_before     INTEGER NOT NULL CHECK (break_before IN (0, 1)),  -- 1: a break comes first
    block            INTEGER NOT NULL DEFAULT 0 CHECK (block >= 0),  -- of the main phase; 0 in practice
    curvature_per_m  REAL,                          -- > 0 convex, 0 straight, < 0 concave; NULL: a free form
    PRIMARY KEY (session_id, plan_position)
) STRICT;

CREATE TABLE picture (
    -- The pictures from left to right, the same for all trials of a participant.
    session_id INTEGER NOT NULL REFERENCES session,    -- session.session_id
    picture_place INTEGER NOT NULL CHECK (picture_place >= 0),    -- from 0, from the left
    picture_object TEXT NOT NULL,                          -- its name in the protocol
    PRIMARY KEY (session_id, picture_place),
    UNIQUE (session_id, picture_object)
) STRICT;

CREATE TABLE trial (
    -- One attempt at a planned trial. Attempts that faulted or do not count stay, and the position is run
    -- again at a random later place of its block (practice, or main and catch); others at once.
    trial_id            INTEGER PRIMARY KEY,        -- in the order in which they began
    session_id          INTEGER NOT NULL,           -- session.session_id
    plan_position            INTEGER NOT NULL,           -- plan.plan_position
    attempt             INTEGER NOT NULL CHECK (attempt >= 1),  -- at this position
    outcome             TEXT NOT NULL CHECK (outcome IN  -- complete and timed_out have an answer
                            ('running', 'complete', 'timed_out', 'aborted', 'interrupted', 'faulted')),
    done_s              REAL,                       -- first tick -> done
    done_uncertainty_s  REAL,                       -- done may have been up to this much earlier
    first_contact_s     REAL,                       -- first tick -> first contact
    ticks               INTEGER CHECK (ticks >= 0), -- of the servo, from the first to done
    contact_ticks       INTEGER,                    -- with the hand in the object
    slip_ticks          INTEGER,                    -- of these: slip or transition
    late_ticks          INTEGER,                    -- woke more than half a period late
    saturated_ticks     INTEGER,                    -- the device could not give the force
    path_length_m       REAL,                       -- of HIP
    mean_normal_force_n REAL,                       -- over contact ticks, 0 without contact
    max_normal_force_n  REAL,                       -- largest rendered normal force
    energy_j            REAL,                       -- work done on the user
    started_utc         TEXT NOT NULL,              -- wall clock, ISO 8601
    ended_utc           TEXT,                       -- wall clock; NULL: it never ended
    contact_episodes    INTEGER,                    -- times that HIP came into contact
    worst_episode_j     REAL,                       -- most energy an episode gave beyond K/2 sum |dh|^2; <= 0: passive
    skipped_ticks       INTEGER,                    -- out of reach: nothing was computed
    fault_cause         TEXT CHECK (fault_cause IS NULL OR outcome = 'faulted'),  -- why the force went off, e.g. over_speed
    force_slew_ticks    INTEGER,                    -- the force slew kept the force back
    stale_ticks         INTEGER,                    -- without a new reading
    invalid_reason      TEXT CHECK (length(invalid_reason) > 0),  -- why its answer does not count; NULL: it does
    seal                TEXT CHECK (length(seal) = 64),   -- hash over all results of the session up to its end
    seal_events         INTEGER,                    -- how many of the session's events came before that
    strokes             INTEGER,                    -- along the surface, 5 mm or more in one direction
    mean_speed_m_per_s  REAL,                       -- of HIP in contact: its path there by the time there
    before_vertex_ticks INTEGER,                    -- in contact with segment 0, before vertex 0
    after_vertex_ticks  INTEGER,                    -- in contact with segment 1, after vertex 0
    started_ns          INTEGER,                    -- when it began, on the servo's clock
    UNIQUE (session_id, plan_position, attempt),
    FOREIGN KEY (session_id, plan_position) REFERENCES plan (session_id, plan_position)
) STRICT;

CREATE TABLE event (
    -- What happened in a session beside its trials. Programs go by kind and numbers: the text is for people.
    event_id INTEGER PRIMARY KEY,                   -- in the order in which they happened
    session_id INTEGER NOT NULL REFERENCES session,  -- session.session_id
    trial_id INTEGER REFERENCES trial,              -- trial.trial_id; NULL: of the session as a whole
    event_kind TEXT NOT NULL CHECK (event_kind IN   -- what
                ('break', 'pause', 'go on', 'abort', 'gave up', 'fault', 'reconnect', 'invalid', 'note',
                 'mark', 'redo', 'interrupted', 'timing', 'ticks lost', 'masking', 'display lost',
                 'device', 'operator', 'provenance', 'participant', 'planned again')),
    text    TEXT NOT NULL,                          -- a sentence; of a mark the reason
    at_utc  TEXT NOT NULL,                          -- wall clock, ISO 8601
    at_ns   INTEGER,                                -- servo's clock (CLOCK_MONOTONIC of the rig), as trial.started_ns
    operator TEXT,                                  -- who noted it, as given; NULL: nobody said
    seal    TEXT CHECK (length(seal) = 64),         -- hash over all results of the session with this event
    trials_begun INTEGER NOT NULL CHECK (trials_begun >= 0),  -- of the session by then
    plan_position INTEGER CHECK (plan_position >= 0),  -- that it is about, or that comes next
    part    INTEGER CHECK (part >= 0),              -- redo: 0 practice, else 1 + plan.block
    count   INTEGER CHECK (count >= 0),             -- ticks lost; redo: answers; gave up, reconnect: tries in vain
    duration_s REAL CHECK (duration_s >= 0),        -- go on: of the pause; masking: without noise
    key     TEXT,                                   -- provenance, participant: what
    value   TEXT                                    -- of key; fault, go on: the cause; device, operator: the new one
) STRICT;
)sql";

constexpr const char* kTraces = R"sql(
CREATE TABLE trace_chunk (
    -- Servo ticks of one interval of a trial. While the trial runs its last chunk is replaced by a longer one.
    -- codec 1, up to 4096 ticks: data are the sizes of the columns' streams (u32le each), then the streams,
    -- columns in the order of trace_column without the parts that the chunk does not hold. A stream is a
    -- zlib stream of the values, bytes shuffled: all first bytes, all second bytes, ... Size 0: all bytes 0.
    trial_id      INTEGER NOT NULL REFERENCES trial,   -- trial.trial_id
    interval   INTEGER NOT NULL CHECK (interval BETWEEN 1 AND 2),  -- of a trial with two things to feel
    first_tick INTEGER NOT NULL CHECK (first_tick >= 0),  -- number of its first tick
    ticks      INTEGER NOT NULL CHECK (ticks BETWEEN 1 AND 4096),  -- how many it has
    codec      INTEGER NOT NULL CHECK (codec = 1),  -- how data is made
    period_ns  INTEGER NOT NULL,                    -- of the servo
    holds      TEXT NOT NULL,                       -- the parts of trace_column that are in here, by words
    crc32      INTEGER NOT NULL,                    -- of data
    derived    INTEGER NOT NULL,                    -- XXH3 of the ticks as the servo had them
    data       BLOB NOT NULL,                       -- the columns
    PRIMARY KEY (trial_id, interval, first_tick)
) STRICT;

CREATE TABLE trace_column (
    -- Number * scale is in the unit. Rules say what was taken from a value before it was written: plain
    -- nothing; delta the value before; after one more than the value before (before the first: first_tick - 1);
    -- clock tick * period_ns, then as delta; exact nothing. All but plain and exact are folded: 0, -1, 1, -2
    -- are 0, 1, 2, 3, in two's complement of the type. part: only chunks that hold it have the column; in
    -- others it follows by replay from the scene. *_xor_*: bits of the commanded force XOR bits of the rendered one.
    -- -2147483648 in a column of 100 nm or 100 uN: not a number; 2147483647: that much or more.
    codec    INTEGER NOT NULL,                      -- trace_chunk.codec
    column_position INTEGER NOT NULL,                      -- from 0, in the order of the bytes
    name     TEXT NOT NULL,                         -- of the column
    type     TEXT NOT NULL                          -- of a number as written, little-endian
                 CHECK (type IN ('f64le', 'f32le', 'i64le', 'u64le', 'i32le', 'i16le', 'u8')),
    unit     TEXT NOT NULL,                         -- of number * scale
    scale    REAL NOT NULL,                         -- in the unit
    rule     TEXT NOT NULL                          -- what was taken from a number before it was written
                 CHECK (rule IN ('plain', 'after', 'clock', 'delta', 'exact')),
    part     TEXT NOT NULL                          -- '': in every chunk, else in those that hold the part
                 CHECK (part IN ('', 'hip', 'contact', 'command', 'lateness')),
    PRIMARY KEY (codec, column_position)
) STRICT;
)sql";

constexpr const char* kPeople = R"sql(
CREATE TABLE participant_detail (
    -- What a study asks of its participants besides: age, gender, ... In a table of its own, so that what
    -- is handed on can leave it out.
    participant_id INTEGER NOT NULL REFERENCES participant,  -- participant.participant_id
    key         TEXT NOT NULL                       -- what, e.g. age
                    CHECK (length(key) BETWEEN 1 AND 64 AND key NOT GLOB '*[^a-z0-9_]*'),
    value       TEXT NOT NULL,                      -- as given
    PRIMARY KEY (participant_id, key)
) STRICT;
)sql";

/// Why forces went off.
constexpr const char* kFaults = R"sql(
CREATE TABLE fault_tick (
    -- The last ticks before the force went off by itself, at most 100, the last one the fault's own. Here
    -- also when the trace lost them; named as in trace_column, NULL for what was not a number.
    -- flags: 1 saturated, 2 late, 4 ramped, 8 fault, 16 skipped, 32 force cut, 64 force slew (the
    -- force changed as fast as it may), 128 stale (no new reading: the last HIP again).
    trial_id       INTEGER NOT NULL REFERENCES trial,  -- trial.trial_id
    tick        INTEGER NOT NULL,                   -- number of the tick, from 0
    time_s      REAL NOT NULL,                      -- since the interval's first deadline, on the servo's clock
    count_1     INTEGER NOT NULL,                   -- encoder 1
    count_2     INTEGER NOT NULL,                   -- encoder 2
    code_1      INTEGER NOT NULL,                   -- as written to motor 1
    code_2      INTEGER NOT NULL,                   -- as written to motor 2
    lateness_us REAL,                               -- wake-up minus deadline
    flags       INTEGER NOT NULL,                   -- bits, see the table
    mode        TEXT NOT NULL                       -- of the contact
                    CHECK (mode IN ('free', 'stuck', 'slip', 'transition')),
    segment     INTEGER NOT NULL,                   -- under the god-object: i >= 0 segment i, from 0; -1 - j vertex j, at the end of segment j
    u           REAL,                               -- of the god-object: its segment's own parameter (0 to 1, or its knots); on a vertex its angle, rad
    hip_x_m     REAL,                               -- haptic interaction point
    hip_y_m     REAL,                               -- its y
    cp_x_m      REAL,                               -- closest point of the outline
    cp_y_m      REAL,                               -- its y
    go_x_m      REAL,                               -- god-object
    go_y_m      REAL,                               -- its y
    rendered_x_n REAL,                               -- rendered force on the user
    rendered_y_n REAL,                               -- its y
    commanded_x_n REAL,                               -- force asked of the device, after the safety chain
    commanded_y_n REAL,                               -- its y
    rendered_normal_n REAL,                               -- F . n at the god-object
    rendered_tangential_n REAL,                               -- F . t at the god-object
    mu          REAL,                               -- friction coefficient in force
    PRIMARY KEY (trial_id, tick)
) STRICT;
)sql";

std::string joined(std::initializer_list<std::string_view> parts) {
    std::string all;
    for (const std::string_view part : parts) {
        all += part;
    }
    return all;
}

}  // namespace

std::string_view schema_sql() noexcept {
    static const std::string all =
        joined({kTables, kSession, kTables2, kResponse, kTraces, kPresentation, kAdaptive, kPeople,
                kFaults, views_sql()});
    return all;
}

}  // namespace palpate::data

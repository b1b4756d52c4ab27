-- palpate, schema 1. SI units, in the column names. Times *_utc are wall clock and for people;
-- every duration comes from the servo's monotonic clock, but for session_health.duration_s.
PRAGMA application_id = 1885432944;
PRAGMA user_version = 1;

CREATE TABLE secret (
    -- [file] Random numbers that enter every order and stream of a session beside protocol, participant, number
    -- and seed: who has not this file cannot compute an order, and so not say whose an exported one is. Never
    -- exported or pushed. One is made with the file; merged files bring theirs. New sessions take that of the
    -- first one.
    hex TEXT PRIMARY KEY                            -- 128 bits
            CHECK (length(hex) = 32 AND hex NOT GLOB '*[^0-9a-f]*')
) STRICT;

CREATE TABLE study (
    -- A protocol as it was read: the text is canonical, its SHA-256 the study's identity.
    study_id        INTEGER PRIMARY KEY,            -- [file] of this file alone; its identity is protocol_sha256
    study_name      TEXT NOT NULL,                  -- the protocol's id
    study_title     TEXT NOT NULL,                  -- the protocol's title, for people
    protocol_sha256 TEXT NOT NULL UNIQUE CHECK (length(protocol_sha256) = 64),  -- SHA-256 of the protocol's canonical text
    protocol_toml   TEXT NOT NULL                   -- [file] the protocol's canonical text
) STRICT;

CREATE TABLE participant (
    -- Pseudonyms only.
    participant_id   INTEGER PRIMARY KEY,           -- [file] of this file alone; people are known by participant_code
    participant_code TEXT NOT NULL UNIQUE           -- [file] the pseudonym
                         CHECK (length(participant_code) BETWEEN 1 AND 64
                                AND participant_code NOT GLOB '*[^A-Za-z0-9_-]*'
                                AND participant_code GLOB '[A-Za-z0-9]*'),
    handedness  INTEGER CHECK (handedness BETWEEN -100 AND 100),  -- [details] Edinburgh score: -100 left, 100 right
    handedness_utc TEXT,                            -- [details] when that was noted
    consent     INTEGER CHECK (consent IN (0, 1)),  -- to take part; NULL: nobody noted it {0 = no; 1 = yes}
    consent_utc TEXT,                               -- [details] when that was noted
    refusals_utc TEXT,                              -- [file] when consent was refused, each time known here, a blank between
    destroyed_utc TEXT,                             -- [file] when what was noted of them was destroyed, on request
    subject     INTEGER NOT NULL UNIQUE             -- [file] the number in exports: drawn, and never changed
                    CHECK (subject BETWEEN 1 AND 9999999999)
) STRICT;

CREATE TABLE participant_detail (
    -- [details] What a study asks of its participants besides: age, gender, ... In a table of its own, so that
    -- what is handed on can leave it out.
    participant_id INTEGER NOT NULL REFERENCES participant,  -- [file] participant.participant_id
    key            TEXT NOT NULL                    -- what was asked, e.g. age
                       CHECK (length(key) BETWEEN 1 AND 64 AND key NOT GLOB '*[^a-z0-9_]*'),
    value          TEXT NOT NULL,                   -- the answer, as given
    noted_utc      TEXT NOT NULL,                   -- when it was noted
    PRIMARY KEY (participant_id, key)
) STRICT;

CREATE TABLE session (
    -- One sitting of a participant with a study, resumed or not.
    session_id        INTEGER PRIMARY KEY,          -- [file] of this file alone; its identity is uuid
    study_id          INTEGER NOT NULL REFERENCES study,  -- [file] study.study_id
    participant_id    INTEGER NOT NULL REFERENCES participant,  -- [file] participant.participant_id
    session_number    INTEGER NOT NULL CHECK (session_number >= 1),  -- of the participant's sessions of the study, from 1
    session_kind      TEXT NOT NULL                 -- what the session is
                          -- {real = a session of the study; pilot = to try it; simulated = computed hand and answers}
                          CHECK (session_kind IN ('real', 'pilot', 'simulated')),
    seed              TEXT NOT NULL                 -- [details] study seed, unsigned 64 bit, decimal
                          CHECK (length(seed) BETWEEN 1 AND 20 AND seed NOT GLOB '*[^0-9]*'),
    plan_sha256       TEXT NOT NULL CHECK (length(plan_sha256) = 64),  -- [details] of the whole order
    shuffles          INTEGER NOT NULL CHECK (shuffles >= 1),  -- [details] orders proposed until one kept the limits
    device            TEXT NOT NULL,                -- [details] with which it began; each trial has its own
    rate_hz           REAL NOT NULL CHECK (rate_hz > 0),  -- servo ticks a second
    stiffness_n_per_m REAL NOT NULL CHECK (stiffness_n_per_m > 0),  -- of the contact
    started_utc       TEXT NOT NULL,                -- [details] begin, wall clock, ISO 8601
    finished_utc      TEXT,                         -- [details] end, wall clock; NULL: not finished
    finished          INTEGER NOT NULL DEFAULT 0 CHECK (finished IN (0, 1)),  -- 1: every planned trial is done {0 = no; 1 = yes}
    operator          TEXT,                         -- [details] who ran it, as given
    uuid              TEXT NOT NULL UNIQUE          -- [details] its name wherever it is copied to: RFC 9562, random (version 4)
                          CHECK (length(uuid) = 36 AND uuid NOT GLOB '*[^0-9a-f-]*'),
    secret            TEXT NOT NULL REFERENCES secret,  -- [file] secret.hex with which its orders were drawn
    seal              TEXT CHECK (length(seal) = 64),  -- [file] hash over all of its results when it was finished
    seal_events       INTEGER,                      -- [file] how many of its events came before that
    newest_seal       TEXT CHECK (length(newest_seal) = 64),  -- [file] of its last trial, its last event or its end
    run_code          TEXT,                         -- [file] the pseudonym under which it was run and its orders drawn; NULL: participant_code
    run_number        INTEGER CHECK (run_number >= 1),  -- [file] its session_number then; NULL: the same
    withdrawn_reason  TEXT CHECK (length(withdrawn_reason) > 0),  -- [file] why analyses and exports leave it out; NULL: they do not
    UNIQUE (study_id, participant_id, session_number)
) STRICT;

CREATE TABLE session_provenance (
    -- [details] What shaped the session besides its protocol: versions, compiler, kernel, the device's
    -- calibration, what the force loop was allowed (scheduling, memory).
    session_id INTEGER NOT NULL REFERENCES session, -- [file] session.session_id
    key        TEXT NOT NULL,                       -- what, e.g. build id
    value      TEXT NOT NULL,                       -- its version, text or hash, as it was when the session began
    PRIMARY KEY (session_id, key)
) STRICT;

CREATE TABLE plan (
    -- The whole order, complete before the first trial.
    session_id      INTEGER NOT NULL REFERENCES session,  -- [file] session.session_id
    plan_position   INTEGER NOT NULL CHECK (plan_position >= 0),  -- place in the plan, from 0
    phase           TEXT NOT NULL CHECK (phase IN ('practice', 'main', 'catch')),  -- part of the session
                        -- {practice = before the main trials, not to be analysed; main = the study; catch =
                        -- among the main ones, an object that no picture shows}
    planned_object  TEXT NOT NULL,                  -- its name in the protocol; of two intervals the standard's
    friction        TEXT NOT NULL,                  -- the condition's name in the protocol; of two intervals the comparison's
    mu_s            REAL NOT NULL CHECK (mu_s >= mu_d),  -- static coefficient of friction that friction has in the protocol, whatever a rule chose
    mu_d            REAL NOT NULL CHECK (mu_d >= 0),  -- dynamic coefficient of friction that friction has in the protocol, whatever a rule chose
    break_before    INTEGER NOT NULL CHECK (break_before IN (0, 1)),  -- 1: a break comes before it {0 = no; 1 = yes}
    block           INTEGER NOT NULL DEFAULT 0 CHECK (block >= 0),  -- of the main phase; 0 in practice
    curvature_per_m REAL,                           -- of planned_object, a surface's along x: > 0 convex, 0 straight, < 0 concave; NULL: a free form
    PRIMARY KEY (session_id, plan_position)
) STRICT;

CREATE TABLE adaptive_plan (
    -- Of trials whose stimulus a rule chooses, beside their rows of plan: these have the standard object and
    -- the friction of the comparison.
    session_id          INTEGER NOT NULL,           -- [file] session.session_id
    plan_position       INTEGER NOT NULL,           -- plan.plan_position
    run_number          INTEGER NOT NULL CHECK (run_number >= 0),  -- from 0; a run is one rule with its own answers
    run_name            TEXT NOT NULL,              -- the run's name in the protocol
    comparison_interval INTEGER NOT NULL            -- the interval with the rule's stimulus
                            CHECK (comparison_interval IN (1, 2)),
    standard_friction   TEXT NOT NULL,              -- friction of the other interval
    PRIMARY KEY (session_id, plan_position),
    FOREIGN KEY (session_id, plan_position) REFERENCES plan (session_id, plan_position)
) STRICT;

CREATE TABLE picture (
    -- The pictures from left to right, the same for all trials of a participant.
    session_id     INTEGER NOT NULL REFERENCES session,  -- [file] session.session_id
    picture_place  INTEGER NOT NULL CHECK (picture_place >= 0),  -- from left to right, from 0
    picture_object TEXT NOT NULL,                   -- which picture: the object's name in the protocol
    PRIMARY KEY (session_id, picture_place),
    UNIQUE (session_id, picture_object)
) STRICT;

CREATE TABLE trial (
    -- One attempt at a planned trial. Attempts that faulted, were not answered or do not count stay, and the position is run
    -- again at a random later place of its block (practice, or main and catch); others at once.
    trial_id            INTEGER PRIMARY KEY,        -- [file] of this file alone, in the order in which they began
    session_id          INTEGER NOT NULL,           -- [file] session.session_id
    plan_position       INTEGER NOT NULL,           -- place in the plan, from 0
    attempt             INTEGER NOT NULL CHECK (attempt >= 1),  -- at this position, from 1
    outcome             TEXT NOT NULL CHECK (outcome IN  -- how the attempt ended
                            ('running', 'complete', 'timed_out', 'aborted', 'interrupted', 'faulted',
                             'unanswered')),
                            -- {complete = answered; timed_out = answered after the time to explore was over;
                            -- unanswered = nobody answered within answer_timeout_s;
                            -- aborted = the experimenter ended it; interrupted = the program or machine stopped;
                            -- faulted = the force went off by itself; running = not ended}
    invalid_reason      TEXT CHECK (length(invalid_reason) > 0),  -- [details] why its answer does not count; NULL: it does
    device              TEXT NOT NULL,              -- [details] on which it was felt, as the device calls itself
    calibration_sha256  TEXT CHECK (length(calibration_sha256) = 64),  -- of the device's calibration; NULL: it has none
    fault_cause         TEXT CHECK (fault_cause IS NULL OR outcome = 'faulted'),  -- why the force went off, e.g. over_speed
    first_contact_s     REAL,                       -- first tick -> first contact; NULL: none
    done_s              REAL,                       -- first tick -> done, of two intervals added up
    done_uncertainty_s  REAL,                       -- the last done may have been up to this much earlier
    ticks               INTEGER CHECK (ticks >= 0), -- of the servo, from the first to done
    -- (measures() of protocols/session/trial_meter.cpp, by in_trial)
    started_ns          INTEGER,                    -- [details] begin, on the servo's clock (CLOCK_MONOTONIC of the rig); its first tick comes within some 0.1 s
    started_utc         TEXT NOT NULL,              -- [details] begin, wall clock, ISO 8601
    ended_utc           TEXT,                       -- [details] end, wall clock; NULL: it never ended
    seal                TEXT CHECK (length(seal) = 64),  -- [file] hash over all results of the session up to its end
    seal_events         INTEGER,                    -- [file] how many of the session's events came before that
    UNIQUE (session_id, plan_position, attempt),
    FOREIGN KEY (session_id, plan_position) REFERENCES plan (session_id, plan_position)
) STRICT;

CREATE TABLE presentation (
    -- What each interval of a trial let one feel, and how it was felt, from its first tick to done. Trials
    -- with two intervals are comparisons; the numbers of the trial are those of both together.
    trial_id            INTEGER NOT NULL REFERENCES trial,  -- [file] trial.trial_id
    interval            INTEGER NOT NULL CHECK (interval IN (1, 2)),  -- of the trial: 1 or 2
    stimulus            REAL,                       -- what the rule chose, in the protocol's unit; NULL: not chosen by a rule
    felt_object         TEXT NOT NULL,              -- what was felt: its name in the protocol
    curvature_per_m     REAL,                       -- as felt; NULL: no two-curve object
    friction            TEXT NOT NULL,              -- as felt: its name in the protocol
    mu_s                REAL NOT NULL CHECK (mu_s >= mu_d),  -- static coefficient of friction, as felt
    mu_d                REAL NOT NULL CHECK (mu_d >= 0),  -- dynamic coefficient of friction, as felt
    slip_decay          REAL NOT NULL,              -- exp(-T/tau_slip) as computed on this machine
    heal_decay          REAL NOT NULL,              -- exp(-T/tau_heal) as computed on this machine
    done_s              REAL,                       -- first tick -> done; NULL, as all below: it was cut off
    done_uncertainty_s  REAL,                       -- done may have been up to this much earlier
    first_contact_s     REAL,                       -- first tick -> first contact; NULL: none
    ticks               INTEGER CHECK (ticks >= 0), -- of the servo, up to done
    -- (measures() of protocols/session/trial_meter.cpp, by in_interval)
    PRIMARY KEY (trial_id, interval)
) STRICT;

CREATE TABLE response (
    -- The answer of a trial.
    trial_id       INTEGER PRIMARY KEY REFERENCES trial,  -- [file] trial.trial_id
    answer_code    INTEGER NOT NULL CHECK (answer_code >= 0),  -- picture from the left, from 0; interval - 1; 0 no, 1 yes; level - 1
    chosen_place   INTEGER CHECK (chosen_place >= 0),  -- picture.picture_place of the chosen one; NULL: no pictures
    chosen_object  TEXT,                            -- the object of the chosen picture; NULL: no pictures
    correct        INTEGER CHECK (correct IN (0, 1)),  -- 1: right; NULL: neither right nor wrong, or no picture of what was felt {0 = no; 1 = yes}
    reaction_s     REAL NOT NULL CHECK (reaction_s >= 0),  -- question shown -> the press that gave this answer
    reaction_uncertainty_s REAL NOT NULL CHECK (reaction_uncertainty_s >= 0),  -- reaction_s may be up to this much less
    input          TEXT NOT NULL                    -- how it was given
                       CHECK (input IN ('simulated', 'key', 'arrows', 'mouse')),
    confidence     INTEGER CHECK (confidence BETWEEN 1 AND 4),  -- how sure; NULL: not asked for
                       -- {1 = a guess; 2 = nearer to a guess; 3 = nearer to sure; 4 = sure}
    confidence_reaction_s REAL CHECK (confidence_reaction_s >= 0),  -- scale shown -> confidence
    early_presses  INTEGER NOT NULL DEFAULT 0 CHECK (early_presses >= 0),  -- within the guard time of question or scale: no answers
    first_choice_s REAL CHECK (first_choice_s <= reaction_s),  -- question shown -> first answer marked; NULL: none is to be confirmed
    confirmed_s    REAL CHECK (confirmed_s >= reaction_s),  -- question shown -> confirmed; NULL: none is to be confirmed
    changes        INTEGER CHECK (changes >= 0),    -- times that another answer was marked, each step of the arrows one
    confidence_first_choice_s REAL CHECK (confidence_first_choice_s <= confidence_reaction_s),  -- scale shown -> first level marked
    confidence_confirmed_s REAL CHECK (confidence_confirmed_s >= confidence_reaction_s),  -- scale shown -> confirmed
    confidence_changes INTEGER CHECK (confidence_changes >= 0)  -- times that another level was marked
) STRICT;

CREATE TABLE adaptive_step (
    -- Answers that a rule took in. Stimulus: presentation.stimulus of the trial.
    trial_id     INTEGER PRIMARY KEY REFERENCES trial,  -- [file] trial.trial_id
    rule_outcome INTEGER NOT NULL CHECK (rule_outcome >= 0),  -- as the rule took it; two intervals: 1 if the comparison was named
    staircase    TEXT CHECK (length(staircase) > 0),  -- which of several interleaved ones chose the stimulus; NULL: no such rule
    estimate     REAL,                              -- mean of the first estimate with this answer; NULL: none
    estimates    TEXT NOT NULL,                     -- all of them, as JSON: {"name": {"mean": x, "mode": x}, ...}
    state_sha256 TEXT NOT NULL CHECK (length(state_sha256) = 64)  -- of the rule's state with this answer
) STRICT;

CREATE TABLE event (
    -- What happened in a session beside its trials. Programs go by kind and numbers: the text is for people.
    event_id      INTEGER PRIMARY KEY,              -- [file] of this file alone, in the order in which they happened
    session_id    INTEGER NOT NULL REFERENCES session,  -- [file] session.session_id
    trial_id      INTEGER REFERENCES trial,         -- [file] trial.trial_id; NULL: of the session as a whole
    event_kind    TEXT NOT NULL CHECK (event_kind IN  -- what
                      ('break', 'pause', 'go on', 'abort', 'gave up', 'fault', 'reconnect', 'invalid', 'note',
                       'mark', 'redo', 'interrupted', 'timing', 'ticks lost', 'masking', 'display lost',
                       'device', 'operator', 'provenance', 'participant', 'planned again',
                       'stop', 'reveal')),
    text          TEXT NOT NULL,                    -- [details] a sentence; of a mark the reason
    at_utc        TEXT NOT NULL,                    -- [details] wall clock, ISO 8601
    at_ns         INTEGER,                          -- [details] on the servo's clock, as trial.started_ns
    operator      TEXT,                             -- [details] who noted it, as given; NULL: nobody said
    seal          TEXT CHECK (length(seal) = 64),   -- [file] hash over all results of the session with this event
    trials_begun  INTEGER NOT NULL CHECK (trials_begun >= 0),  -- attempts of the session by then
    plan_position INTEGER CHECK (plan_position >= 0),  -- what it is about, or what comes next
    part          INTEGER CHECK (part >= 0),        -- redo: 0 practice, else 1 + plan.block
    count         INTEGER CHECK (count >= 0),       -- ticks lost; redo: answers; gave up, reconnect: tries in vain
    duration_s    REAL CHECK (duration_s >= 0),     -- go on, rig check: of the pause or the trouble, since the last check in it; masking: without noise
    key           TEXT,                             -- [details] provenance, participant: what; mark: undone, it takes the one before back; that of no trial is of the session
    noted_utc     TEXT,                             -- [details] participant: when it was noted, after all before it whatever the clock says
    value         TEXT                              -- [details] of key; fault, go on: the cause; reconnect: anew, or nothing; stop: by what; reveal: who asked; device, operator: the new one; participant, is really: whose the session is
) STRICT;

CREATE TABLE trace_chunk (
    -- Servo ticks of one interval of a trial. While the trial runs its last chunk is replaced by a longer one.
    -- codec 1, up to 2048 ticks: data are the sizes of the columns' streams (u32le each), then the streams,
    -- columns in the order of trace_column without the parts that the chunk does not hold. Size 0: all 0. A
    -- stream is blocks of 32 numbers: a byte, how many bits each has, then these, lowest first, up to a whole
    -- byte; of an exact column a zlib stream of its values: all first bytes, all second bytes, ...
    trial_id   INTEGER NOT NULL REFERENCES trial,   -- trial.trial_id
    interval   INTEGER NOT NULL CHECK (interval BETWEEN 1 AND 2),  -- of a trial with two things to feel
    first_tick INTEGER NOT NULL CHECK (first_tick >= 0),  -- number of its first tick
    ticks      INTEGER NOT NULL CHECK (ticks BETWEEN 1 AND 2048),  -- how many it has
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
    -- nothing; line twice the value before, less the one before that (before the first: 0); after one more than
    -- the value before (before the first: first_tick - 1); clock tick * period_ns, then the value before; exact
    -- nothing; flip: it is XOR the value before (before the first: 0). In two's complement of the type. What line,
    -- after and clock leave is folded: 0, -1, 1, -2 are 0, 1, 2, 3. part: only chunks that hold it have the column;
    -- in others it follows by replay from the scene. *_xor_*: bits of the commanded force XOR bits of the rendered
    -- one. mode: 0 free, 1 stuck, 2 slip, 3 transition. -2147483648 in a column of 100 nm or 100 uN: not a
    -- number; 2147483647: that much or more.
    codec           INTEGER NOT NULL,               -- trace_chunk.codec
    column_position INTEGER NOT NULL,               -- from 0, in the order of the bytes
    name            TEXT NOT NULL,                  -- of the column
    type            TEXT NOT NULL                   -- of a number as written, little-endian
                        CHECK (type IN ('f64le', 'f32le', 'i64le', 'u64le', 'i32le', 'i16le', 'u8')),
    unit            TEXT NOT NULL,                  -- of number * scale
    scale           REAL NOT NULL,                  -- in the unit
    rule            TEXT NOT NULL                   -- what was taken from a number before it was written
                        CHECK (rule IN ('plain', 'flip', 'after', 'clock', 'line', 'exact')),
    part            TEXT NOT NULL                   -- '': in every chunk, else in those that hold the part
                        CHECK (part IN ('', 'hip', 'contact', 'command', 'lateness')),
    PRIMARY KEY (codec, column_position)
) STRICT;

#include "data/store/presentation.hpp"

#include <optional>
#include <string_view>

#include "protocols/design/object_outline.hpp"

namespace palpate::data {

const char* const kPresentation = R"sql(
CREATE TABLE presentation (
    -- What each interval of a trial let one feel, and how it was felt, from its first tick to done. Trials
    -- with two intervals are comparisons; the numbers of the trial are those of both together.
    trial_id               INTEGER NOT NULL REFERENCES trial,  -- trial.trial_id
    interval            INTEGER NOT NULL CHECK (interval IN (1, 2)),  -- of the trial
    stimulus            REAL,                       -- what the rule chose, as it counts; NULL: not chosen by a rule
    felt_object         TEXT NOT NULL,              -- its name in the protocol
    curvature_per_m     REAL,                       -- as felt; NULL: no two-curve object
    friction            TEXT NOT NULL,              -- its name in the protocol
    mu_s                REAL NOT NULL CHECK (mu_s >= mu_d),  -- as felt
    mu_d                REAL NOT NULL CHECK (mu_d >= 0),     -- as felt
    slip_decay          REAL NOT NULL,              -- exp(-T/tau_slip) as computed on this machine
    heal_decay          REAL NOT NULL,              -- exp(-T/tau_heal)
    done_s              REAL,                       -- first tick -> done; NULL, as all below: it was cut off
    done_uncertainty_s  REAL,                       -- done may have been up to this much earlier
    first_contact_s     REAL,                       -- first tick -> first contact; NULL: none
    ticks               INTEGER CHECK (ticks >= 0), -- up to done
    contact_ticks       INTEGER,                    -- of these in contact
    slip_ticks          INTEGER,                    -- slip or transition
    late_ticks          INTEGER,                    -- woke late
    saturated_ticks     INTEGER,                    -- the device could not give the force
    path_length_m       REAL,                       -- of HIP
    mean_normal_force_n REAL,                       -- over contact, 0 without
    max_normal_force_n  REAL,                       -- largest
    PRIMARY KEY (trial_id, interval)
) STRICT;
)sql";

const char* const kResponse = R"sql(
CREATE TABLE response (
    -- The answer of a trial.
    trial_id       INTEGER PRIMARY KEY REFERENCES trial,    -- trial.trial_id
    chosen_place   INTEGER CHECK (chosen_place >= 0),      -- of the chosen picture: picture.picture_place; NULL: no pictures
    chosen_object  TEXT,                            -- of the chosen picture; NULL: no pictures
    correct        INTEGER CHECK (correct IN (0, 1)),       -- NULL: the answer is neither right nor wrong
    reaction_s     REAL NOT NULL CHECK (reaction_s >= 0),   -- question shown -> the press that gave this answer
    reaction_uncertainty_s REAL NOT NULL CHECK (reaction_uncertainty_s >= 0),  -- may have been up to this much earlier
    input          TEXT NOT NULL            -- how it was given
                       CHECK (input IN ('simulated', 'key', 'arrows', 'mouse')),
    answer_code    INTEGER NOT NULL CHECK (answer_code >= 0),    -- picture from the left; interval - 1; 0 no, 1 yes; level
    confidence     INTEGER CHECK (confidence BETWEEN 1 AND 4),        -- 1 a guess, 4 sure; NULL: not asked for
    confidence_reaction_s REAL CHECK (confidence_reaction_s >= 0),    -- scale shown -> confidence
    early_presses  INTEGER NOT NULL DEFAULT 0 CHECK (early_presses >= 0),  -- within the guard time of question or scale: no answers
    first_choice_s REAL CHECK (first_choice_s <= reaction_s),    -- question shown -> first answer marked; NULL, as all
    confirmed_s    REAL CHECK (confirmed_s >= reaction_s),       -- -> confirmed. below: the protocol asks for none
    changes        INTEGER CHECK (changes >= 0),    -- times that another answer was marked, each step of the arrows one
    confidence_first_choice_s REAL CHECK (confidence_first_choice_s <= confidence_reaction_s),  -- the same of the scale
    confidence_confirmed_s REAL CHECK (confidence_confirmed_s >= confidence_reaction_s),  -- scale shown -> confirmed
    confidence_changes INTEGER CHECK (confidence_changes >= 0)  -- times that another level was marked
) STRICT;
)sql";

void write_presentation(Database& database,
                        std::int64_t trial,
                        const protocols::Presentation& felt,
                        const protocols::SceneConstants& scene) {
    database
        .prepare(
            "INSERT INTO presentation (trial_id, interval, stimulus, felt_object, curvature_per_m, "
            "friction, mu_s, mu_d, slip_decay, heal_decay) VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, "
            "?9, ?10)")
        .bind(1, trial)
        .bind(2, static_cast<std::int64_t>(felt.interval))
        .bind(3, felt.stimulus)
        .bind(4, felt.object.name)
        .bind(5, protocols::curvature_of(felt.object))
        .bind(6, felt.friction.name)
        .bind(7, felt.friction.mu_s)
        .bind(8, felt.friction.mu_d)
        .bind(9, scene.slip_decay)
        .bind(10, scene.heal_decay)
        .run();
}

void write_interval_result(Database& database,
                           std::int64_t trial,
                           std::int64_t interval,
                           const protocols::IntervalResult& result) {
    const protocols::TrialSummary& sum = result.summary;
    database
        .prepare(
            "UPDATE presentation SET done_s = ?3, done_uncertainty_s = ?4, first_contact_s = ?5, "
            "ticks = ?6, contact_ticks = ?7, slip_ticks = ?8, late_ticks = ?9, saturated_ticks = "
            "?10, path_length_m = ?11, mean_normal_force_n = ?12, max_normal_force_n = ?13 WHERE "
            "trial_id = ?1 AND interval = ?2")
        .bind(1, trial)
        .bind(2, interval)
        .bind(3, result.done_s)
        .bind(4, result.done_uncertainty_s)
        .bind(5, sum.first_contact_s)
        .bind(6, sum.ticks)
        .bind(7, sum.contact_ticks)
        .bind(8, sum.slip_ticks)
        .bind(9, sum.late_ticks)
        .bind(10, sum.saturated_ticks)
        .bind(11, sum.path_length_m)
        .bind(12, sum.mean_normal_force_n)
        .bind(13, sum.max_normal_force_n)
        .run();
}

void bind_confirmation(Statement& row,
                       int parameter,
                       const std::optional<protocols::Confirmation>& confirmation) {
    if (!confirmation) {
        return;  // what is not bound is NULL
    }
    row.bind(parameter, confirmation->first_choice_s)
        .bind(parameter + 1, confirmation->confirmed_s)
        .bind(parameter + 2, static_cast<std::int64_t>(confirmation->changes));
}

void write_response(Database& database,
                    std::int64_t trial,
                    const protocols::Protocol& protocol,
                    const protocols::Response& response) {
    const auto integer = [](auto value) {
        return value ? std::optional(static_cast<std::int64_t>(*value)) : std::nullopt;
    };
    const std::optional<std::string_view> object =
        response.object
            ? std::optional<std::string_view>(protocol.objects.at(*response.object).name)
            : std::nullopt;
    Statement row = database.prepare(
        "INSERT INTO response VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14,"
        " ?15, ?16, ?17)");
    bind_confirmation(row, 12, response.confirmation);
    bind_confirmation(row, 15, response.confidence_confirmation);
    row.bind(1, trial)
        .bind(2, response.object ? std::optional(static_cast<std::int64_t>(response.place))
                                 : std::nullopt)
        .bind(3, object)
        .bind(4, integer(response.correct))
        .bind(5, response.reaction_s)
        .bind(6, response.uncertainty_s)
        .bind(7, to_string(response.input))
        .bind(8, static_cast<std::int64_t>(response.place))
        .bind(9, integer(response.confidence))
        .bind(10,
              response.confidence ? std::optional(response.confidence_reaction_s) : std::nullopt)
        .bind(11, static_cast<std::int64_t>(response.early_presses))
        .run();
}

}  // namespace palpate::data

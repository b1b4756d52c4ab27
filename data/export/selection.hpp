#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "data/store/database.hpp"

namespace palpate::data {

/// What is exported, and how much is said of people.
struct ExportOptions {
    std::string kind = "real";  ///< real, pilot, simulated or all
    /// Operator, wall clock, days, notes, handedness score, participant_detail, provenance.
    bool details = false;
    bool traces = false;      ///< every servo tick as well
    bool keep_codes = false;  ///< a table subject -> the code of the lab
};

/// Sessions of a study and kind with nothing that a format could hold.
struct NotTaken {
    std::string study;
    std::string kind;
    std::int64_t sessions = 0;
};

/// One session that is exported.
struct ChosenSession {
    std::int64_t id = 0;
    std::string subject;  ///< sub-0123456789, for ever
    std::string label;    ///< of the study: letters and digits, no two studies the same
    std::string study;    ///< its name
    std::string title;
    std::string kind;         ///< real, pilot or simulated
    std::int64_t number = 0;  ///< of the participant's chosen sessions of the study
    double rate_hz = 0.0;
};

/// The sessions asked for, in the temporary tables `chosen (session, subject, label, day, number)`
/// and `numbered (trial, number, zero_ns)` and `happened (event, since_ns)` of this connection; one
/// moment of the file.
///
/// A participant is called by the number that was drawn for them when they were registered, and
/// keeps it in every export; rows come in the order of these numbers. Who noted that a participant
/// does not consent (consent 0) has them left out. Orders follow from the file's secret
/// (data/store/secret.hpp): who knows protocol, seed and a list of codes cannot say whose they are.
/// Two exports of a file that grew do say who joined in between.
class Selection {
public:
    /// @throws std::invalid_argument if there is no such session
    Selection(Database& database, const ExportOptions& options);
    [[nodiscard]] const std::vector<ChosenSession>& sessions() const { return sessions_; }
    /// The studies' titles, each once: "One; Another".
    [[nodiscard]] std::string titles() const;
    /// Chooses among the sessions those that `held`, a query, names by session_id.
    /// @return the studies of which no session is left
    std::vector<NotTaken> keep(std::string_view held);

private:
    void choose(const std::string& kind);
    void name_subjects();

    Database& database_;
    Snapshot now_;
    std::vector<ChosenSession> sessions_;
};

/// What every format is given: whose tables, how much of them, and a folder, there and empty.
struct Exporting {
    Database& database;
    const Selection& selection;
    const ExportOptions& options;
    std::filesystem::path folder;
};

// Every form of an export but the plain tables. Each writes into a folder that is there and empty.

/// A BIDS dataset (bids-specification.readthedocs.io, 1.9.0: the first with Motion-BIDS).
/// tests/data/export_clients_test.cpp runs bids-validator over it where one is installed.
///
/// - beh (behavioral experiments, no neural recordings): a _beh.tsv a session and study with one
///   row an attempt, its .json says what the columns are. Covered by the standard; the columns are
///   ours.
/// - motion, with traces: HIP as POS channels of the tracked point "handle", LATENCY from the
///   servo's clock, all else of a tick as MISC with units; one _motion.tsv, _channels.tsv and .json
///   a run, a run is an attempt. Covered; that forces of rendering are MISC is our choice, there is
///   no channel type for them.
/// - stim, with traces: the commanded force as _recording-force_stim.tsv.gz in beh/, with the run
///   of the motion. What a force is the standard does not say. Later versions give stim a place in
///   motion/ too, which validators of 1.9 refuse.
/// - A tick that was lost is a row of n/a, in motion and stim alike, so that row k is tick k.
/// - Wall clock is left out, so there is no scans.tsv. Pictures and plan have no place in the
///   standard: they are in the rows of _beh.tsv as far as they were presented.
/// - With traces of two intervals of a trial, the run is "0012" for the first and its acq is
///   "interval2" for the second.
void export_bids(const Exporting& to);

/// A Psych-DS dataset (psych-ds.github.io; the schema of psychds-validator 1.4):
/// dataset_description.json (schema.org's Dataset as JSON-LD, all columns as variableMeasured),
/// data/description-participants_data.csv and data/study-X_subject-NNN_session-N_data.csv, one row
/// an attempt; with traces also
/// data/study-X_subject-NNN_session-N_trial-NNNN_description-ticks_data.csv, uncompressed, since
/// the standard has CSV only.
void export_psych_ds(const Exporting& to);

// ------------------------------------------------ answers as other programs of the field take them
// With a README.txt that says how. Kinds of sessions stay apart, each by its word in a column.

/// quickpsy.csv for the package of R (D. Linares, J. Lopez-Moliner, R Journal 8:122, 2016):
/// participant, study, kind, condition, x, k, n; k of n answers at x were yes, or the comparison.
/// Main trials that count.
/// @throws std::invalid_argument if there is no answer on a graded stimulus
void export_quickpsy(const Exporting& to);

/// The same counts for psignifit 4: a file without head for each participant and condition, lines
/// of x,k,n, and index.csv: which file is whose. @throws as export_quickpsy
void export_psignifit(const Exporting& to);

/// A file a session with the columns of PsychoPy's wide CSV: a row an answer in the order given,
/// practice and answers that do not count too (column counts). trials.thisN counts the rows from 0,
/// trials.thisIndex is the place in the plan, trials.thisRepN says how often that place was tried
/// before, key_resp.keys what was answered, key_resp.rt in s. No PsychoPy has read them here.
void export_psychopy(const Exporting& to);

}  // namespace palpate::data

#pragma once

#include <filesystem>

#include "data/export/delimited_file.hpp"
#include "data/export/selection.hpp"
#include "data/export/tables.hpp"

namespace palpate::data {

/// One file a table (participants, sessions, plan, pictures, trials, responses, events; with
/// details also participant_details and provenance), columns.csv with type, unit and meaning of
/// every column, README.txt; with codes codes.csv; with traces
/// ticks/SUBJECT_STUDY_ses-NN_trial-NNNN.csv.gz.
void export_csv(const Exporting& to);

/// A table of the export as CSV with a head line: of all sessions, or of one.
void write_table(Database& database,
                 const ExportTable& table,
                 const ExportOptions& options,
                 const std::filesystem::path& file);
void write_session_table(Database& database,
                         const ExportTable& table,
                         const ExportOptions& options,
                         const ChosenSession& session,
                         const std::filesystem::path& file);

/// All ticks of a trial, lost ones left out. @param number  of the trial in its session
void write_ticks(Database& database,
                 std::int64_t trial,
                 std::int64_t number,
                 const ChosenSession& session,
                 const std::filesystem::path& file);

/// Which code of the lab each subject is.
void write_codes(Database& database, const std::filesystem::path& file);

/// Name of the ticks' files of a trial, without an ending:
/// "sub-001_shapefriction_ses-01_trial-0001".
[[nodiscard]] std::string trial_name(const ChosenSession& session, std::int64_t trial);

/// For every trial of the session with ticks: its id and its number. @param visit  (id, number)
template <class Visit>
void each_traced_trial(Database& database, const ChosenSession& session, const Visit& visit) {
    Statement row = database.prepare(
        "SELECT trial.trial_id, trial_number FROM trial JOIN numbered USING (trial_id) WHERE "
        "trial.session_id = ?1 AND EXISTS (SELECT 1 FROM trace_chunk WHERE trace_chunk.trial_id = "
        "trial.trial_id) ORDER BY trial.trial_id",
        session.id);
    while (row.step()) {
        visit(row.integer(0), row.integer(1));
    }
}

}  // namespace palpate::data

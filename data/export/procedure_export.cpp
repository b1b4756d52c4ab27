#include "data/export/procedure_export.hpp"

#include <stdexcept>

#include <fmt/format.h>

#include "engine/base/files.hpp"
#include "data/store/adaptive_export.hpp"

namespace palpate::data {

void export_procedures(Database& database,
                       const Selection& selection,
                       const std::filesystem::path& folder) {
    int runs = 0;
    Statement row = database.prepare(
        "SELECT DISTINCT run_number FROM adaptive_plan WHERE session_id = ?1 ORDER BY run_number");
    for (const ChosenSession& session : selection.sessions()) {
        row.bind(1, session.id);
        for (; row.step(); ++runs) {
            const ExportedRun made = exported_run(database, session.id, row.integer(0));
            const std::filesystem::path place =
                folder / fmt::format("study-{}_subject-{}_session-{}_run-{}", session.label,
                                     session.subject.substr(4), session.number, row.integer(0));
            std::filesystem::create_directory(place);
            write_whole(place / "CONFIG.toml", made.procedure);
            write_whole(place / "RESPONSES.csv", made.responses);
        }
        row.reset();
    }
    if (runs == 0) {
        throw std::invalid_argument(
            "no session of the file has a rule that chooses stimuli: take another format");
    }
}

}  // namespace palpate::data

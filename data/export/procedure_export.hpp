#pragma once

#include <filesystem>

#include "data/export/selection.hpp"

namespace palpate::data {

/// Every run of a rule as `palpate procedure` reads it, in a folder of its own
/// study-LABEL_subject-NNN_session-N_run-R (R from 0): CONFIG.toml, the rule and the stream of its random numbers;
/// RESPONSES.csv, what was shown and answered. `palpate procedure CONFIG.toml RESPONSES.csv --hashes` then
/// prints the estimates and states that are stored. Answers that were marked are left out.
/// @throws std::invalid_argument without keep_codes, since the stream follows from the participant's code and
///         the file has to name it; and if no session has a rule
void export_procedures(Database& database,
                       const Selection& selection,
                       const ExportOptions& options,
                       const std::filesystem::path& folder);

}  // namespace palpate::data

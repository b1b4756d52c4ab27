#pragma once

#include <filesystem>

#include "data/export/selection.hpp"

namespace palpate::data {

/// Every run of a rule as `palpate procedure` reads it, in a folder of its own
/// study-LABEL_subject-NNN_session-N_run-R (R from 0): CONFIG.toml, the rule and where its random
/// numbers begin: these follow from the file's secret, and lead back neither to it nor to the
/// participant; RESPONSES.csv, what was shown and answered. `palpate procedure CONFIG.toml
/// RESPONSES.csv --hashes` then prints the estimates and states that are stored. Answers that were
/// marked are left out.
/// @throws std::invalid_argument if no session has a rule
void export_procedures(Database& database,
                       const Selection& selection,
                       const std::filesystem::path& folder);

}  // namespace palpate::data

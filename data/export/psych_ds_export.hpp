#pragma once

#include <filesystem>

#include "data/export/selection.hpp"

namespace palpate::data {

/// A Psych-DS dataset (psych-ds.github.io; the schema of psychds-validator 1.4):
/// dataset_description.json (schema.org's Dataset as JSON-LD, all columns as variableMeasured),
/// data/description-participants_data.csv and data/study-X_subject-NNN_session-N_data.csv, one row
/// an attempt; with traces also
/// data/study-X_subject-NNN_session-N_trial-NNNN_description-ticks_data.csv, uncompressed, since
/// the standard has CSV only.
void export_psych_ds(Database& database,
                     const Selection& selection,
                     const ExportOptions& options,
                     const std::filesystem::path& folder);

}  // namespace palpate::data

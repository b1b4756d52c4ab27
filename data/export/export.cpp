#include "data/export/export.hpp"

#include <stdexcept>

#include <fmt/format.h>

#include "data/export/bids_export.hpp"
#include "data/export/csv_export.hpp"
#include "data/export/new_folder.hpp"
#include "data/export/parquet_export.hpp"
#include "data/export/procedure_export.hpp"
#include "data/export/psych_ds_export.hpp"

namespace palpate::data {

ExportFormat parse_export_format(std::string_view word) {
    if (word == "csv") {
        return ExportFormat::csv;
    }
    if (word == "bids") {
        return ExportFormat::bids;
    }
    if (word == "psych-ds") {
        return ExportFormat::psych_ds;
    }
    if (word == "parquet") {
        return ExportFormat::parquet;
    }
    if (word == "procedure") {
        return ExportFormat::procedure;
    }
    throw std::invalid_argument(
        fmt::format("\"{}\" is no format: give csv, bids, psych-ds, parquet or procedure", word));
}

Exported export_file(const std::string& file,
                     ExportFormat format,
                     const ExportOptions& options,
                     const std::filesystem::path& folder) {
    Database database(file, Access::read);
    NewFolder built(folder);
    const Selection selection(database, options);
    switch (format) {
        case ExportFormat::csv:
            export_csv(database, selection, options, built.path());
            break;
        case ExportFormat::bids:
            export_bids(database, selection, options, built.path());
            break;
        case ExportFormat::psych_ds:
            export_psych_ds(database, selection, options, built.path());
            break;
        case ExportFormat::parquet:
            export_parquet(database, selection, options, built.path());
            break;
        case ExportFormat::procedure:
            export_procedures(database, selection, built.path());
            break;
    }
    built.keep(options.details || options.keep_codes);
    return {selection.sessions().size(), selection.without_consent()};
}

}  // namespace palpate::data

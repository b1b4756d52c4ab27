#include "data/export/export.hpp"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "data/export/bids_export.hpp"
#include "data/export/csv_export.hpp"
#include "data/export/new_folder.hpp"
#include "data/export/parquet_export.hpp"
#include "data/export/peer_export.hpp"
#include "data/export/procedure_export.hpp"
#include "data/export/psych_ds_export.hpp"

namespace palpate::data {

ExportFormat parse_export_format(std::string_view word) {
    const auto found = std::ranges::find(kExportWords, word);
    if (found == kExportWords.end()) {
        throw std::invalid_argument(fmt::format("\"{}\" is no format: give one of {}", word,
                                                fmt::join(kExportWords, ", ")));
    }
    return static_cast<ExportFormat>(found - kExportWords.begin());
}

Exported export_file(const std::string& file,
                     ExportFormat format,
                     const ExportOptions& options,
                     const std::filesystem::path& folder) {
    if (format >= ExportFormat::procedure &&
        (options.details || options.traces || options.keep_codes)) {
        throw std::invalid_argument(fmt::format(
            "{} holds no more than answers: details, codes and ticks go with csv, bids, "
            "psych-ds and parquet",
            kExportWords.at(static_cast<std::size_t>(format))));
    }
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
        case ExportFormat::quickpsy:
            export_quickpsy(database, selection, built.path());
            break;
        case ExportFormat::psignifit:
            export_psignifit(database, selection, built.path());
            break;
        case ExportFormat::psychopy:
            export_psychopy(database, selection, built.path());
            break;
    }
    built.keep(options.details || options.keep_codes);
    return {selection.sessions().size(), selection.without_consent()};
}

}  // namespace palpate::data

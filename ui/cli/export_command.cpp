#include <fmt/format.h>

#include "data/export/export.hpp"
#include "ui/cli/commands.hpp"

namespace palpate::ui {

int export_command(const ExportCommandOptions& options) {
    const data::Exported done =
        data::export_file(options.database, data::parse_export_format(options.format),
                          {.kind = options.kind,
                           .details = options.details,
                           .traces = options.traces,
                           .keep_codes = options.keep_codes},
                          options.directory);
    fmt::print("{}: {} session{} as {}{}.\n", options.directory, done.sessions,
               done.sessions == 1 ? "" : "s", options.format,
               options.details      ? ", with details"
               : options.keep_codes ? ", with the participants' codes"
                                    : ", de-identified");
    if (done.without_consent > 0) {
        fmt::print("{} participant{} left out: no consent.\n", done.without_consent,
                   done.without_consent == 1 ? "" : "s");
    }
    return 0;
}

}  // namespace palpate::ui

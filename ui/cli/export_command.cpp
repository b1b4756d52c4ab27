#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "data/export/export.hpp"
#include "ui/cli/commands.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {

int export_command(const ExportCommandOptions& options) {
    const data::Exported done =
        data::export_file(options.database, data::parse_export_format(options.format),
                          {.kind = options.kind,
                           .details = options.details,
                           .traces = options.traces,
                           .keep_codes = options.keep_codes},
                          options.directory);
    say("{}: {} as {}{}.\n", options.directory, counted(done.sessions, "session"), options.format,
        options.details      ? ", with details"
        : options.keep_codes ? ", with the participants' codes"
                             : ", de-identified");
    if (done.without_consent > 0) {
        say("{} left out: no consent.\n", counted(done.without_consent, "participant"));
    }
    return 0;
}

}  // namespace palpate::ui

#include <fmt/format.h>

#include "data/analysis/summary.hpp"
#include "ui/cli/commands.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {

int summary_command(const SummaryOptions& options) {
    data::Database database(options.database, data::Access::read);
    say("{}", data::summary_text(database));
    return 0;
}

}  // namespace palpate::ui

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "data/sync/merge.hpp"
#include "ui/cli/commands.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {

int merge_command(const MergeOptions& options) {
    const data::MergeReport done = data::merge_files(options.database, options.inputs);
    say("{}: {} new, {} went on, {} as before.\n", options.database, counted(done.added, "session"),
        done.extended, done.same);
    for (const data::MergeConflict& conflict : done.conflicts) {
        say_to(stderr,
               fmt::format("conflict: {}\n  in {}\n", plain(conflict.what), conflict.first));
        if (!conflict.second.empty()) {
            say_to(stderr, fmt::format("  in {}\n", conflict.second));
        }
        say_to(stderr, "  not merged\n");
    }
    return done.conflicts.empty() ? 0 : kExitFailure;
}

}  // namespace palpate::ui

#include <fmt/format.h>

#include "protocols/design/counted.hpp"
#include "data/sync/merge.hpp"
#include "ui/cli/commands.hpp"

namespace palpate::ui {

int merge_command(const MergeOptions& options) {
    const data::MergeReport done = data::merge_files(options.database, options.inputs);
    fmt::print("{}: {} new, {} went on, {} as before.\n", options.database,
               protocols::counted(done.added, "session"), done.extended, done.same);
    for (const data::MergeConflict& conflict : done.conflicts) {
        fmt::print(stderr, "conflict: {}\n  in {}\n", conflict.what, conflict.first);
        if (!conflict.second.empty()) {
            fmt::print(stderr, "  in {}\n", conflict.second);
        }
        fmt::print(stderr, "  not merged\n");
    }
    return done.conflicts.empty() ? 0 : kExitFailure;
}

}  // namespace palpate::ui

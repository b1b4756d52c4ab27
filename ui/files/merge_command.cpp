#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "data/sync/merge.hpp"
#include "ui/command/command.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {
namespace {

struct MergeOptions {
    std::string database;             ///< made if it is not there
    std::vector<std::string> inputs;  ///< read only
};

void declare(CommandWords& words, MergeOptions& options) {
    words.add("OUT", options.database, "The file of all; made if it is not there").required();
    words.add("IN", options.inputs, "Files of rigs; only read").required();
}

int run(const MergeOptions& options) {
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

}  // namespace

Command merge_command() {
    return make_command<MergeOptions>(
        "merge", "Bring the sessions of several files together in one", declare, run);
}

}  // namespace palpate::ui

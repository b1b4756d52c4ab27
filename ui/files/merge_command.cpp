#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "data/sync/merge.hpp"
#include "ui/command/command.hpp"
#include "ui/rig/say.hpp"
#include "ui/session/simulation.hpp"

namespace palpate::ui {
namespace {

struct MergeOptions {
    std::string database;             ///< made if it is not there
    std::vector<std::string> inputs;  ///< read only
    std::int64_t expect = 0;          ///< shards of a simulation; 0: any files
    std::string prefer;               ///< of the files; empty: none
};

void declare(CommandWords& words, MergeOptions& options) {
    words.add("OUT", options.database, "The file of all; made if it is not there").required();
    words.add("IN", options.inputs, "Files of rigs; only read").required();
    words
        .add("--expect", options.expect,
             "The files are all so many shards of palpate simulate, by their names; where one is "
             "missing nothing is merged")
        .within(1, 100'000);
    words.add("--prefer", options.prefer,
              "FILE, one of them: it is right where two files say different things of a session, "
              "or of a participant at one time");
}

/// @throws std::invalid_argument with the numbers of those that are not there, as sbatch takes them
void expect_shards(const std::vector<std::string>& files, std::size_t shards) {
    std::vector<std::size_t> missing;
    for (std::size_t i = 0; i < shards; ++i) {
        const std::string name = shard_name({.number = i, .of = shards});
        const auto found = [&](const std::string& file) {
            return std::filesystem::path(file).filename() == name;
        };
        if (std::ranges::none_of(files, found)) {
            missing.push_back(i);
        }
    }
    if (!missing.empty()) {
        throw std::invalid_argument(
            fmt::format("{} of {} missing, and nothing was merged: simulate {} first, with Slurm "
                        "by sbatch --array={}",
                        missing.size() == 1 ? "one shard" : counted(missing.size(), "shard"),
                        shards, missing.size() == 1 ? "it" : "them", fmt::join(missing, ",")));
    }
}

int run(const MergeOptions& options) {
    if (options.expect > 0) {
        expect_shards(options.inputs, static_cast<std::size_t>(options.expect));
    }
    if (!options.prefer.empty() && options.prefer != options.database &&
        std::ranges::find(options.inputs, options.prefer) == options.inputs.end()) {
        throw std::invalid_argument(fmt::format(
            "--prefer {}: it is none of the files that are brought together", options.prefer));
    }
    const data::MergeReport done =
        data::merge_files(options.database, options.inputs, options.prefer);
    say("{}: {} new, {} went on, {} as before.\n", options.database, counted(done.added, "session"),
        done.extended, done.same);
    for (const std::string& notice : done.notices) {
        say("{}\n", plain(notice));
    }
    for (const data::MergeConflict& conflict : done.conflicts) {
        say_to(stderr,
               fmt::format("conflict: {}\n  in {}\n", plain(conflict.what), conflict.first));
        if (!conflict.second.empty()) {
            say_to(stderr, fmt::format("  in {}\n", conflict.second));
        }
        say_to(stderr, fmt::format("  not merged; {}\n", conflict.remedy));
    }
    return done.conflicts.empty() ? 0 : kExitFailure;
}

}  // namespace

Command merge_command() {
    return make_command<MergeOptions>(
        "merge", "Bring the sessions of several files together in one", declare, run);
}

}  // namespace palpate::ui

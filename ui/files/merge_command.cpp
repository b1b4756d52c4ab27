#include <algorithm>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "data/store/session_lock.hpp"
#include "data/store/session_store.hpp"
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
             "The files are all so many shards of one palpate simulate, by their names and by what "
             "they hold; where one is missing or of another nothing is merged")
        .within(1, 100'000);
    words.add("--prefer", options.prefer,
              "FILE, one of them: it is right where two files say different things of a session, "
              "or of a participant at one time");
}

/// What was destroyed on request has neither provenance nor end.
constexpr const char* kShard =
    "SELECT participant_code, session_kind, session_number, protocol_sha256, seed, secret, "
    "max(iif(key = 'build id', value, '')), max(iif(key = ?1, value, '')), max(iif(key = ?2, "
    "value, '')), finished, withdrawn_reason IS NOT NULL AND max(session_provenance.key) IS NULL "
    "FROM session JOIN study USING (study_id) JOIN participant USING (participant_id) LEFT JOIN "
    "session_provenance USING (session_id) GROUP BY session.session_id";
constexpr const char* kAlike[] = {
    "kind of sessions", "number of sessions",    "protocol", "seed", "secret", "build of palpate",
    "observer",         "choice of --no-traces", "end"};
constexpr int kOfSessions = 5;  ///< of them those that a destroyed one still has

/// What the files of one simulation hold.
class Shards {
public:
    explicit Shards(std::size_t of) : found_(of) {}

    /// @throws std::invalid_argument if it is not that shard of the same simulation
    void read(const std::string& file, std::size_t number) {
        data::Database database(file, data::Access::read);
        for (const data::Statement& row :
             database.prepare(kShard, data::kObserverKey, data::kTracesKey)) {
            const std::string code = row.text(0);
            const auto digits =
                std::string_view(code).substr(std::min<std::size_t>(1, code.size()));
            const std::size_t index = parsed<std::size_t>(digits).value_or(0) - 1;
            if (simulated_code(index) != code || index % found_.size() != number) {
                refuse(fmt::format("{}: {} is none of shard {}/{}", file, code, number,
                                   found_.size()));
            }
            const int last = row.columns() - 1;
            const int known = row.integer(last) != 0 ? kOfSessions : last - 1;
            for (int i = 0; i < known; ++i) {
                const auto [there, is_new] = alike_.emplace(kAlike[i], row.text(i + 1));
                if (!is_new && there->second != row.text(i + 1)) {
                    refuse(fmt::format("{}: {} has another {} than the shards before", file, code,
                                       kAlike[i]));
                }
            }
            ++found_[number];
            people_ = std::max(people_, index + 1);
        }
    }

    /// @throws std::invalid_argument if somebody is missing, by the last one's code
    void require_all() const {
        for (std::size_t i = 0; i < found_.size(); ++i) {
            const Shard shard{.number = i, .of = found_.size()};
            if (const std::size_t all = participants_of(shard, people_); found_[i] != all) {
                refuse(fmt::format("{}: it holds {}, and where {} is in another there are {}",
                                   shard_name(shard), counted(found_[i], "participant"),
                                   simulated_code(people_ - 1), all));
            }
        }
    }

private:
    [[noreturn]] static void refuse(const std::string& what) {
        throw std::invalid_argument(
            what + ": nothing was merged; simulate all shards with the same words");
    }

    std::vector<std::size_t> found_;            ///< participants in each
    std::map<std::string, std::string> alike_;  ///< kAlike, of the first that has it
    std::size_t people_ = 0;                    ///< in all shards, by the greatest code
};

/// @throws std::invalid_argument for one that is by its name of another number of shards
void require_of(std::size_t shards, const std::string& file) {
    const std::string name = std::filesystem::path(file).stem().string();
    const std::size_t of = name.find("-of-");
    const auto there = of != std::string::npos && name.starts_with("shard-")
                         ? parsed<std::size_t>(std::string_view(name).substr(of + 4))
                         : std::nullopt;
    refuse_if(
        there.value_or(shards) != shards,
        "{}: it is one of {} shards, not of {}: nothing was merged; --expect takes the number "
        "of all",
        file, there.value_or(0), shards);
}

/// @throws std::invalid_argument with the numbers of those that are not there, as sbatch takes
/// them, or if they are not of one simulation
void expect_shards(const std::vector<std::string>& files, std::size_t shards) {
    for (const std::string& file : files) {
        require_of(shards, file);
    }
    std::vector<std::size_t> missing;
    std::vector<std::string> names;
    for (std::size_t i = 0; i < shards; ++i) {
        const std::string name = shard_name({.number = i, .of = shards});
        const auto file = std::ranges::find_if(files, [&](const std::string& one) {
            return std::filesystem::path(one).filename() == name;
        });
        if (file == files.end()) {
            missing.push_back(i);
        } else {
            names.push_back(*file);
        }
    }
    refuse_if(!missing.empty(),
              "{} of {} missing, and nothing was merged: simulate {} first, with Slurm by sbatch "
              "--array={}",
              missing.size() == 1 ? "one shard" : counted(missing.size(), "shard"), shards,
              missing.size() == 1 ? "it" : "them", fmt::join(missing, ","));
    refuse_if(files.size() != shards, "--expect {}: {} were given: nothing was merged", shards,
              counted(files.size(), "file"));
    Shards all(shards);
    for (std::size_t i = 0; i < shards; ++i) {
        all.read(names[i], i);
    }
    all.require_all();
}

/// Which of the files --prefer means, as that is called there.
std::string preferred(const MergeOptions& options) {
    if (options.prefer.empty()) {
        return "";
    }
    std::vector<std::string> files = options.inputs;
    files.push_back(options.database);
    const auto file = std::ranges::find_if(files, [&](const std::string& one) {
        std::error_code unknown;
        return one == options.prefer || std::filesystem::equivalent(one, options.prefer, unknown);
    });
    refuse_if(file == files.end(), "--prefer {}: it is none of the files that are brought together",
              options.prefer);
    return *file;
}

int run(const MergeOptions& options) {
    if (options.expect > 0) {
        expect_shards(options.inputs, static_cast<std::size_t>(options.expect));
    }
    for (const std::string& file : options.inputs) {
        if (data::SessionLock::all_held(file) > 0) {
            warn("{}: a session runs on it, and goes on: merge again when it has ended", file);
        }
    }
    if (data::SessionLock::all_held(options.database) > 0) {
        warn("{}: a session runs on it, and goes on, whatever the others note of its participant",
             options.database);
    }
    const data::MergeReport done =
        data::merge_files(options.database, options.inputs, preferred(options));
    say("{}: {} new, {} went on, {} as before{}.\n", options.database,
        counted(done.added, "session"), done.extended, done.same,
        done.replaced > 0 ? fmt::format(", {} as {} has it", done.replaced, options.prefer) : "");
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

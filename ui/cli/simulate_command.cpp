#include <algorithm>
#include <filesystem>
#include <string>

#include <fmt/format.h>

#include "engine/base/clock.hpp"
#include "engine/base/files.hpp"
#include "engine/base/refuse.hpp"
#include "engine/base/side_by_side.hpp"
#include "engine/base/text.hpp"
#include "protocols/file/observer_file.hpp"
#include "data/store/secret.hpp"
#include "ui/command/command.hpp"
#include "ui/rig/interrupt.hpp"
#include "ui/rig/operator_log.hpp"
#include "ui/rig/say.hpp"
#include "ui/session/simulation.hpp"

namespace palpate::ui {
namespace {

namespace fs = std::filesystem;

struct SimulateOptions {
    std::string protocol;
    std::int64_t participants = 12;
    std::string observer;
    std::string database;
    std::string folder;
    std::string shard;
    std::int64_t threads = 0;
    std::optional<std::uint64_t> seed;
    std::string secret{data::kDemoSecret};
    bool no_traces = false;
    std::string scratch;
    std::int64_t slurm = 0;
    bool example = false;
};

/// What is kept, and where it is made.
void declare_keeping(CommandWords& words, SimulateOptions& options) {
    words.add("--no-traces", options.no_traces,
              "Keep no ticks: trials, answers and what was added up of them, in a hundredth of the "
              "room");
    words.add(
        "--scratch", options.scratch,
        "A folder on a disk of this machine for the growing file, where the other one is on a "
        "network");
    words
        .add("--slurm", options.slurm,
             "Only print a batch script for Slurm that simulates so many shards into -o")
        .within(1, 100'000)
        .needs("-o,--output");
    words.add("--example", options.example,
              "Only print an observer file: typical, with what each key means");
}

void declare(CommandWords& words, SimulateOptions& options) {
    words.add("PROTOCOL", options.protocol, "A protocol file, or the name of a shipped one")
        .required_unless("--example");
    words.add("--participants", options.participants, "Of the study, in all shards together")
        .within(1, 999'999);
    words.add("--observer", options.observer,
              "Who they are: an observer file, or typical; without it all are alike, as [observer] "
              "of the protocol says");
    words.add("--db", options.database, "The file to make; while it grows it ends in .partial");
    words
        .add("-o,--output", options.folder,
             "A folder for the file instead, which is called shard-000-of-001.sqlite by its shard")
        .excludes("--db");
    words.add("--shard", options.shard,
              "K/N: every N-th participant alone, from the K-th on, K from 0; merged they are one "
              "study");
    words
        .add("--threads", options.threads,
             "So many participants at the same time; 0: as many as there are processors for it. "
             "The bytes are the same")
        .within(0, 1024)
        .with_default();
    words.add("--seed", options.seed, "Study seed instead of the protocol's");
    words.add("--secret", options.secret,
              "What orders, hands and answers are drawn with, 32 hexadecimal digits");
    declare_keeping(words, options);
}

SimulationSpec spec_of(const SimulateOptions& options) {
    SimulationSpec spec;
    spec.people.study = load_study(options.protocol);
    spec.people.seed = options.seed.value_or(spec.people.study.protocol.seed);
    data::check_secret(options.secret);
    spec.people.secret = options.secret;
    if (!options.observer.empty()) {
        spec.people.observer = protocols::load_observer(options.observer);
    }
    spec.people.traces = !options.no_traces;
    spec.participants = static_cast<std::size_t>(options.participants);
    spec.shard = options.shard.empty() ? Shard{} : parse_shard(options.shard);
    refuse_if(participants_of(spec.shard, spec.participants) == 0,
              "--shard {}: it has none of the {} participants; give N of at most {}", options.shard,
              spec.participants, spec.participants);
    spec.threads =
        options.threads > 0 ? static_cast<std::size_t>(options.threads) : usable_processors();
    spec.scratch = options.scratch;
    refuse_if(options.database.empty() == options.folder.empty(),
              "give --db FILE, or -o FOLDER, for what is simulated");
    spec.file = options.folder.empty() ? fs::path(options.database)
                                       : fs::path(options.folder) / shard_name(spec.shard);
    return spec;
}

/// The words of a shard's command, as a shell takes them.
std::string shard_words(const SimulateOptions& options) {
    std::string words = fmt::format("simulate {} --participants {}", shell_word(options.protocol),
                                    options.participants);
    if (!options.observer.empty()) {
        words += " --observer " + shell_word(options.observer);
    }
    words += " -o " + shell_word(options.folder);
    if (options.seed) {
        words += fmt::format(" --seed {}", *options.seed);
    }
    if (options.secret != data::kDemoSecret) {
        words += " --secret " + options.secret;
    }
    return words + (options.no_traces ? " --no-traces" : "");
}

/// The number of shards is written out: SLURM_ARRAY_TASK_COUNT is 1 where one failed task is
/// submitted again.
std::string slurm_script(const SimulateOptions& options) {
    const std::size_t shards = static_cast<std::size_t>(options.slurm);
    refuse_if(shards > static_cast<std::size_t>(options.participants),
              "--slurm {}: no more shards than --participants, {}", shards, options.participants);
    std::error_code unknown;
    const fs::path self = fs::read_symlink("/proc/self/exe", unknown);
    const std::string program = shell_word(unknown ? "palpate" : self.string());
    const std::string folder = shell_word(options.folder);
    const std::string files = fmt::format("{}/shard-*-of-{:03}.sqlite", folder, shards);
    const std::int64_t threads = std::max<std::int64_t>(options.threads, 1);
    return fmt::format(
        "#!/bin/sh\n"
        "# mkdir -p {folder}/log && ID=$(sbatch --parsable THIS_SCRIPT)\n"
        "# sbatch --dependency=afterok:$ID --kill-on-invalid-dep=yes --wrap \"{program} merge "
        "--expect {shards} {folder}/all.sqlite {files}\"\n"
        "#SBATCH --job-name=palpate-simulate\n"
        "#SBATCH --array=0-{last}\n"
        "#SBATCH --requeue\n"
        "#SBATCH --signal=B:TERM@60\n"
        "#SBATCH --cpus-per-task={threads}\n"
        "#SBATCH --output={folder}/log/%A_%a.log\n"
        "exec {program} {words} --shard \"$SLURM_ARRAY_TASK_ID/{shards}\" --threads "
        "\"$SLURM_CPUS_PER_TASK\" --scratch \"${{TMPDIR:-/tmp}}\"\n",
        fmt::arg("folder", folder), fmt::arg("program", program), fmt::arg("shards", shards),
        fmt::arg("files", files), fmt::arg("last", shards - 1), fmt::arg("threads", threads),
        fmt::arg("words", shard_words(options)));
}

/// What looks at the answers of such a protocol.
std::string look_at(const protocols::Protocol& protocol, const std::string& file) {
    if (protocol.response.kind == protocols::ResponseKind::rating) {
        return "summary " + file;
    }
    return fmt::format("{} {} --kind simulated", protocol.procedure ? "fit" : "stats", file);
}

/// Simulates, and says how far it came. @param trials  a session
int make(SimulationSpec& spec, std::size_t trials) {
    const std::size_t all = participants_of(spec.shard, spec.participants);
    const std::string file = spec.file.string();
    spec.progress = [all](const std::string& code, std::size_t kept) {
        say("{}: {} of {}\n", code, kept, all);
    };
    const std::int64_t begun = monotonic_ns();
    switch (simulate(spec)) {
        case SimulationEnd::was_there:
            say("{}: already done, {}.\n", file, counted(all, "participant"));
            return 0;
        case SimulationEnd::stopped:
            say("Stopped; the same command goes on with what is there.\n");
            return kExitStopped;
        case SimulationEnd::made:
            break;
    }
    say("{}: {} of {}{}, in {:.1f} s.\nNext: palpate {}\n", file,
        counted(all, "simulated participant"), counted(trials, "trial"), all == 1 ? "" : " each",
        static_cast<double>(monotonic_ns() - begun) * 1e-9,
        look_at(spec.people.study.protocol, shell_word(file)));
    return 0;
}

int run(const SimulateOptions& options) {
    if (options.example) {
        say("{}", protocols::observer_example());
        return 0;
    }
    SimulationSpec spec = spec_of(options);
    if (options.slurm > 0) {
        say("{}", slurm_script(options));
        return 0;
    }
    catch_signals();
    if (!options.folder.empty()) {
        make_folder(options.folder);
    }
    if (!options.scratch.empty()) {
        make_folder(options.scratch);
    }
    const SimulatedSession first(spec.people, spec.shard.number);
    for (const std::string& finding : first.findings()) {
        warn("{}", finding);
    }
    return make(spec, first.plan().trials.size());
}

}  // namespace

Command simulate_command() {
    return make_command<SimulateOptions>(
        "simulate",
        "Simulated participants: hands that explore, observers that judge what they felt", declare,
        run);
}

}  // namespace palpate::ui

#include <filesystem>
#include <stdexcept>
#include <system_error>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "engine/device/device.hpp"
#include "data/store/session_lock.hpp"
#include "ui/command/command.hpp"
#include "ui/rig/control_line.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {
namespace {

struct StopOptions {
    std::optional<std::string> database;
};

void declare(CommandWords& words, StopOptions& options) {
    words.add(
        "FILE", options.database,
        "The database of the session; without it every session of this user that somebody feels");
}

int run(const StopOptions& options) {
    const StopResult stopped = stop_sessions(options.database);
    std::error_code unknown;  // weak pulses come before a new file
    refuse_if(options.database && !std::filesystem::exists(*options.database, unknown) &&
                  stopped.sessions + stopped.unproved + stopped.silent + stopped.uncalled == 0,
              "{}: there is no such file", *options.database);
    if (stopped.sessions > 0) {
        say("No force any more in {}:\n{}", counted(stopped.sessions, "session"), stopped.labels);
    }
    const std::size_t all = options.database ? data::SessionLock::all_held(*options.database) : 0;
    const std::string beyond =
        all <= stopped.on_file
            ? ""
            : fmt::format(
                  "{}: {} on it cannot be called from here, as in another container or "
                  "network namespace: {}stop it there, or use the switch of its motors",
                  *options.database, counted(all - stopped.on_file, "session"),
                  stopped.sessions + stopped.unproved > 0 ? "" : "nothing was stopped; ");
    if (!beyond.empty() && stopped.sessions + stopped.unproved + stopped.on_file >
                               0) {  // what else is to be said follows
        warn("{}", beyond);
    }
    refuse_if<std::runtime_error>(
        stopped.silent + stopped.uncalled > 0,
        "{} did not answer in 2 s, which hangs or is stopped: use the switch of its motors{}",
        counted(stopped.silent + stopped.uncalled, "session"),
        stopped.uncalled > 0 ? "" : ". It gives no force when it goes on");
    refuse_if<std::runtime_error>(stopped.unproved > 0, "of {}: {}:\n{}",
                                  counted(stopped.unproved, "session"), engine::kForceUnproved,
                                  stopped.doubtful.substr(0, stopped.doubtful.rfind('\n')));
    if (stopped.sessions > 0) {
        return beyond.empty() ? 0 : kExitFailure;
    }
    refuse_if<std::runtime_error>(!options.database,
                                  "no session that somebody feels is yours: nothing was stopped");
    const std::string& file = *options.database;
    refuse_if<std::runtime_error>(
        stopped.refused > 0,
        "{}: a session runs on it, and only who may write to it, or runs it, can stop it: nothing "
        "was stopped",
        file);
    refuse_if<std::runtime_error>(!beyond.empty(), "{}", beyond);
    throw std::runtime_error(file +
                             ": no session runs on it: nothing was stopped; palpate stop without a "
                             "file stops all of yours");
}

}  // namespace

Command stop_command() {
    return make_command<StopOptions>("stop", "Switch the force of a running session off", declare,
                                     run);
}

}  // namespace palpate::ui


#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "data/sync/push.hpp"
#include "ui/command/command.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {
namespace {

struct PushOptions {
    std::string database;
    std::string url;  ///< postgresql://...
    data::PushChoice choice;
    bool roles = false;  ///< only print the script of the roles
};

void declare(CommandWords& words, PushOptions& options) {
    words.add("FILE", options.database, "A database; only read");
    words.add("--to", options.url, "postgresql://..., with libpq's sslmode and sslrootcert");
    words.add("--including-refused", options.choice.including_refused,
              "Also who is noted as not consenting; without it nothing of them is sent");
    words.add("--insecure", options.choice.insecure,
              "To another machine without sslmode=verify-full: others can read what is sent");
    words.add("--roles", options.roles, "Print SQL for an administrator: the schema and two roles");
}

int run(const PushOptions& options) {
    if (options.roles) {
        say("{}", data::push_setup());
        return 0;
    }
    refuse_if(options.database.empty() || options.url.empty(),
              "push needs FILE and --to postgresql://..., or --roles");
    const data::PushReport done = data::push_file(options.database, options.url, options.choice);
    say("{}: {}{}, {} new on the server.\n", options.database, counted(done.sessions, "session"),
        done.declined > 0 ? fmt::format(" ({} of them left out: no consent)", done.declined) : "",
        counted(done.rows, "row"));
    if (done.withdrawn > 0) {
        say("{} of them withdrawn: on the server, too, an event says so, and it is for its queries "
            "to leave them out.\n",
            done.withdrawn);
    }
    say("Sent to {}.\n", done.way);
    for (const std::string& conflict : done.conflicts) {
        say_to(stderr, fmt::format("conflict: {}; not pushed\n", plain(conflict)));
    }
    return done.conflicts.empty() ? 0 : kExitFailure;
}

}  // namespace

Command push_command() {
    return make_command<PushOptions>("push", "Bring a file's new rows into PostgreSQL", declare,
                                     run);
}

}  // namespace palpate::ui

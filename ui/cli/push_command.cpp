#include <stdexcept>

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "data/sync/push.hpp"
#include "ui/cli/commands.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {

int push_command(const PushOptions& options) {
    if (options.roles) {
        say("{}", data::push_setup());
        return 0;
    }
    if (options.database.empty() || options.url.empty()) {
        throw std::invalid_argument("push needs FILE and --to postgresql://..., or --roles");
    }
    const data::PushReport done = data::push_file(options.database, options.url);
    say("{}: {}, {} new on the server.\n", options.database, counted(done.sessions, "session"),
        counted(done.rows, "row"));
    for (const std::string& conflict : done.conflicts) {
        say_to(stderr, fmt::format("conflict: {}; not pushed\n", plain(conflict)));
    }
    return done.conflicts.empty() ? 0 : kExitFailure;
}

}  // namespace palpate::ui

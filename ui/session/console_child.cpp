#include "ui/session/console_child.hpp"

#include <array>
#include <utility>

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "ui/rig/say.hpp"

namespace palpate::ui {

ConsoleChild::ConsoleChild(std::string session) : session_(std::move(session)) {
    if (!session_.empty()) {
        start();
    }
}

/// In a group of its own: Ctrl+C is for the session, which takes its time to end.
void ConsoleChild::start() {
    std::array<const char*, 5> words{"palpate", "console", session_.c_str(), "--while-runs",
                                     nullptr};
    posix_spawnattr_t how;
    posix_spawnattr_init(&how);
    posix_spawnattr_setflags(&how, POSIX_SPAWN_SETPGROUP);
    const int error = posix_spawn(&pid_, "/proc/self/exe", nullptr, &how,
                                  const_cast<char**>(words.data()), environ);
    posix_spawnattr_destroy(&how);
    if (error != 0) {
        pid_ = -1;
        warn(
            "the experimenter's page could not be started; palpate console {} does, from another "
            "terminal",
            session_);
    }
}

void ConsoleChild::look() {
    if (pid_ < 0 || waitpid(pid_, nullptr, WNOHANG) != pid_) {
        return;
    }
    pid_ = -1;
    if (std::exchange(again_, true)) {
        warn(
            "the experimenter's page ended again; palpate console {} starts it, from another "
            "terminal",
            session_);
    } else {
        warn("the experimenter's page ended, and is started again");
        start();
    }
}

}  // namespace palpate::ui

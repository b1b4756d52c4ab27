#include "ui/rig/stay_awake.hpp"

#include <array>
#include <csignal>

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;  // NOLINT: POSIX asks for it

namespace palpate::ui {

constexpr int kPatienceMs = 2000;  ///< for a bus that answers slowly

void StayAwake::start(int in, int out) {
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_adddup2(&files, in, STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&files, out, STDOUT_FILENO);
    posix_spawn_file_actions_addopen(&files, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawnattr_t own_group;  // Ctrl+C ends a session in good order, and is not for this
    posix_spawnattr_init(&own_group);
    posix_spawnattr_setflags(&own_group, POSIX_SPAWN_SETPGROUP);
    std::array<const char*, 9> words{"systemd-inhibit",
                                     "--what=sleep:idle:handle-lid-switch",
                                     "--who=palpate",
                                     "--why=a hand is on a device that gives force",
                                     "--mode=block",
                                     "sh",
                                     "-c",
                                     "echo held; cat > /dev/null",
                                     nullptr};
    if (posix_spawnp(&pid_, words[0], &files, &own_group, const_cast<char**>(words.data()),
                     environ) != 0) {
        pid_ = -1;
    }
    posix_spawnattr_destroy(&own_group);
    posix_spawn_file_actions_destroy(&files);
}

StayAwake::StayAwake() {
    std::array<int, 2> life{-1, -1};
    std::array<int, 2> word{-1, -1};
    if (pipe2(life.data(), O_CLOEXEC) == 0 && pipe2(word.data(), O_CLOEXEC) == 0) {
        start(life[0], word[1]);
        close(word[1]);
        pollfd said{.fd = word[0], .events = POLLIN, .revents = 0};
        char first = 0;
        held_ = pid_ > 0 && poll(&said, 1, kPatienceMs) == 1 && read(word[0], &first, 1) == 1;
        close(word[0]);
    }
    if (life[0] >= 0) {
        close(life[0]);
    }
    pipe_ = life[1];
}

StayAwake::~StayAwake() {
    if (pipe_ >= 0) {
        close(pipe_);
    }
    if (pid_ > 0) {
        kill(pid_, SIGTERM);  // it may wait for its bus instead
        waitpid(pid_, nullptr, 0);
    }
}

std::string StayAwake::text() const {
    return held_ ? "held off (systemd-inhibit)"
                 : "not held off: systemd-inhibit is not there or was refused";
}

}  // namespace palpate::ui

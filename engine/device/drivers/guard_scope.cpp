#include "engine/device/drivers/guard_scope.hpp"

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace palpate::engine {
namespace {

constexpr int kPatienceMs = 1500;  ///< of busctl
constexpr int kMoveMs = 500;       ///< until the process is there

std::string group_of(const std::string& process) {
    std::ifstream in("/proc/" + process + "/cgroup");
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

/// Runs a program that says nothing. @return true if it ended well and in time
bool ran(std::vector<std::string> words) {
    std::vector<char*> pointers;
    for (std::string& word : words) {
        pointers.push_back(word.data());
    }
    pointers.push_back(nullptr);
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    for (int fd = 0; fd <= 2; ++fd) {
        posix_spawn_file_actions_addopen(&files, fd, "/dev/null", O_RDWR, 0);
    }
    pid_t child = -1;
    const int failed =
        posix_spawnp(&child, pointers.front(), &files, nullptr, pointers.data(), environ);
    posix_spawn_file_actions_destroy(&files);
    if (failed != 0) {
        return false;
    }
    int status = 1;
    for (int waited = 0; waitpid(child, &status, WNOHANG) == 0; ++waited) {
        if (waited == kPatienceMs) {
            kill(child, SIGKILL);
        }
        poll(nullptr, 0, 1);
    }
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace

bool set_apart(pid_t process) {
    const std::string id = std::to_string(process);
    std::vector<std::string> words{"busctl", "--timeout=1"};
    if (geteuid() != 0) {
        words.emplace_back("--user");
    }
    for (const char* word :
         {"call", "org.freedesktop.systemd1", "/org/freedesktop/systemd1",
          "org.freedesktop.systemd1.Manager", "StartTransientUnit", "ssa(sv)a(sa(sv))"}) {
        words.emplace_back(word);
    }
    for (const std::string& word :
         {"palpate-guard-" + id + ".scope", std::string("fail"), std::string("1"),
          std::string("PIDs"), std::string("au"), std::string("1"), id, std::string("0")}) {
        words.push_back(word);
    }
    const std::string ours = group_of("self");
    bool apart = false;
    if (ran(words)) {
        for (int waited = 0; waited < kMoveMs && !apart; ++waited) {
            apart = group_of(id) != ours;
            poll(nullptr, 0, 1);
        }
    }
    return apart;
}

}  // namespace palpate::engine

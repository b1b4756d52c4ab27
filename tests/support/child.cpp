#include "tests/support/child.hpp"

#include <poll.h>
#include <sys/prctl.h>

namespace palpate::tests {

void die_with(pid_t parent) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) {  // it ended before
        _exit(127);
    }
}

pid_t in_a_child(const std::function<void()>& work) {
    const pid_t test = getpid();
    const pid_t pid = fork();
    if (pid == 0) {
        die_with(test);
        for (const int number : {SIGTERM, SIGABRT, SIGSEGV, SIGINT}) {
            std::signal(number, SIG_DFL);  // not the test framework's
        }
        try {
            work();
        } catch (const std::exception&) {
        }
        _exit(0);
    }
    return pid;
}

pid_t guard_of(pid_t palpate) {
    for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
        std::ifstream stat(entry.path() / "stat");
        std::string line;
        std::getline(stat, line);
        std::istringstream rest(line.substr(line.rfind(')') + 1));
        char state = ' ';
        pid_t parent = 0;
        rest >> state >> parent;
        if (parent == palpate && state != 'Z' &&
            line.find("(palpate-guard)") != std::string::npos) {
            return static_cast<pid_t>(std::stol(entry.path().filename().string()));
        }
    }
    return -1;
}

std::int64_t patience_ns() {
    const char* const given = std::getenv("PALPATE_TEST_PATIENCE");  // s
    return (given != nullptr ? std::atoll(given) : 50) * 1000 * kMillisecond;
}

void wait_a_little(int ms) {
    poll(nullptr, 0, ms);
}

}  // namespace palpate::tests

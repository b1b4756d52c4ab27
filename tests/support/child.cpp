#include "tests/support/child.hpp"

#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>

#include "engine/device/drivers/board_device.hpp"
#include "engine/device/drivers/guard_process.hpp"
#include "engine/device/drivers/haply_line.hpp"
#include "engine/device/drivers/serial_link.hpp"
#include "engine/device/open/open_line.hpp"

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
        for (const int number : {SIGTERM, SIGABRT, SIGSEGV, SIGINT, SIGHUP}) {
            std::signal(number, SIG_DFL);  // not the framework's, nor nohup's
        }
        try {
            work();
        } catch (const std::exception&) {
        }
        _exit(0);
    }
    return pid;
}

std::vector<pid_t> children_of(pid_t parent, std::string_view name) {
    std::vector<pid_t> children;
    for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
        std::ifstream stat(entry.path() / "stat");
        std::string line;
        std::getline(stat, line);
        std::istringstream rest(line.substr(line.rfind(')') + 1));
        char state = ' ';
        pid_t from = 0;
        rest >> state >> from;
        if (from == parent && state != 'Z' && line.find(name) != std::string::npos) {
            children.push_back(static_cast<pid_t>(std::stol(entry.path().filename().string())));
        }
    }
    return children;
}

pid_t guard_of(pid_t palpate) {
    const auto guards = children_of(palpate, "(palpate-guard)");
    return guards.empty() ? -1 : guards.front();
}

std::int64_t patience_ns() {
    const char* const given = std::getenv("PALPATE_TEST_PATIENCE");  // s
    return (given != nullptr ? std::atoll(given) : 50) * 1000 * kMillisecond;
}

void wait_a_little(int ms) {
    poll(nullptr, 0, ms);
}

struct Presser::Shared {
    std::atomic<bool> end{false};
    std::atomic<int> fault{0};
    std::atomic<pid_t> guard{0};
};

namespace {

using namespace palpate::engine;

void press(Presser::Shared& shared,
           const std::string& path,
           const Calibration& calibration,
           const Vec2& force,
           Presser::End end) {
    auto guard = std::make_unique<GuardProcess>();
    const GuardProcess& watcher = *guard;
    // A machine under test may be busy: only the guard is in a hurry.
    const bool open = calibration.board.has_value();
    BoardDevice device(calibration, std::make_unique<SerialLink>(path, open),
                       open ? open_line : haply_line, std::move(guard), {.silence = 5.0});
    while (true) {
        shared.guard.store(watcher.id());
        const Reading reading = device.read();
        if (!reading.ok() && shared.fault.load() == 0) {
            shared.fault.store(static_cast<int>(reading.fault));
        }
        device.write(Vec3(force, 0.0));
        wait_a_little();
        if (shared.end.load()) {
            while (end == Presser::End::hang) {
                wait_a_little();
            }
        }
    }
}

}  // namespace

Presser::Presser(const std::string& path,
                 const Calibration& calibration,
                 const Vec2& force,
                 End end) {
    void* memory =
        mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) {
        throw std::runtime_error("no shared memory");
    }
    shared_ = new (memory) Shared{};
    pid_ = in_a_child([&] { press(*shared_, path, calibration, force, end); });
}

Presser::~Presser() {
    signal(SIGKILL);
    reap();
    munmap(shared_, sizeof(Shared));
}

void Presser::signal(int number) const {
    if (pid_ > 0) {
        kill(pid_, number);
    }
}

void Presser::end() {
    shared_->end.store(true);
}

void Presser::reap() {
    if (pid_ > 0) {
        waitpid(pid_, nullptr, 0);
        pid_ = -1;
    }
}

int Presser::fault() const {
    return shared_->fault.load();
}

pid_t Presser::guard() const {
    return shared_->guard.load();
}

}  // namespace palpate::tests

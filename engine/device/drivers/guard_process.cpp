#include "engine/device/drivers/guard_process.hpp"

#include <cerrno>
#include <new>
#include <stdexcept>
#include <string>

#include <poll.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include "engine/base/clock.hpp"
#include "engine/base/descriptor.hpp"
#include "engine/base/files.hpp"
#include "engine/base/refuse.hpp"
#include "engine/base/shell.hpp"

namespace palpate::engine {
namespace {

constexpr int kMoveMs = 500;  ///< until the process is there

std::string group_of(const std::string& process) {
    return file_text("/proc/" + process + "/cgroup");
}

/// Moves a process of this program into a control group of its own, a transient scope of systemd:
/// what freezes or kills palpate's group leaves it alone. Asked over busctl, which comes with
/// systemd-run and, unlike it, moves a process that lives. Takes two seconds at most.
/// @return false: there is no systemd, it refused, or it took too long; the process stays
bool set_apart(pid_t process) {
    const std::string id = std::to_string(process);
    const std::string asked =
        "timeout --foreground -s KILL 1.5 busctl --timeout=1 " +
        std::string(geteuid() == 0 ? "" : "--user ") +
        "call org.freedesktop.systemd1 /org/freedesktop/systemd1 org.freedesktop.systemd1.Manager "
        "StartTransientUnit 'ssa(sv)a(sa(sv))' palpate-guard-" +
        id + ".scope fail 1 PIDs au 1 " + id + " 0 </dev/null >/dev/null 2>&1";
    const std::string ours = group_of("self");
    bool apart = false;
    if (output_of(asked).second == 0) {
        for (int waited = 0; waited < kMoveMs && !apart; ++waited) {
            apart = group_of(id) != ours;
            poll(nullptr, 0, 1);
        }
    }
    return apart;
}

constexpr int kAcknowledgeMs = 1000;
/// How often the driver asks the kernel for its guard.
constexpr std::int64_t kAskEvery = 2 * kMillisecond;

std::atomic<std::uint64_t> guards{0};
/// Which guard knows of this thread's life, 0: none.
thread_local std::uint64_t known_to = 0;

void make_robust(pthread_mutex_t& mutex) noexcept {
    pthread_mutexattr_t robust;
    pthread_mutexattr_init(&robust);
    pthread_mutexattr_setrobust(&robust, PTHREAD_MUTEX_ROBUST);
    pthread_mutexattr_setpshared(&robust, PTHREAD_PROCESS_SHARED);
    pthread_mutex_init(&mutex, &robust);
    pthread_mutexattr_destroy(&robust);
}

/// @return true if this thread has it now
bool take(pthread_mutex_t& mutex) noexcept {
    const int got = pthread_mutex_trylock(&mutex);
    if (got == EOWNERDEAD) {
        pthread_mutex_consistent(&mutex);
    }
    return got == 0 || got == EOWNERDEAD;
}

static_assert(std::atomic<std::uint64_t>::is_always_lock_free &&
                  std::atomic<std::int64_t>::is_always_lock_free &&
                  std::atomic<bool>::is_always_lock_free,
              "two processes share them");

bool send_message(int socket, GuardPackets packets, int port) noexcept {
    iovec body{.iov_base = &packets, .iov_len = sizeof packets};
    return send_with_file(socket, {&body, 1}, port, MSG_NOSIGNAL) ==
           static_cast<ssize_t>(sizeof packets);
}

}  // namespace

GuardProcess::GuardProcess(const GuardTiming& timing) : timing_(timing), number_(++guards) {
    void* memory = mmap(nullptr, sizeof(GuardShared), PROT_READ | PROT_WRITE,
                        MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    refuse_if<std::runtime_error>(memory == MAP_FAILED,
                                  "no memory to share with the guard process: end some programs");
    shared_ = new (memory) GuardShared{};
    make_robust(shared_->life);
    static_cast<void>(start());
}

GuardProcess::~GuardProcess() {
    end();
    if (known_to == number_ || take(shared_->life)) {
        pthread_mutex_unlock(&shared_->life);
        munmap(shared_, sizeof(GuardShared));
    }  // else a thread still holds it: a page is lost, and that thread ends well
}

bool GuardProcess::start() {
    std::array<int, 2> ends{};
    if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0) {
        return false;
    }
    shared_->seen_ns.store(monotonic_ns());
    gone_ = false;
    const pid_t owner = getpid();
    pid_ = fork();
    if (pid_ == 0) {
        close(ends[0]);
        guard_motors(ends[1], owner, *shared_, timing_);
    }
    close(ends[1]);
    socket_ = ends[0];
    if (pid_ < 0) {
        end();
    }
    apart_ = pid_ > 0 && timing_.apart && set_apart(pid_);
    return pid_ > 0;
}

void GuardProcess::end() noexcept {
    if (pid_ > 0) {
        release();
    }
    if (socket_ >= 0) {
        close(socket_);  // the guard, which holds no port, ends
        socket_ = -1;
    }
    if (pid_ > 0) {
        for (int waited = 0; waitpid(pid_, nullptr, WNOHANG) == 0; ++waited) {
            if (waited == kAcknowledgeMs) {  // it was stopped: nothing else ends it
                kill(pid_, SIGKILL);
            }
            poll(nullptr, 0, 1);
        }
    }
    pid_ = -1;
}

/// One that was stopped would be waited for in vain.
bool GuardProcess::listens() const noexcept {
    return pid_ > 0 && !ended_or_stopped();
}

bool GuardProcess::acknowledged() const noexcept {
    pollfd answer{.fd = socket_, .events = POLLIN, .revents = 0};
    char received = 0;
    return poll(&answer, 1, kAcknowledgeMs) == 1 && recv(socket_, &received, 1, MSG_DONTWAIT) == 1;
}

bool GuardProcess::watch(int port, const GuardPackets& packets) {
    if (packets.zero.size == 0 || port < 0 || packets.answer.size > packets.answer_size) {
        return false;
    }
    force_off();
    repeat_zeros(false);
    for (int attempt = 0; attempt < 2; ++attempt) {
        shared_->tripped.store(false);
        if (listens() && send_message(socket_, packets, port) && acknowledged()) {
            return true;
        }
        end();
        if (!start()) {
            break;
        }
    }
    return false;
}

void GuardProcess::release() noexcept {
    if (pid_ > 0 && !(listens() && send_message(socket_, {}, -1) && acknowledged())) {
        kill(pid_, SIGKILL);  // it would keep the port's name taken
    }
}

/// Whoever dies with this mutex wakes the guard.
void GuardProcess::show_life() noexcept {
    if (known_to != number_ && take(shared_->life)) {
        known_to = number_;
        shared_->held.store(true);
    }
}

/// Asked of the kernel now and then, without waiting: the answer stays with it.
bool GuardProcess::ended_or_stopped() const noexcept {
    const std::int64_t now = monotonic_ns();
    if (!gone_ && now - asked_ns_ >= kAskEvery) {
        asked_ns_ = now;
        siginfo_t change{};
        const int asked =
            waitid(P_PID, static_cast<id_t>(pid_), &change, WEXITED | WSTOPPED | WNOHANG | WNOWAIT);
        gone_ = asked != 0 || change.si_pid != 0;
    }
    return gone_;
}

void GuardProcess::force_on() noexcept {
    show_life();
    beats_ += 2;
    shared_->beat.store(beats_ + 1);
}

void GuardProcess::force_off() noexcept {
    beats_ += 2;
    shared_->beat.store(beats_);
}

bool GuardProcess::alive() const noexcept {
    return pid_ > 0 && !ended_or_stopped() &&
           monotonic_ns() - shared_->seen_ns.load() < timing_.alive_ms * kMillisecond;
}

bool GuardProcess::tripped() const noexcept {
    return shared_->tripped.load();
}

}  // namespace palpate::engine

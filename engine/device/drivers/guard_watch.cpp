#include "engine/device/drivers/guard_watch.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <span>

#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <termios.h>
#include <unistd.h>

#include "engine/base/clock.hpp"
#include "engine/base/descriptor.hpp"
#include "engine/device/drivers/motor_guard.hpp"

namespace palpate::engine {
namespace {

constexpr int kZeros = 5;
constexpr int kPriority =
    90;  ///< above the servo: a servo that spins must not keep its guard waiting
constexpr int kAnswerMs = 20;
constexpr int kRepeatMs = 20;

/// State of the one guard in this process.
struct GuardState {
    int port = -1;
    GuardPackets packets{};
};

void close_between(unsigned first, unsigned last) noexcept {
#ifdef SYS_close_range
    if (first > last || syscall(SYS_close_range, first, last, 0U) == 0) {
        return;
    }
#endif
    for (unsigned fd = first; fd <= last && fd < 1024U; ++fd) {
        close(static_cast<int>(fd));
    }
}

void stay_out_of_the_way(int keep) noexcept {
    setsid();
    for (const int number :
         {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE, SIGTSTP, SIGTTIN, SIGTTOU, SIGUSR1, SIGUSR2}) {
        signal(number, SIG_IGN);
    }
    prctl(PR_SET_NAME, "palpate-guard");
    prctl(PR_SET_TIMERSLACK, 1000UL);
    cpu_set_t every;  // a core that a real-time program keeps must not be the only one
    std::memset(&every, 0xFF, sizeof every);
    sched_setaffinity(0, sizeof every, &every);
    const sched_param urgent{.sched_priority = kPriority};
    sched_setscheduler(0, SCHED_FIFO, &urgent);  // where it is permitted

    if (const int score = open("/proc/self/oom_score_adj", O_WRONLY); score >= 0) {
        static_cast<void>(write(score, "-1000", 5) < 0);  // where it is permitted
    }
    mlockall(MCL_CURRENT | MCL_FUTURE | MCL_ONFAULT);  // what it touches: little of palpate's

    const int nowhere = open("/dev/null", O_RDWR);  // a pipe behind palpate must see its end
    for (int fd = 0; nowhere >= 0 && fd <= 2; ++fd) {
        dup2(nowhere, fd);
    }
    close_between(3, static_cast<unsigned>(keep) - 1U);
    close_between(static_cast<unsigned>(keep) + 1U, ~0U);
}

void wait_ms(int ms) noexcept {
    poll(nullptr, 0, ms);
}

/// Never blocks: the port is non-blocking, and what cannot be written soon is given up.
void write_packet(int port, const BoardBytes& packet) noexcept {
    for (int i = 0; i < 3; ++i) {
        if (write(port, packet.bytes.data(), packet.size) >= 0) {
            return;
        }
        pollfd room{.fd = port, .events = POLLOUT, .revents = 0};
        if (poll(&room, 1, 1) > 0 && (room.revents & (POLLERR | POLLHUP | POLLNVAL)) != 0) {
            return;
        }
    }
}

void zero(const GuardState& guarded) noexcept {
    for (int i = 0; i < kZeros; ++i) {
        write_packet(guarded.port, guarded.packets.zero);
        wait_ms(1);
    }
}

/// A whole answer to `zero` is among the bytes.
bool answered(const GuardPackets& packets, std::span<const std::uint8_t> bytes) noexcept {
    const auto begins = packets.answer.view();
    for (; bytes.size() >= packets.answer_size; bytes = bytes.subspan(1)) {
        if (std::ranges::equal(begins, bytes.first(begins.size()))) {
            return true;
        }
    }
    return false;
}

/// One more `zero` has a whole answer: a Haply board without an address says its id and no more.
/// Palpate is gone: nobody else reads.
bool board_obeys(const GuardState& guarded) noexcept {
    tcflush(guarded.port, TCIFLUSH);
    write_packet(guarded.port, guarded.packets.zero);
    std::array<std::uint8_t, 256> answer{};
    std::size_t size = 0;
    for (int waited = 0; waited < kAnswerMs && !answered(guarded.packets, {answer.data(), size});
         ++waited) {
        wait_ms(1);
        const ssize_t got = read(guarded.port, answer.data() + size, answer.size() - size);
        size += got > 0 ? static_cast<std::size_t>(got) : 0U;
    }
    return answered(guarded.packets, {answer.data(), size});
}

/// The last thing a guard does.
void zero_for_good(const GuardState& guarded) noexcept {
    if (guarded.port < 0) {
        return;
    }
    zero(guarded);
    if (!board_obeys(guarded)) {  // it has no address, or half a packet was before ours
        write_packet(guarded.port, guarded.packets.setup);
        wait_ms(2);
        zero(guarded);
    }
    ioctl(guarded.port, TIOCNXCL);
    close(guarded.port);
}

/// @return false when palpate has closed the socket
bool take_message(int socket, GuardState& guarded) noexcept {
    GuardPackets message;
    int port = -1;
    if (receive_with_file(socket, std::as_writable_bytes(std::span(&message, 1)), port,
                          MSG_DONTWAIT) != static_cast<ssize_t>(sizeof message)) {
        return false;
    }
    if (guarded.port >= 0) {
        close(guarded.port);
    }
    guarded = {.port = port, .packets = message};
    const char received = 'k';
    return send(socket, &received, 1, MSG_NOSIGNAL) == 1;
}

/// Waits for `ms`, or shorter: true as soon as the thread that gives force has died.
bool thread_died(GuardShared& shared, int ms) noexcept {
    const timespec until = timespec_of(monotonic_ns() + ms * kMillisecond);
    const int got = pthread_mutex_clocklock(&shared.life, CLOCK_MONOTONIC, &until);
    if (got == ETIMEDOUT) {
        return false;
    }
    shared.held.store(false);  // the next thread that gives force takes it
    if (got == EOWNERDEAD) {
        pthread_mutex_consistent(&shared.life);
    }
    if (got == 0 || got == EOWNERDEAD) {
        pthread_mutex_unlock(&shared.life);
    }
    return got == EOWNERDEAD;
}

/// Counts the looks at a driver that is silent with the force on.
class Patience {
public:
    /// @return true if the driver counts as hung
    bool lost(std::uint64_t beat, int patience) noexcept {
        const bool silent = beat == last_ && beat % 2 == 1;
        looks_ = silent ? looks_ + 1 : 0;
        last_ = beat;
        return looks_ >= patience;
    }

private:
    std::uint64_t last_ = 0;
    int looks_ = 0;
};

}  // namespace

void guard_motors(int socket,
                  pid_t owner,
                  GuardShared& shared,
                  const GuardTiming& timing) noexcept {
    stay_out_of_the_way(socket);
    zero({.port = STDOUT_FILENO,
          .packets = {}});  // nothing to nowhere: what it will need is in memory
    const int life = static_cast<int>(syscall(SYS_pidfd_open, owner, 0));  // -1: an old kernel
    GuardState guarded;
    Patience patience;
    int looks = 0;  ///< since the last zero of those that are repeated
    while (true) {
        std::array<pollfd, 2> ends{pollfd{.fd = socket, .events = POLLIN, .revents = 0},
                                   pollfd{.fd = life, .events = POLLIN, .revents = 0}};
        const bool held = shared.held.load();
        if (held && thread_died(shared, timing.wait_ms) && shared.beat.load() % 2 == 1) {
            shared.tripped.store(true);
            if (guarded.port >= 0) {
                zero(guarded);
            }
        }
        const int woken = poll(ends.data(), ends.size(), held ? 0 : timing.wait_ms);
        shared.seen_ns.store(monotonic_ns());
        const bool message = ends[0].revents != 0;
        if (ends[1].revents != 0 || getppid() != owner ||
            (message && !take_message(socket, guarded))) {
            zero_for_good(guarded);
            _exit(0);
        }
        if (message) {
            patience = {};
        }
        const std::uint64_t beat = shared.beat.load();
        if (guarded.port < 0 || woken != 0) {
            continue;
        }
        if (!shared.tripped.load() && patience.lost(beat, timing.patience)) {
            shared.tripped.store(true);  // first: the driver must see it before its next packet
            zero(guarded);
        }
        const bool again = shared.repeat.load() && ++looks * timing.wait_ms >= kRepeatMs;
        looks = again ? 0 : looks;
        // Tripped: a packet may have slipped through before the driver saw it.
        if (again || (shared.tripped.load() && beat % 2 == 1)) {
            write_packet(guarded.port, guarded.packets.zero);
        }
    }
}

}  // namespace palpate::engine

#include "engine/realtime/realtime_rights.hpp"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>
#include <system_error>

#include <fcntl.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

namespace palpate::engine {
namespace {

constexpr std::size_t kStack = 256U << 10U;  ///< far above what a tick uses
constexpr std::size_t kPage = 4096;
constexpr int kIpcLock = 14;  ///< CAP_IPC_LOCK, capability.h

std::atomic<int> lockers{0};

Granted granted(bool success) noexcept {
    return success ? Granted{.grant = Grant::given}
                   : Granted{.grant = Grant::refused, .error = errno};
}

/// Whether locked memory is without limit here. With a limit and MCL_FUTURE every later allocation
/// of the program may fail, which is worse than a page fault.
bool may_lock_everything() noexcept {
    rlimit limit{};
    if (getrlimit(RLIMIT_MEMLOCK, &limit) == 0 && limit.rlim_cur == RLIM_INFINITY) {
        return true;
    }
    const int file = open("/proc/self/status", O_RDONLY | O_CLOEXEC);
    if (file < 0) {
        return false;
    }
    std::array<char, 4096> text{};
    const ssize_t size = read(file, text.data(), text.size() - 1);
    close(file);
    const char* line = size > 0 ? std::strstr(text.data(), "CapEff:") : nullptr;
    return line != nullptr && ((std::strtoull(line + 7, nullptr, 16) >> kIpcLock) & 1U) != 0;
}

Granted lock_memory() noexcept {
    if (may_lock_everything()) {
        return granted(mlockall(MCL_CURRENT | MCL_FUTURE) == 0);
    }
    Granted now = granted(mlockall(MCL_CURRENT) == 0);
    if (now.grant == Grant::given) {
        now.grant = Grant::partly;
    }
    return now;
}

[[gnu::noinline]] void touch_stack() noexcept {
    std::array<volatile char, kStack> stack;
    for (std::size_t i = 0; i < kStack; i += kPage) {
        stack[i] = 0;
    }
}

std::string refusal(Right right, const Granted& granted) {
    const bool limit = granted.error == ENOMEM || granted.error == EPERM || granted.error == EAGAIN;
    if (right == Right::fifo && limit) {
        return "SCHED_FIFO refused: this user may not use real-time priorities";
    }
    if (right == Right::memory && limit) {
        return "not locked: this user may lock less than the program needs";
    }
    return "refused: " + std::generic_category().message(granted.error);
}

}  // namespace

bool RealtimeRights::complete() const noexcept {
    return std::all_of(grants.begin(), grants.end(), [](const Granted& one) {
        return one.grant == Grant::given || one.grant == Grant::not_asked;
    });
}

ProgramRights::ProgramRights(const RealtimeWish& wish, RealtimeRights& rights) noexcept {
    if (wish.memory) {
        Granted& memory = rights.of(Right::memory);
        memory = lock_memory();
        locked_ = memory.grant != Grant::refused;
        lockers.fetch_add(locked_ ? 1 : 0);
    }
    if (wish.latency) {
        constexpr std::int32_t kMicroseconds = 0;
        latency_file_ = open("/dev/cpu_dma_latency", O_WRONLY | O_CLOEXEC);
        rights.of(Right::latency) =
            granted(latency_file_ >= 0 && write(latency_file_, &kMicroseconds,
                                                sizeof kMicroseconds) == sizeof kMicroseconds);
    }
}

ProgramRights::~ProgramRights() {
    if (latency_file_ >= 0) {
        close(latency_file_);  // closing takes the request back
    }
    if (locked_ && lockers.fetch_sub(1) == 1) {
        munlockall();
    }
}

void take_thread_rights(const RealtimeWish& wish, RealtimeRights& rights) noexcept {
    if (wish.fifo) {
        const sched_param parameter{.sched_priority = wish.priority};
        rights.of(Right::fifo) =
            granted(sched_setscheduler(0, SCHED_FIFO | SCHED_RESET_ON_FORK, &parameter) == 0);
        rights.priority = rights.of(Right::fifo).grant == Grant::given ? wish.priority : 0;
    }
    if (wish.slack) {
        rights.of(Right::slack) = granted(prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL) == 0);
    }
    touch_stack();
}

std::string_view name_of(Right right) noexcept {
    switch (right) {
        case Right::fifo:
            return "scheduling";
        case Right::memory:
            return "memory";
        case Right::latency:
            return "processor sleep";
        case Right::slack:
            break;
    }
    return "timer slack";
}

std::string describe(Right right, const RealtimeRights& rights) {
    const Granted& granted = rights.of(right);
    if (granted.grant == Grant::not_asked) {
        return "not asked for";
    }
    if (granted.grant == Grant::refused) {
        return refusal(right, granted);
    }
    switch (right) {
        case Right::fifo:
            return "SCHED_FIFO, priority " + std::to_string(rights.priority);
        case Right::memory:
            return granted.grant == Grant::partly
                     ? "locked as far as loaded at the start; what is allocated later is not"
                     : "locked";
        case Right::latency:
            return "held awake (/dev/cpu_dma_latency 0)";
        case Right::slack:
            break;
    }
    return "1 ns";
}

std::string remedy(Right right, const RealtimeRights& rights) {
    const Granted& granted = rights.of(right);
    if (granted.grant != Grant::refused && granted.grant != Grant::partly) {
        return "";
    }
    switch (right) {
        case Right::fifo:
            return "as root, once: groupadd palpate; usermod -aG palpate USER; write \"@palpate - "
                   "rtprio 90\" into /etc/security/limits.d/palpate.conf; then USER logs in again";
        case Right::memory:
            return "as root, once: add \"@palpate - memlock unlimited\" to "
                   "/etc/security/limits.d/palpate.conf, with USER in the group palpate as for "
                   "scheduling";
        case Right::latency:
            return granted.error == ENOENT
                     ? "this kernel has no power management to hold; nothing to do on a virtual "
                       "machine"
                     : "as root, once: write KERNEL==\"cpu_dma_latency\", GROUP=\"palpate\", "
                       "MODE=\"0660\" into /etc/udev/rules.d/70-palpate.rules; udevadm "
                       "control --reload; udevadm trigger";
        case Right::slack:
            break;
    }
    return "report it: every Linux allows this";
}

std::vector<std::pair<std::string, std::string>> provenance(const RealtimeRights& rights) {
    std::vector<std::pair<std::string, std::string>> rows;
    for (std::size_t i = 0; i < kRights; ++i) {
        const auto right = static_cast<Right>(i);
        rows.emplace_back("realtime " + std::string(name_of(right)), describe(right, rights));
    }
    return rows;
}

}  // namespace palpate::engine

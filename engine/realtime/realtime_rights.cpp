#include "engine/realtime/realtime_rights.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <system_error>

#include <fcntl.h>
#include <link.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <unistd.h>

namespace palpate::engine {
namespace {

/// What came of locking memory.
struct LockedParts {
    int locked = 0;
    int refused = 0;
    int error = 0;  ///< errno of the first refusal
};

constexpr std::size_t kPage = 4096;

void lock(LockedParts& parts, std::uintptr_t begin, std::size_t bytes) noexcept {
    const std::uintptr_t first = begin & ~(kPage - 1);
    if (bytes == 0) {
        return;
    }
    if (mlock(reinterpret_cast<const void*>(first), begin + bytes - first) == 0) {  // NOLINT
        ++parts.locked;
    } else {
        parts.error = parts.refused == 0 ? errno : parts.error;
        ++parts.refused;
    }
}

/// The program itself has no name there.
bool ticks_in(const char* library) noexcept {
    for (const char* name : {"/libc.so", "/libm.so", "/libstdc++.so", "/libgcc_s.so"}) {
        if (std::strstr(library, name) != nullptr) {
            return true;
        }
    }
    return library[0] == '\0';
}

int lock_library(dl_phdr_info* library, std::size_t /*size*/, void* parts) {
    for (int i = 0; ticks_in(library->dlpi_name) && i < library->dlpi_phnum; ++i) {
        const auto& part = library->dlpi_phdr[i];
        if (part.p_type == PT_LOAD && (part.p_flags & PF_R) != 0) {
            lock(*static_cast<LockedParts*>(parts), library->dlpi_addr + part.p_vaddr,
                 part.p_memsz);
        }
    }
    return 0;
}

void lock_heap(LockedParts& parts) noexcept {
    std::FILE* maps = std::fopen("/proc/self/maps", "re");
    std::array<char, 512> line{};
    while (maps != nullptr && std::fgets(line.data(), line.size(), maps) != nullptr) {
        std::uintptr_t begin = 0;
        std::uintptr_t end = 0;
        if (std::strstr(line.data(), "[heap]") != nullptr &&
            std::sscanf(line.data(), "%zx-%zx", &begin, &end) == 2) {
            lock(parts, begin, end - begin);
        }
    }
    if (maps != nullptr) {
        std::fclose(maps);
    }
}

/// Keeps in memory what a tick may touch, and nothing else: `own` parts, the code and data of the
/// program and of the C, C++ and mathematical libraries, and the heap as large as it is now. A
/// window's libraries and pictures, hundreds of MB, are left out: they would be read in whole, take
/// longer to free than a guard may wait for the end of a program, and no tick needs them.
RightGrant lock_memory(std::span<const MemoryPart> own) noexcept {
    LockedParts parts;
    for (const MemoryPart& part : own) {
        lock(parts, reinterpret_cast<std::uintptr_t>(part.begin), part.bytes);  // NOLINT
    }
    dl_iterate_phdr(lock_library, &parts);
    lock_heap(parts);
    return {.grant = parts.refused == 0 ? Grant::given
                   : parts.locked == 0  ? Grant::refused
                                        : Grant::partly,
            .error = parts.error};
}

constexpr std::size_t kStack = 256U << 10U;  ///< far above what a tick uses
constexpr int kSpared = -1000;               ///< oom_score_adj of what is never chosen

std::atomic<int> lockers{0};

RightGrant granted(bool success) noexcept {
    return success ? RightGrant{.grant = Grant::given}
                   : RightGrant{.grant = Grant::refused, .error = errno};
}

/// @return what it was; none: it cannot be written
std::optional<int> spare_from_the_killer(int score) noexcept {
    const int file = open("/proc/self/oom_score_adj", O_RDWR | O_CLOEXEC);
    if (file < 0) {
        return std::nullopt;
    }
    std::array<char, 16> text{};
    const ssize_t size = read(file, text.data(), text.size() - 1);
    const int before = size > 0 ? std::atoi(text.data()) : 0;
    const int length = std::snprintf(text.data(), text.size(), "%d", score);
    const bool written = write(file, text.data(), static_cast<std::size_t>(length)) == length;
    const int error = errno;
    close(file);
    errno = error;
    return written ? std::optional(before) : std::nullopt;
}

[[gnu::noinline]] void touch_stack(bool lock) noexcept {
    std::array<volatile char, kStack> stack;
    for (std::size_t i = 0; i < kStack; i += kPage) {
        stack[i] = 0;
    }
    if (lock) {  // it stays so when this frame is gone; the refusal of so little says nothing more
        static_cast<void>(mlock(const_cast<char*>(stack.data()), kStack));
    }
}

std::string refusal(Right right, const RightGrant& granted) {
    const bool limit = granted.error == ENOMEM || granted.error == EPERM || granted.error == EAGAIN;
    if (right == Right::fifo && limit) {
        return "SCHED_FIFO refused: this user may not use real-time priorities";
    }
    if (right == Right::memory && limit) {
        return "not locked: this user may lock less than the ticks touch";
    }
    return "refused: " + std::generic_category().message(granted.error);
}

}  // namespace

bool RealtimeRights::complete() const noexcept {
    return std::all_of(grants.begin(), grants.end(), [](const RightGrant& one) {
        return one.grant == Grant::given || one.grant == Grant::not_asked;
    });
}

ProgramRights::ProgramRights(const RealtimeWish& wish,
                             RealtimeRights& rights,
                             std::span<const MemoryPart> own) noexcept {
    if (wish.spared) {
        spared_before_ = spare_from_the_killer(kSpared);
        rights.of(Right::spared) = granted(spared_before_.has_value());
    }
    if (wish.memory) {
        RightGrant& memory = rights.of(Right::memory);
        memory = lock_memory(own);
        locked_ = memory.grant != Grant::refused;
        lockers.fetch_add(locked_ ? 1 : 0);
    }
    if (wish.latency) {
        constexpr std::int32_t kMicroseconds = 0;
        latency_file_ = Descriptor(open("/dev/cpu_dma_latency", O_WRONLY | O_CLOEXEC));
        const int file = latency_file_.get();
        rights.of(Right::latency) = granted(
            file >= 0 && write(file, &kMicroseconds, sizeof kMicroseconds) == sizeof kMicroseconds);
    }
}

ProgramRights::~ProgramRights() {
    if (locked_ && lockers.fetch_sub(1) == 1) {
        munlockall();
    }
    if (spared_before_) {
        static_cast<void>(spare_from_the_killer(*spared_before_));
    }
}

void ProgramRights::renew() const noexcept {
    if (locked_) {
        LockedParts heap;  // which may have grown; what was refused is in the rights already
        lock_heap(heap);
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
    touch_stack(wish.memory);
}

std::string_view name_of(Right right) noexcept {
    constexpr std::array<std::string_view, kRights> kWords{
        "scheduling", "memory", "processor sleep", "timer slack", "out of memory"};
    return kWords[static_cast<std::size_t>(right)];
}

std::string describe(Right right, const RealtimeRights& rights) {
    const RightGrant& granted = rights.of(right);
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
                     ? "locked in part: this user may lock less than the ticks touch"
                     : "locked, what the ticks touch";
        case Right::latency:
            return "held awake (/dev/cpu_dma_latency 0)";
        case Right::spared:
            return "spared by the kernel (oom_score_adj -1000)";
        case Right::slack:
            break;
    }
    return "1 ns";
}

std::string remedy(Right right, const RealtimeRights& rights) {
    const RightGrant& granted = rights.of(right);
    if (granted.grant != Grant::refused && granted.grant != Grant::partly) {
        return "";
    }
    switch (right) {
        case Right::fifo:
            return "as root, once: usermod -aG palpate USER, then USER logs in again (the Debian "
                   "package made the group and its limits; without it: groupadd palpate, and "
                   "\"@palpate - rtprio 90\" into /etc/security/limits.d/palpate.conf)";
        case Right::memory:
            return "USER in the group palpate, as for scheduling (without the Debian package: "
                   "\"@palpate - memlock unlimited\" into /etc/security/limits.d/palpate.conf)";
        case Right::latency:
            return granted.error == ENOENT
                     ? "this kernel has no power management to hold; nothing to do on a virtual "
                       "machine"
                     : "USER in the group palpate, as for scheduling (without the Debian package, "
                       "as root: KERNEL==\"cpu_dma_latency\", GROUP=\"palpate\", MODE=\"0660\" "
                       "into /etc/udev/rules.d/70-palpate.rules; udevadm control --reload; "
                       "udevadm trigger)";
        case Right::spared:
            return "as root, once: setcap cap_sys_resource=ep on the program file; without it, "
                   "close "
                   "what takes much memory before a session";
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

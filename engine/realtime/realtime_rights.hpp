#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <signal.h>

#include "engine/base/descriptor.hpp"

namespace palpate::engine {

/// A stretch of this program's memory.
struct MemoryPart {
    const void* begin = nullptr;
    std::size_t bytes = 0;
};

/// What a servo thread asks of the system to be woken in time.
struct RealtimeWish {
    bool fifo = true;     ///< SCHED_FIFO: before every ordinary program
    bool memory = true;   ///< what ticks touch is locked: no page fault in a tick
    bool latency = true;  ///< /dev/cpu_dma_latency held at 0: processors do not sleep deeply
    bool slack = true;    ///< timer slack 1 ns instead of 50 us
    bool spared = true;   ///< not chosen when the kernel runs out of memory
    int priority = 80;    ///< of SCHED_FIFO, 1 to 99

    /// For devices that give force.
    [[nodiscard]] static RealtimeWish everything() { return {}; }
    /// For a virtual clock.
    [[nodiscard]] static RealtimeWish nothing() {
        return {.fifo = false, .memory = false, .latency = false, .slack = false, .spared = false};
    }
    /// For devices that give no force: what costs nothing and can hurt nobody.
    [[nodiscard]] static RealtimeWish pointer() {
        return {.fifo = false, .memory = false, .latency = false, .spared = false};
    }
};

/// In the order of RealtimeRights::grants.
enum class Right : std::uint8_t { fifo, memory, latency, slack, spared };
inline constexpr std::size_t kRights = 5;

/// What the system made of a wish.
enum class Grant : std::uint8_t {
    not_asked,
    given,
    partly,   ///< memory: some of it
    refused,  ///< see RightGrant::error
};

/// A right, and why it was refused.
struct RightGrant {
    Grant grant = Grant::not_asked;
    int error = 0;  ///< errno of a refusal
};

/// What the system granted. A plain value.
struct RealtimeRights {
    std::array<RightGrant, kRights> grants{};
    int priority = 0;  ///< of SCHED_FIFO, where given

    /// What was granted of one right.
    [[nodiscard]] const RightGrant& of(Right right) const {
        return grants[static_cast<std::size_t>(right)];
    }
    [[nodiscard]] RightGrant& of(Right right) { return grants[static_cast<std::size_t>(right)]; }
    /// Everything that was asked for was given.
    [[nodiscard]] bool complete() const noexcept;
};

/// "scheduling", "memory", "processor sleep", "timer slack", "out of memory".
[[nodiscard]] std::string_view name_of(Right right) noexcept;
/// What came of it, for people: "SCHED_FIFO, priority 80", "refused: Operation not permitted".
[[nodiscard]] std::string describe(Right right, const RealtimeRights& rights);
/// What to do about a refusal, a sentence; empty when nothing was refused.
[[nodiscard]] std::string remedy(Right right, const RealtimeRights& rights);
/// One row a right, for the record of a session: {"realtime scheduling", "SCHED_FIFO, priority
/// 80"}.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> provenance(
    const RealtimeRights& rights);

/// The rights that belong to the whole program, memory, latency and to be spared, for as long as
/// this lives. Taken outside the servo thread.
class ProgramRights {
public:
    /// Writes what was granted into `rights`. @param own  what ticks touch beyond code and heap
    ProgramRights(const RealtimeWish& wish,
                  RealtimeRights& rights,
                  std::span<const MemoryPart> own = {}) noexcept;
    /// Gives them back; memory when the last of several lets go.
    ~ProgramRights();
    /// Between trials: locks what the heap has grown by.
    void renew() const noexcept;

private:
    bool locked_ = false;
    std::optional<int> spared_before_{};  ///< what oom_score_adj was
    Descriptor latency_file_{};           ///< closing it takes the request back
};

/// The rights of the calling thread, scheduling and slack, until it ends. Touches its stack as
/// well, so that no tick is the first to reach a page of it.
void take_thread_rights(const RealtimeWish& wish, RealtimeRights& rights) noexcept;

/// While this lives the calling thread, and every thread that it starts, gets no signal: those are
/// for the threads that were there before.
class AllSignalsBlocked {
public:
    AllSignalsBlocked() noexcept {
        sigset_t all;
        sigfillset(&all);
        pthread_sigmask(SIG_SETMASK, &all, &before_);
    }
    AllSignalsBlocked(const AllSignalsBlocked&) = delete;
    AllSignalsBlocked& operator=(const AllSignalsBlocked&) = delete;
    ~AllSignalsBlocked() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

private:
    sigset_t before_{};
};

}  // namespace palpate::engine

#pragma once

#include <atomic>
#include <cstdint>

#include <pthread.h>
#include <sys/types.h>

namespace palpate::engine {

/// How a guard process waits.
struct GuardTiming {
    int wait_ms = 5;     ///< between two looks at the driver
    int patience = 5;    ///< looks in a row at a driver that is silent with the force on
    int alive_ms = 100;  ///< a guard that has not looked for so long counts as hung
    bool apart = false;  ///< in a control group of its own, if it may: see set_apart()
};

/// What palpate and its guard both see.
struct GuardShared {
    std::atomic<std::uint64_t> beat{0};    ///< changes with every packet; odd: the force is on
    std::atomic<std::int64_t> seen_ns{0};  ///< when the guard last looked
    std::atomic<bool> tripped{false};
    std::atomic<bool> repeat{false};  ///< zero torque again and again
    /// Robust: held by the thread that gives force, for its whole life. Whatever ends the program,
    /// the kernel wakes who waits for it before it takes down the memory, which can take 0.3 s.
    pthread_mutex_t life{};
    std::atomic<bool> held{false};  ///< life is
};

/// The guard's life, in a process just forked. Only async-signal-safe calls; it never returns.
/// @param socket  to palpate, which sends GuardPackets, one datagram each, and beside it the port
///        as a descriptor   @param owner  palpate's process id
[[noreturn]] void guard_motors(int socket,
                               pid_t owner,
                               GuardShared& shared,
                               const GuardTiming& timing) noexcept;

}  // namespace palpate::engine

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "engine/device/drivers/guard_process.hpp"

namespace palpate::engine {

/// What palpate tells its guard, one datagram each; the port travels beside it as a descriptor.
struct GuardMessage {
    enum class What : std::uint8_t { watch, release } what = What::release;
    std::uint8_t zero_size = 0;
    std::uint8_t setup_size = 0;
    std::array<std::uint8_t, 64> zero{};
    std::array<std::uint8_t, 64> setup{};
};

/// The guard's life, in a process just forked. Only async-signal-safe calls; it never returns.
/// @param socket  to palpate; @param owner  palpate's process id
[[noreturn]] void guard_motors(int socket,
                               pid_t owner,
                               GuardProcess::Shared& shared,
                               const GuardTiming& timing) noexcept;

}  // namespace palpate::engine

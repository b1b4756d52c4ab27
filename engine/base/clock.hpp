#pragma once

#include <cstdint>
#include <ctime>

namespace palpate {

inline constexpr std::int64_t kMillisecond = 1'000'000;  ///< in ns
inline constexpr std::int64_t kSecond = 1'000'000'000;   ///< in ns

/// As the system takes times. @param ns  >= 0
[[nodiscard]] constexpr timespec timespec_of(std::int64_t ns) noexcept {
    return {.tv_sec = ns / kSecond, .tv_nsec = ns % kSecond};
}

/// CLOCK_MONOTONIC, the one clock of palpate, ns.
[[nodiscard]] std::int64_t monotonic_ns() noexcept;

/// Sleeps until that time of the same clock; returns at once if it has passed.
void sleep_until(std::int64_t time_ns) noexcept;

}  // namespace palpate

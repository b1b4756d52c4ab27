#pragma once

#include <cstdint>

namespace palpate {

inline constexpr std::int64_t kMillisecond = 1'000'000;  ///< in ns

/// CLOCK_MONOTONIC, the one clock of palpate, ns.
[[nodiscard]] std::int64_t monotonic_ns() noexcept;

/// Sleeps until that time of the same clock; returns at once if it has passed.
void sleep_until(std::int64_t time_ns) noexcept;

}  // namespace palpate

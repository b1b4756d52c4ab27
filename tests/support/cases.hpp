#pragma once

#include "tests/support/std.hpp"

namespace palpate::tests {

/// How many of `all` seeded cases are tried: a quarter under sanitizers, which look at memory,
/// where the next seed does what the last one did.
template <class Count>
[[nodiscard]] constexpr Count cases(Count all) {
#ifdef PALPATE_SANITIZED
    return (all + 3) / 4;
#else
    return all;
#endif
}

/// Seeds of fault schedules: 0 to `usual`, or as PALPATE_FAULT_SCHEDULES asks: "100000", or
/// "50000-100000" for those from 50,000 on.
[[nodiscard]] inline auto schedules(std::uint64_t usual) {
    std::uint64_t first = 0;
    std::uint64_t past = usual;
    if (const char* asked = std::getenv("PALPATE_FAULT_SCHEDULES")) {
        char* rest = nullptr;
        past = std::strtoull(asked, &rest, 10);
        if (*rest == '-') {
            first = std::exchange(past, std::strtoull(rest + 1, nullptr, 10));
        }
    }
    return std::views::iota(first, past);
}

}  // namespace palpate::tests

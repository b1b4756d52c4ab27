#include "engine/base/clock.hpp"

#include <ctime>

namespace palpate {

constexpr std::int64_t kSecond = 1'000'000'000;

std::int64_t monotonic_ns() noexcept {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    return static_cast<std::int64_t>(now.tv_sec) * kSecond + now.tv_nsec;
}

void sleep_until(std::int64_t time_ns) noexcept {
    if (time_ns <= 0) {  // long ago; a timespec has no negative nanoseconds
        return;
    }
    const timespec until{.tv_sec = time_ns / kSecond, .tv_nsec = time_ns % kSecond};
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) != 0) {
    }
}

}  // namespace palpate

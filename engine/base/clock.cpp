#include "engine/base/clock.hpp"

namespace palpate {

std::int64_t monotonic_ns() noexcept {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    return static_cast<std::int64_t>(now.tv_sec) * kSecond + now.tv_nsec;
}

void sleep_until(std::int64_t time_ns) noexcept {
    if (time_ns <= 0) {  // long ago; a timespec has no negative nanoseconds
        return;
    }
    const timespec until = timespec_of(time_ns);
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) != 0) {
    }
}

}  // namespace palpate

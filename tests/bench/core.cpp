#include "tests/bench/core.hpp"

#include <ctime>

#include <sched.h>
#include <sys/resource.h>

#include "tests/support/std.hpp"

namespace palpate::bench {
namespace {

/// Of the clocks that are read one after the other; a time slice is a hundred times as long.
constexpr std::int64_t kReading = 10'000;  // ns

std::int64_t ns_of(clockid_t clock) noexcept {
    timespec at{};
    clock_gettime(clock, &at);
    return at.tv_sec * std::int64_t{1'000'000'000} + at.tv_nsec;
}

}  // namespace

void pin_to(int cores) {
    cpu_set_t mine;
    CPU_ZERO(&mine);
    sched_getaffinity(0, sizeof mine, &mine);
    if (cores > CPU_COUNT(&mine)) {
        throw std::runtime_error(std::to_string(cores) + " cores are asked for, and there are " +
                                 std::to_string(CPU_COUNT(&mine)));
    }
    for (std::size_t core = 0; CPU_COUNT(&mine) > cores; ++core) {
        CPU_CLR(core, &mine);
    }
    sched_setaffinity(0, sizeof mine, &mine);
}

Watch::Watch() : stat_(open("/proc/stat", O_RDONLY | O_CLOEXEC)) {
    stolen_ = steal();
    begin();
}

Watch::~Watch() {
    close(stat_);
}

Watch::Now Watch::now() noexcept {
    rusage used{};
    getrusage(RUSAGE_THREAD, &used);
    const std::int64_t own = ns_of(CLOCK_THREAD_CPUTIME_ID);
    return {used.ru_nivcsw, ns_of(CLOCK_MONOTONIC) - own};
}

void Watch::begin() noexcept {
    begin_ = now();
}

bool Watch::ours() const noexcept {
    const Now end = now();
    return end.switches == begin_.switches && end.elsewhere_ns - begin_.elsewhere_ns < kReading;
}

bool Watch::stolen() noexcept {
    const long before = stolen_;
    stolen_ = steal();
    return stolen_ > before;
}

/// The eighth number of the line of this core; 0 where there is none.
long Watch::steal() const noexcept {
    std::array<char, 16384> text{};
    const ssize_t size = pread(stat_, text.data(), text.size() - 1, 0);
    std::array<char, 16> name{};
    std::snprintf(name.data(), name.size(), "cpu%d ", sched_getcpu());
    const char* line = size > 0 ? std::strstr(text.data(), name.data()) : nullptr;
    long value = 0;
    if (line != nullptr) {
        std::sscanf(line, "%*s %*d %*d %*d %*d %*d %*d %*d %ld", &value);
    }
    return value;
}

}  // namespace palpate::bench

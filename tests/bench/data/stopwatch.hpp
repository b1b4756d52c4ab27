#pragma once

#include <ctime>
#include <functional>
#include <string>

#include "tests/bench/timing.hpp"

namespace palpate::bench {

/// Seconds on so many cores: on one those of the processor, in which neither another program nor
/// the disk has a part; on several those of the wall clock.
struct Stopwatch {
    int cores = 1;

    [[nodiscard]] double now() const {
        timespec at{};
        clock_gettime(cores == 1 ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC, &at);
        return static_cast<double>(at.tv_sec) + 1e-9 * static_cast<double>(at.tv_nsec);
    }
    [[nodiscard]] double seconds(const std::function<void()>& work) const {
        const double start = now();
        work();
        return now() - start;
    }
};

/// A figure of `data`, a line of its table.
struct Figure {
    std::string name;
    std::string unit;
    Median value{};
};

}  // namespace palpate::bench

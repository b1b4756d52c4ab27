#pragma once

#include <ctime>
#include <functional>
#include <string>

#include "tests/bench/core.hpp"
#include "tests/bench/method.hpp"

namespace palpate::bench {

/// A median, and where it lies with a chance of 95 % or more whatever the distribution: between two
/// of the ordered values (of fewer than six, the first and the last).
struct Median {
    double value = 0.0;
    double low = 0.0;
    double high = 0.0;
};

[[nodiscard]] Median median(std::vector<double> values);
[[nodiscard]] double seconds_since(std::chrono::steady_clock::time_point start);
/// Value below which the share `share` of `values` lies; 0 for none.
[[nodiscard]] double percentile(std::vector<double> values, double share);

/// What one answer takes.
struct Timing {
    Median ratio{};             ///< to one Newton update, along the path
    double warm = 0.0;          ///< in a loop, ns
    double instructions = 0.0;  ///< 0: not counted
    double rounds = 0.0;
    double thrown = 0.0;  ///< of these, and in neither ratio nor warm: the core was not ours
    double p50 = 0.0;     ///< each tick by itself, from an idle pipeline, less the clock's, ns
    double p99 = 0.0;
    double p999 = 0.0;
    double cold_p50 = 0.0;  ///< after touching 16 MB: what a 1 kHz loop meets when it wakes
    double cold_p99 = 0.0;
};

struct TimingPlan {
    double warm_seconds =
        0.15;              ///< passes over the path are repeated until then; up to 8 times that
                           ///< if too much was thrown away
    int cold_ticks = 300;  ///< spread over the path; 0: none
};

/// Counts of the processor's clock (on x86-64 the time stamp counter, in order), or of
/// steady_clock.
class Clock {
public:
    Clock();  ///< measures its own rate and cost: takes 50 ms
    [[nodiscard]] static std::uint64_t now() noexcept;
    /// Between two readings, what two readings in a row take subtracted, ns; >= 0.
    [[nodiscard]] double between(std::uint64_t from, std::uint64_t to) const noexcept;
    [[nodiscard]] double cost() const noexcept { return cost_ * ns_; }

private:
    double ns_ = 1.0;    ///< of one count
    double cost_ = 0.0;  ///< counts
};

/// The core that measures, its clock, and the unit: one Newton update on a cubic, the same for all.
struct Stand {
    Clock clock{};
    Watch watch{};
    std::unique_ptr<Method<2>> unit;

    Stand();  ///< looks for an undisturbed moment: takes 0.3 s
    /// Whether work that fills a core takes longer now than at its fastest: a neighbour on the same
    /// core's other thread takes a third of the speed of methods, and nothing of the unit's, which
    /// waits for its own results. No system call says so where a hypervisor hides the threads.
    [[nodiscard]] bool shared();

private:
    double fastest_ = 1e300;  ///< ns
};

/// Passes over one path, each in rounds: a thousand units, then some ticks of the method.
struct Passes {
    /// [pass][round], a tick: over the unit, and ns. Not a number where the core was not ours
    /// alone.
    std::vector<std::vector<double>> ratio;
    std::vector<std::vector<double>> ns;

    [[nodiscard]] std::size_t rounds() const;
    [[nodiscard]] std::size_t thrown() const;
    /// Whether each round of the path was kept often enough for an interval.
    [[nodiscard]] bool enough() const;
};

/// How many rounds of some 50 us a pass has. Warms up.
template <int D>
[[nodiscard]] std::size_t rounds_of(Method<D>& method,
                                    std::span<const Vec<D>> path,
                                    const Clock& clock);

template <int D>
void pass(Passes& passes,
          Method<D>& method,
          std::span<const Vec<D>> path,
          std::size_t rounds,
          Stand& stand);

/// What was kept of a round.
[[nodiscard]] std::vector<double> round_of(const std::vector<std::vector<double>>& passes,
                                           std::size_t i);

/// The mean along the path of each round's median, and of the ends of its interval: a path has easy
/// places and hard ones, ten times as long, so that a median of all rounds would lie anywhere
/// between. A round that was never kept is left out. @param weights  of each round; none: equal
[[nodiscard]] Median along(const std::vector<std::vector<double>>& passes,
                           const std::vector<double>& weights = {});

template <int D>
[[nodiscard]] Timing time_of(Method<D>& method,
                             std::span<const Vec<D>> path,
                             const TimingPlan& plan,
                             Stand& stand);

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

#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tests/bench/method.hpp"

namespace palpate::bench {

/// Time of one answer, ns.
struct Timing {
    double warm = 0.0;  ///< median over chunks of 100 ticks in a loop: what the method costs
    double p50 =
        0.0;  ///< each tick by itself, from an idle pipeline, the clock's own time subtracted
    double p99 = 0.0;
    double p999 = 0.0;
    double cold_p50 = 0.0;  ///< after touching 16 MB: what a 1 kHz loop meets when it wakes
    double cold_p99 = 0.0;
};

struct TimingPlan {
    double warm_seconds = 0.15;  ///< passes over the path are repeated until then; at least one
    int cold_ticks = 300;        ///< spread over the path; 0: none
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

template <int D>
[[nodiscard]] Timing time_of(Method<D>& method,
                             std::span<const Vec<D>> path,
                             const TimingPlan& plan,
                             const Clock& clock);

/// Value below which the share `share` of `values` lies; 0 for none.
[[nodiscard]] double percentile(std::vector<double> values, double share);

}  // namespace palpate::bench

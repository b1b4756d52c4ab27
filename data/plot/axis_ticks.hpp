#pragma once

#include <string>
#include <vector>

namespace palpate::data {

/// The stretch of numbers an axis shows, low < high; on a log axis low > 0.
struct AxisRange {
    double low = 0.0;
    double high = 1.0;
    bool log = false;

    /// Place of `value` along the axis: 0 at low, 1 at high.
    [[nodiscard]] double share(double value) const;
    /// Can be drawn: finite, and above 0 on a log axis.
    [[nodiscard]] bool holds(double value) const;
};

/// A mark on an axis.
struct AxisTick {
    double at = 0.0;
    std::string label;  ///< empty for a minor tick
};

/// All marks of an axis, rising.
struct AxisTicks {
    std::vector<AxisTick> ticks;
    int exponent = 0;  ///< labels are values / 10^exponent; a multiple of 3
};

/// Ticks at 1, 2 or 5 times a power of ten, about `wanted` of them. A log axis has its decades
/// labelled (every n-th if there are many) and minor ticks at 2 to 9; within less than a decade its
/// ticks are those of a linear one.
[[nodiscard]] AxisTicks nice_ticks(const AxisRange& range, int wanted);

}  // namespace palpate::data

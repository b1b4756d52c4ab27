#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

namespace palpate::data {

/// Not a number, or infinite.
inline constexpr std::int32_t kNotANumber = std::numeric_limits<std::int32_t>::min();

/// `value` in steps of 1 / per_unit: floor(value * per_unit + 1/2), so halves go up; beyond 2^31 -
/// 1 steps the last one on that side, +-(2^31 - 1).
[[nodiscard]] inline std::int32_t in_steps(double value, double per_unit) noexcept {
    constexpr double kMax = std::numeric_limits<std::int32_t>::max();
    const double steps = value * per_unit + 0.5;
    if (!(steps > -kMax && steps < kMax)) {
        return !std::isfinite(value) ? kNotANumber
             : steps < 0.0           ? -std::numeric_limits<std::int32_t>::max()
                                     : std::numeric_limits<std::int32_t>::max();
    }
    const auto whole = static_cast<std::int32_t>(steps);  // towards zero
    return whole - (static_cast<double>(whole) > steps ? 1 : 0);
}

inline constexpr double kHipSteps = 1e7;       ///< per m: 0.1 um
inline constexpr double kCommandSteps = 1e4;   ///< per N: 0.1 mN
inline constexpr double kLatenessSteps = 1e3;  ///< per us: 1 ns

/// HIP of a whole number of its steps, m: the nearest double.
[[nodiscard]] inline double steps_in_metres(std::int64_t steps) noexcept {
    return static_cast<double>(steps) / kHipSteps;
}

/// The lateness that a tick has from whole ns, as the servo computes it.
[[nodiscard]] inline float lateness_us(std::int64_t ns) noexcept {
    return static_cast<float>(static_cast<double>(ns) * 1e-3);
}

}  // namespace palpate::data

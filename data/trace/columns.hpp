#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "engine/realtime/tick_record.hpp"

namespace palpate::data {

/// What a column of a tick says. A real may be NaN: there was no number.
using TickValue = std::variant<std::int64_t, double, std::string_view>;

/// One column of a servo tick, the same by name and meaning in `sample`, fault_tick, exports and
/// BIDS.
struct TraceColumn {
    std::string_view name;
    std::string_view type;  ///< integer, real, text
    std::string_view unit;
    std::string_view meaning;
    TickValue (*value)(const engine::TickRecord&);
    std::string_view memory;  ///< of the field: f64le, f32le, i64le, i32le, i16le, u8
    std::size_t size;         ///< bytes of the field
    std::size_t offset;       ///< of the field in TickRecord
};

/// Every field of a tick, each once, in the order in which tables have them.
[[nodiscard]] std::span<const TraceColumn> trace_columns() noexcept;

/// Seconds of a time in ns, the nearest double: what a decimal number with nine digits reads as.
[[nodiscard]] constexpr double seconds_of(std::int64_t ns) noexcept {
    return static_cast<double>(ns) / 1e9;
}

// -------------------------------------------------------------------------------------------------
// What of a tick is written into a chunk. The table trace_column of every database repeats this,
// so that the file explains itself.

/// The columns that every chunk holds, whole numbers that anyone can read, in their order in a
/// chunk.
enum class ColumnId : std::uint8_t {
    tick,
    time_ns,
    count_1,
    count_2,
    code_1,
    code_2,
    lateness_ns,
    flags,
    hip_x,
    hip_y,
    command_x,
    command_y,
    count_3,  ///< from here on of sessions in space; all 0 in the plane, which takes no bytes
    code_3,
    hip_z,
    command_z,
};
inline constexpr std::size_t kStoredColumns = 16;
/// With the exact ones.
inline constexpr std::size_t kAllColumns = 36;

/// How a value becomes the number that is written, in two's complement of the column's width. What
/// is taken away leaves is then folded (zigzag): 0, -1, 1, -2 become 0, 1, 2, 3.
enum class Rule : std::uint8_t {
    plain,  ///< as it is
    flip,   ///< XOR the value before; before the first it is 0
    after,  ///< minus one more than the value before; the first: minus the chunk's first_tick
    clock,  ///< minus tick * period_ns, then minus the value before; before the first it is 0
    line,   ///< minus twice the value before, plus the one before that; before the first they are 0
    exact,  ///< the bytes of a floating-point number, or those of `command` XOR those of `force`
};

/// Exact columns are in a chunk only where they do not follow from the others: a chunk names the
/// parts that it holds.
enum Part : std::uint8_t {
    /// HIP is not what the calibration makes of the counts; without one: no whole steps.
    part_hip = 1U << 0U,
    part_contact = 1U << 1U,   ///< the contact is not what the scene makes of HIP
    part_command = 1U << 2U,   ///< the safety chain changed the force
    part_lateness = 1U << 3U,  ///< no whole number of ns
};
inline constexpr std::uint8_t kAllParts = 15;

/// A column of a chunk, as table trace_column describes it.
struct StoredColumn {
    std::string_view name;
    std::string_view type;  ///< i64le, i32le, i16le, u8, u64le, f64le, f32le
    std::string_view unit;
    double scale;  ///< value * scale is in `unit`
    Rule rule;
    std::uint8_t part;   ///< 0: in every chunk
    std::size_t size;    ///< bytes of a value
    std::size_t offset;  ///< exact: of the value in TickRecord
};

/// The sixteen of `ColumnId`, then the exact ones.
[[nodiscard]] std::span<const StoredColumn> stored_columns() noexcept;
[[nodiscard]] std::string_view to_string(Rule rule) noexcept;

/// "hip contact": the parts as a chunk's row names them.
[[nodiscard]] std::string_view part_name(std::uint8_t part) noexcept;

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

/// The virtual table `sample` as SQL, its columns with their comments: trial_id and interval, those
/// of trace_columns(), and three of velocity.
[[nodiscard]] std::string sample_declaration();

}  // namespace palpate::data

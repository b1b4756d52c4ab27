#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

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

/// Bytes of one tick over all columns.
[[nodiscard]] std::size_t bytes_per_tick() noexcept;

/// Columns one after the other, bytes shuffled within each: what a content hash is made of.
[[nodiscard]] std::vector<std::byte> shuffled_columns(std::span<const engine::TickRecord> ticks);

}  // namespace palpate::data

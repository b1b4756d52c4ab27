#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "engine/realtime/tick_record.hpp"

namespace palpate::data {

/// One field of a tick, as fault_tick and exported ticks have it.
struct TraceColumn {
    std::string_view name;
    std::string_view type;  ///< f64le, f32le, i64le, i32le, i16le, u8
    std::string_view unit;
    std::size_t size;    ///< bytes of a value
    std::size_t offset;  ///< of the value in TickRecord
    std::string_view meaning;
};

[[nodiscard]] std::span<const TraceColumn> trace_columns() noexcept;

/// Bytes of one tick over all columns.
[[nodiscard]] std::size_t bytes_per_tick() noexcept;

/// Columns one after the other, bytes shuffled within each: what a content hash is made of.
[[nodiscard]] std::vector<std::byte> shuffled_columns(std::span<const engine::TickRecord> ticks);

}  // namespace palpate::data

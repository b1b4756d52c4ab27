#pragma once

#include <cstddef>
#include <span>
#include <string_view>

namespace palpate::data {

/// One column of a trace chunk: codec 1 writes them in this order. The table trace_column of every
/// database repeats this, so that the file explains itself.
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

}  // namespace palpate::data

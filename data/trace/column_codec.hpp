#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/realtime/tick_record.hpp"
#include "data/trace/columns.hpp"

/// From the values of one column of a chunk to its stream (chunk.hpp), and back.
namespace palpate::data {

/// Where a chunk begins, and how fast its clock ticks: what the rules `after` and `clock` take
/// away.
struct ChunkClock {
    std::int64_t first_tick = 0;
    std::int64_t period_ns = 0;
};

/// What a column of every chunk says of these ticks. @param values  as many as `ticks`
void stored_values(ColumnId column,
                   std::span<const engine::TickRecord> ticks,
                   std::span<std::int64_t> values) noexcept;

/// Adds the stream of a column of every chunk to `data`; nothing if all its numbers are 0.
void pack_column(ColumnId column,
                 std::span<const engine::TickRecord> ticks,
                 const ChunkClock& clock,
                 std::vector<std::byte>& data);

/// Adds the stream of an exact column to `data`; nothing if all its bytes are 0.
/// @throws std::bad_alloc
void pack_exact(const StoredColumn& column,
                std::span<const engine::TickRecord> ticks,
                std::vector<std::byte>& data);

/// The values of a stream. Of `time_ns` without tick * period_ns.
/// @return false if it does not hold so many
[[nodiscard]] bool unpack_column(ColumnId column,
                                 std::span<const std::byte> stream,
                                 std::int64_t first_tick,
                                 std::span<std::int64_t> values) noexcept;
/// The same of a column of no more than 4 bytes.
[[nodiscard]] bool unpack_column(ColumnId column,
                                 std::span<const std::byte> stream,
                                 std::int64_t first_tick,
                                 std::span<std::int32_t> values) noexcept;

/// An exact column on its way: its bytes, shuffled.
class ExactColumn {
public:
    /// @param stream  empty: all bytes are 0
    ExactColumn(const StoredColumn& column, std::span<const std::byte> stream, std::size_t ticks);

    /// The stream is one of so many values.
    [[nodiscard]] bool holds() const noexcept { return holds_; }
    /// Into the column's field of each tick. @param ticks  as many as above
    void into(std::span<engine::TickRecord> ticks) const noexcept;

private:
    const StoredColumn* column_;
    std::vector<std::byte> bytes_;
    bool holds_ = true;
};

}  // namespace palpate::data

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "engine/realtime/tick_record.hpp"
#include "data/trace/column_codec.hpp"
#include "data/trace/columns.hpp"

/// Codec 1. A chunk's data are the sizes of its columns' streams, u32le each, in the order of
/// stored_columns() without the parts that it does not hold, and then the streams. A size of 0 says
/// that all numbers are 0. The stream of a column of whole numbers are blocks of 32 of them (the
/// last may have fewer): a byte that says how many bits the largest needs, then the numbers in so
/// many bits each, the lowest bit first, up to a whole byte. The stream of an exact column is a
/// zlib stream of its values, bytes shuffled: the first byte of every value, then the second, ...
namespace palpate::data {

/// A stored chunk is not what was written: says which check failed.
class TraceError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

inline constexpr std::int64_t kTraceCodec = 1;
/// Ticks of a full chunk: two seconds at 1 kHz.
inline constexpr std::size_t kChunkTicks = 2048;

/// A row of trace_chunk. Owns nothing: `data` must outlive it.
struct ChunkView {
    std::int64_t interval = 1;
    std::int64_t first_tick = 0;
    std::size_t ticks = 0;
    std::int64_t codec = kTraceCodec;
    std::int64_t period_ns = 0;
    std::uint8_t parts = 0;  ///< Part bits
    std::uint32_t crc32 = 0;
    std::uint64_t derived = 0;
    std::span<const std::byte> data{};
};

/// The bytes of a chunk as trace_chunk keeps them.
struct EncodedChunk {
    std::vector<std::byte> data;
    std::uint32_t crc32 = 0;  ///< of `data`
};

/// @param parts  the exact columns to write as well
/// @throws TraceError unless 1 <= ticks.size() <= kChunkTicks
[[nodiscard]] EncodedChunk encode_chunk(std::span<const engine::TickRecord> ticks,
                                        std::int64_t first_tick,
                                        std::int64_t period_ns,
                                        std::uint8_t parts);

/// Reads columns of one chunk, each when it is asked for. The checksum is looked at once: no
/// damaged bit is decoded.
class ChunkReader {
public:
    /// @throws TraceError if the chunk is damaged or of another codec
    explicit ChunkReader(const ChunkView& chunk);

    /// Values of a column of every chunk, into `values` of the chunk's ticks. @throws TraceError
    void read(ColumnId column, std::span<std::int64_t> values) const;
    /// The same of a column of no more than 4 bytes.
    void read(ColumnId column, std::span<std::int32_t> values) const;
    /// All values of a column of every chunk are 0.
    [[nodiscard]] bool all_zero(ColumnId column) const noexcept {
        return streams_[static_cast<std::size_t>(column)].empty();
    }
    /// All exact columns that the chunk holds, into the ticks. `command` becomes bits XOR those of
    /// force.
    void read_exact(std::span<engine::TickRecord> ticks) const;
    /// The same columns, to be put into ticks later. @throws TraceError
    [[nodiscard]] std::vector<ExactColumn> exact() const;

    /// Whose columns are read; its bytes outlive this.
    [[nodiscard]] const ChunkView& chunk() const noexcept { return chunk_; }

private:
    ChunkView chunk_;
    std::array<std::span<const std::byte>, kAllColumns> streams_{};  ///< of those not held empty
};

/// A checksum as files hold it. @throws TraceError unless it has 32 bits
[[nodiscard]] std::uint32_t crc32_of(std::int64_t stored);

/// "hip contact" <-> bits. @throws TraceError for other words
[[nodiscard]] std::string parts_text(std::uint8_t parts);
[[nodiscard]] std::uint8_t parts_of(std::string_view text);

/// XXH3 (64 bits, seed 0, xxHash 0.8) over the ticks as the servo recorded them, 208 bytes a tick
/// as TickRecord lies in memory, little endian, without gaps:
///
///     tick, time_ns (i64); hip, cp, go, force, command (x, y, z), normal_force, tangential_force,
///     mu, u, v (f64); counts (3), codes (3) (i32); lateness_us (f32); segment (i16); mode, flags
///     (u8)
///
/// A chunk holds only some of that. A reading that gives another hash is not what the servo had.
[[nodiscard]] std::uint64_t derived_hash(std::span<const engine::TickRecord> ticks) noexcept;

/// The same, some ticks at a time.
class DerivedHash {
public:
    /// Of no tick yet; value() may be asked for at any time, and add() go on after it.
    DerivedHash() noexcept;
    void add(std::span<const engine::TickRecord> ticks) noexcept;
    [[nodiscard]] std::uint64_t value() const noexcept;

private:
    alignas(64) std::array<std::byte, 576> state_;  ///< an XXH3_state_t
};

}  // namespace palpate::data

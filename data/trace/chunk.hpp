#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "engine/realtime/tick_record.hpp"
#include "data/trace/stored_columns.hpp"

/// Codec 1. A chunk's data are the sizes of its columns' streams, u32le each, in the order of
/// stored_columns() without the parts that it does not hold, and then the streams. A stream is a zlib
/// stream of the column's values, bytes shuffled: the first byte of every value, then the second, ... A
/// size of 0 says that all bytes are 0.
namespace palpate::data {

/// A stored chunk is not what was written: says which check failed.
class TraceError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

inline constexpr std::int64_t kTraceCodec = 1;
/// Ticks of a full chunk: four seconds at 1 kHz.
inline constexpr std::size_t kChunkTicks = 4096;

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

/// What a column of every chunk says of a tick.
[[nodiscard]] std::int64_t stored_value(Stored column, const engine::TickRecord& tick) noexcept;

/// Reads columns of one chunk, each when it is asked for. The checksum is looked at once: no damaged bit
/// is decoded.
class ChunkReader {
public:
    /// @throws TraceError if the chunk is damaged or of another codec
    explicit ChunkReader(const ChunkView& chunk);

    /// Values of a column of every chunk, into `values` of the chunk's ticks. @throws TraceError
    void read(Stored column, std::span<std::int64_t> values);
    /// All exact columns that the chunk holds, into the ticks. `command` becomes bits XOR those of force.
    void read_exact(std::span<engine::TickRecord> ticks);

    [[nodiscard]] const ChunkView& chunk() const noexcept { return chunk_; }

private:
    [[nodiscard]] std::span<const std::byte> unpack(std::size_t column);

    ChunkView chunk_;
    std::vector<std::span<const std::byte>> streams_;  ///< by column; of those not held empty
    std::vector<std::byte> bytes_;                     ///< a column as unpacked
};

/// "hip contact" <-> bits. @throws TraceError for other words
[[nodiscard]] std::string parts_text(std::uint8_t parts);
[[nodiscard]] std::uint8_t parts_of(std::string_view text);

}  // namespace palpate::data

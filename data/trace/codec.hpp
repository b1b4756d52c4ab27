#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <vector>

#include "engine/realtime/tick_record.hpp"

namespace palpate::data {

/// A stored chunk is not what was written: says which check failed.
class TraceError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

inline constexpr std::int64_t kTraceCodec = 1;
/// Ticks of a full chunk: a quarter of a second at 1 kHz.
inline constexpr std::size_t kChunkTicks = 256;

struct EncodedChunk {
    std::vector<std::byte> data;  ///< one zlib stream
    std::uint32_t crc32 = 0;      ///< of the bytes before zlib
};

/// Columns one after the other, bytes shuffled within each, deflated at level 1. Exact to the bit.
/// @pre 1 <= ticks.size() <= kChunkTicks
[[nodiscard]] EncodedChunk encode(std::span<const engine::TickRecord> ticks);

/// The ticks again. Any flipped bit, missing or extra byte is reported, never decoded.
/// @param ticks  how many the chunk must hold, 1 to kChunkTicks
/// @throws TraceError
[[nodiscard]] std::vector<engine::TickRecord> decode(std::span<const std::byte> data,
                                                     std::size_t ticks,
                                                     std::uint32_t crc32);

/// The bytes that encode() deflates: what a content hash is made of, whatever zlib's version.
[[nodiscard]] std::vector<std::byte> shuffled_columns(std::span<const engine::TickRecord> ticks);

}  // namespace palpate::data

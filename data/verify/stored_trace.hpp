#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/realtime/tick_record.hpp"
#include "data/store/database.hpp"
#include "data/verify/findings.hpp"

namespace palpate::data {

/// The ticks of a trial up to the first chunk that is not what was written.
struct StoredTrace {
    std::vector<engine::TickRecord> ticks;
    bool whole = true;  ///< nothing is damaged or missing in between
};

/// Reads and checks every chunk: codec, zlib stream, bits that zlib leaves unused, crc32, counts, order.
[[nodiscard]] StoredTrace load_trace(Database& database, std::int64_t trial, Findings& findings);

/// Bits between the end of a zlib stream's last block and its checksum: never read, and written as 0.
/// @return false if one is set, or there is no end
[[nodiscard]] bool unused_bits_are_zero(std::span<const std::byte> stream, std::size_t raw_bytes);

}  // namespace palpate::data

#pragma once

#include <cstdint>
#include <string>

#include "protocols/protocol/protocol.hpp"

namespace palpate::data {

/// Bytes that `trials` of a protocol can take at most: every one until its time-out, 40 bytes a tick, and
/// 16 MB for the log and all else. Measured: 5 to 12 bytes a tick where a replay gives the rest; 40 leaves
/// room for a device without encoders, and for the log beside the file, which holds a part of it twice.
[[nodiscard]] std::int64_t bytes_needed(const protocols::Protocol& protocol, std::size_t trials);

/// What the file's disk can still take of ours, bytes.
/// @throws StoreError if it cannot be told
[[nodiscard]] std::int64_t bytes_free(const std::string& file);

/// @throws StoreError with a sentence if the disk has less room than `trials` need
void require_space(const std::string& file,
                   const protocols::Protocol& protocol,
                   std::size_t trials);

}  // namespace palpate::data

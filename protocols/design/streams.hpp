#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "protocols/design/pcg32.hpp"

namespace palpate::protocols {

/// What a stream of random numbers is for. Two keys that differ anywhere give independent streams, so
/// that asking for more catch trials never changes the order of the pictures.
struct StreamKey {
    std::string protocol_hash;  ///< protocol_hash(protocol)
    std::string participant;
    std::size_t session = 1;  ///< 0: the same for all sessions of the participant
    std::size_t block = 0;    ///< e.g. the position of a trial
    std::string purpose;      ///< order.practice, order.main, catch, pictures, hand, observer
    std::uint64_t seed = 0;   ///< the recorded study seed
};

/// The text that is hashed: one `name=value` a line. Texts carry their length in bytes, so that no
/// participant's name can pass for another key.
[[nodiscard]] std::string canonical_text(const StreamKey& key);

/// The stream of `key`: bytes 0-7 of SHA-256(canonical text), big-endian, are the generator's
/// initstate and bytes 8-15 its initseq.
[[nodiscard]] Pcg32 stream(const StreamKey& key);

}  // namespace palpate::protocols

#include "protocols/design/streams.hpp"

#include <charconv>
#include <span>

#include <fmt/format.h>

#include "engine/base/sha256.hpp"

namespace palpate::protocols {
namespace {

std::uint64_t big_endian(std::span<const std::uint8_t, 8> bytes) {
    std::uint64_t word = 0;
    for (const std::uint8_t byte : bytes) {
        word = (word << 8U) | byte;
    }
    return word;
}

}  // namespace

std::string canonical_text(const StreamKey& key) {
    const std::string open = fmt::format(
        "palpate-stream-v1\nprotocol={}:{}\nparticipant={}:{}\nsession={}\nblock={}\n"
        "purpose={}:{}\nseed={}\n",
        key.protocol_hash.size(), key.protocol_hash, key.participant.size(), key.participant,
        key.session, key.block, key.purpose.size(), key.purpose, key.seed);
    return key.secret.empty() ? open
                              : open + fmt::format("secret={}:{}\n", key.secret.size(), key.secret);
}

std::string stream_origin(const StreamKey& key) {
    return sha256_hex(canonical_text(key)).substr(0, 32);
}

Pcg32 stream_from(std::string_view origin) {
    const auto word = [origin](std::size_t at) {
        std::uint64_t value = 0;
        std::from_chars(origin.data() + at, origin.data() + at + 16, value, 16);
        return value;
    };
    return {word(0), word(16)};
}

Pcg32 stream(const StreamKey& key) {
    const Sha256 digest = sha256(canonical_text(key));
    const std::span<const std::uint8_t, 32> bytes(digest);
    return {big_endian(bytes.subspan<0, 8>()), big_endian(bytes.subspan<8, 8>())};
}

Pcg32 stream(StreamKey key, std::string_view purpose, std::size_t block) {
    key.purpose = purpose;
    key.block = block;
    return stream(key);
}

}  // namespace palpate::protocols

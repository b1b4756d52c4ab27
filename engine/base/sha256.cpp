#include "engine/base/sha256.hpp"

#include <sodium.h>

namespace palpate {
namespace {

static_assert(std::tuple_size_v<Sha256> == crypto_hash_sha256_BYTES);

Sha256 digest_of(const unsigned char* data, std::size_t size) {
    // libsodium's plain hashes keep no state and need no sodium_init().
    Sha256 digest{};
    crypto_hash_sha256(digest.data(), data, size);
    return digest;
}

std::string hex(const Sha256& digest) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string text;
    text.reserve(2 * digest.size());
    for (const std::uint8_t byte : digest) {
        text += kDigits[byte >> 4U];
        text += kDigits[byte & 15U];
    }
    return text;
}

}  // namespace

Sha256 sha256(std::span<const std::byte> bytes) {
    return digest_of(reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
}

Sha256 sha256(std::string_view text) {
    return sha256(std::as_bytes(std::span(text.data(), text.size())));
}

std::string sha256_hex(std::span<const std::byte> bytes) {
    return hex(sha256(bytes));
}

std::string sha256_hex(std::string_view text) {
    return hex(sha256(text));
}

}  // namespace palpate

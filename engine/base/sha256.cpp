#include "engine/base/sha256.hpp"

#include <nettle/sha2.h>

namespace palpate {
namespace {

Sha256 digest_of(const std::uint8_t* data, std::size_t size) {
    sha256_ctx context;
    sha256_init(&context);
    sha256_update(&context, size, data);
    Sha256 digest{};
    sha256_digest(&context, digest.size(), digest.data());
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
    return digest_of(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
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

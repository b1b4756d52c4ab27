#include "engine/base/sha256.hpp"

#include <fmt/format.h>
#include <nettle/sha2.h>

namespace palpate {

Sha256 sha256(std::span<const std::byte> bytes) {
    sha256_ctx context;
    sha256_init(&context);
    sha256_update(&context, bytes.size(), reinterpret_cast<const std::uint8_t*>(bytes.data()));
    Sha256 digest{};
    sha256_digest(&context, digest.size(), digest.data());
    return digest;
}

Sha256 sha256(std::string_view text) {
    return sha256(std::as_bytes(std::span(text)));
}

std::string sha256_hex(std::span<const std::byte> bytes) {
    return fmt::format("{:02x}", fmt::join(sha256(bytes), ""));
}

std::string sha256_hex(std::string_view text) {
    return sha256_hex(std::as_bytes(std::span(text)));
}

}  // namespace palpate

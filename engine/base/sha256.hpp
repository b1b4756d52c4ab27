#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

/// SHA-256 (FIPS 180-4): names of protocols, plans and random streams that nobody can mistake.
namespace palpate {

/// The 32 bytes of a hash, the first one first.
using Sha256 = std::array<std::uint8_t, 32>;

/// The hash of these bytes, or of the bytes of a text (FIPS 180-4, by nettle).
[[nodiscard]] Sha256 sha256(std::span<const std::byte> bytes);
[[nodiscard]] Sha256 sha256(std::string_view text);

/// 64 lower-case hexadecimal digits.
[[nodiscard]] std::string sha256_hex(std::span<const std::byte> bytes);
[[nodiscard]] std::string sha256_hex(std::string_view text);

}  // namespace palpate

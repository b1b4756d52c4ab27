#include "data/store/uuid.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <stdexcept>

#include <fmt/format.h>
#include <sys/random.h>

#include "engine/base/refuse.hpp"
#include "engine/base/sha256.hpp"

namespace palpate::data {
namespace {

using Bytes = std::array<std::uint8_t, 16>;

/// RFC 9562, 4.1 and 4.2: the version in the high half of byte 6, the variant 10 on top of byte 8.
std::string uuid_of(Bytes bytes, unsigned version) {
    bytes[6] = static_cast<std::uint8_t>((bytes[6] & 0x0FU) | version << 4U);
    bytes[8] = static_cast<std::uint8_t>((bytes[8] & 0x3FU) | 0x80U);
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        text += i == 4 || i == 6 || i == 8 || i == 10 ? "-" : "";
        text += fmt::format("{:02x}", bytes[i]);
    }
    return text;
}

Bytes random_bytes() {
    Bytes bytes{};
    refuse_if<std::runtime_error>(getentropy(bytes.data(), bytes.size()) != 0,
                                  "the kernel gives no random numbers, which palpate asks it for");
    return bytes;
}

}  // namespace

std::string random_uuid() {
    return uuid_of(random_bytes(), 4);
}

std::string content_uuid(std::string_view text) {
    const Sha256 digest = sha256(text);
    Bytes bytes{};
    std::copy_n(digest.begin(), bytes.size(), bytes.begin());
    return uuid_of(bytes, 8);
}

std::string random_secret() {
    return fmt::format("{:02x}", fmt::join(random_bytes(), ""));
}

}  // namespace palpate::data

#pragma once

#include <string>
#include <string_view>

/// Names that no two sessions share, wherever they were recorded: RFC 9562, 36 characters, lower
/// case.
namespace palpate::data {

/// Random, version 4. From the kernel's generator: never the same twice.
[[nodiscard]] std::string random_uuid();

/// Of a content, version 8: the first 16 bytes of SHA-256(text) but for six bits. The same text,
/// the same name.
[[nodiscard]] std::string content_uuid(std::string_view text);

/// 128 bits from the kernel as 32 hexadecimal digits: the secret of a new file.
[[nodiscard]] std::string random_secret();

}  // namespace palpate::data

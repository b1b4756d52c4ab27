#pragma once

#include <cstddef>
#include <string_view>

namespace palpate::data {

/// Bytes of the UTF-8 character at the start of `text` (RFC 3629: no overlong form, no surrogate, nothing
/// beyond U+10FFFF); 0 if there is none.
[[nodiscard]] std::size_t utf8_length(std::string_view text) noexcept;

/// Whether all of it is UTF-8.
[[nodiscard]] bool is_utf8(std::string_view text) noexcept;

}  // namespace palpate::data

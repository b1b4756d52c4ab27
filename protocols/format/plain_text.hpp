#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

/// Text from outside on its way to a terminal. Names, notes and files can hold anything, and a terminal takes
/// some characters for orders: to hide lines, to retitle a window, to write from right to left.
namespace palpate::protocols {

/// The UTF-8 character at the start of a text.
struct Character {
    char32_t code = 0;
    std::size_t length = 0;  ///< bytes; 0: there is none
};
[[nodiscard]] Character first_character(std::string_view text) noexcept;

/// Bytes of the UTF-8 character at the start of `text` (RFC 3629: no overlong form, no surrogate, nothing
/// beyond U+10FFFF); 0 if there is none.
[[nodiscard]] std::size_t utf8_length(std::string_view text) noexcept;

/// Whether all of it is UTF-8.
[[nodiscard]] bool is_utf8(std::string_view text) noexcept;

/// Not shown but done: control characters (C0, DEL, C1), ends of lines and paragraphs, marks that change the
/// direction of writing, tags.
[[nodiscard]] bool is_order(char32_t code) noexcept;

enum class Lines : std::uint8_t {
    joined,  ///< a value: tabs and ends of lines become spaces
    kept     ///< what was laid out already
};

/// What a terminal only shows: orders and bytes that are no UTF-8 are spelled, as \x1b or \u{202e}.
[[nodiscard]] std::string plain(std::string_view text, Lines lines = Lines::joined);

}  // namespace palpate::protocols

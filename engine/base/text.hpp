#pragma once

#include <array>
#include <charconv>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>

/// Words, numbers and characters for people. Text from outside, on its way to a terminal, is
/// written plainly: names, notes and files can hold anything, and a terminal takes some characters
/// for orders: to hide lines, to retitle a window, to write from right to left.
namespace palpate {

/// A value as it stands in a message: nine digits, "nan" and "inf" included.
[[nodiscard]] inline std::string number_text(double value) {
    std::array<char, 32> text{};
    const int length = std::snprintf(text.data(), text.size(), "%.9g", value);
    return {text.data(), static_cast<std::size_t>(length)};
}

/// Refuses a value. @throws std::invalid_argument "`what` is `value`: `remedy`" unless `ok`
void require(bool ok, const char* what, double value, const char* remedy);

/// Refuses a value outside of a range; NaN is in none.
/// @throws std::invalid_argument "`what` is `value`: give `lowest` to `highest`"
void require_range(double value, double lowest, double highest, const std::string& what);

/// "1 trial", "2 trials", "0 trials": how many of something, for sentences.
/// @param many  where "s" alone does not make more of it: "1 of them is", "2 of them are"
[[nodiscard]] std::string counted(std::integral auto n,
                                  std::string_view one,
                                  std::string_view many = {}) {
    std::string text = std::to_string(n) + ' ';
    text += n == 1 || many.empty() ? one : many;
    return n == 1 || !many.empty() ? text : text + 's';
}

/// Without what begins and ends it of these characters.
[[nodiscard]] std::string_view trimmed(std::string_view text, std::string_view of) noexcept;

/// The UTF-8 character at the start of a text.
struct Character {
    char32_t code = 0;
    std::size_t length = 0;  ///< bytes; 0: there is none
};
/// The first character of `text`.
[[nodiscard]] Character first_character(std::string_view text) noexcept;

/// Bytes of the UTF-8 character at the start of `text` (RFC 3629: no overlong form, no surrogate,
/// nothing beyond U+10FFFF); 0 if there is none.
[[nodiscard]] std::size_t utf8_length(std::string_view text) noexcept;

/// Whether all of it is UTF-8.
[[nodiscard]] bool is_utf8(std::string_view text) noexcept;

/// Not shown but done: control characters (C0, DEL, C1), ends of lines and paragraphs, marks that
/// change the direction of writing, tags.
[[nodiscard]] bool is_order(char32_t code) noexcept;

/// What becomes of tabs and ends of lines.
enum class Lines : std::uint8_t {
    joined,  ///< a value: tabs and ends of lines become spaces
    kept     ///< what was laid out already
};

/// What a terminal only shows: orders and bytes that are no UTF-8 are spelled, as \x1b or \u{202e}.
[[nodiscard]] std::string plain(std::string_view text, Lines lines = Lines::joined);

/// ": did you mean ...?" for the nearest of `known`, upper or lower case alike, or `otherwise` if
/// none is near: a key may be deleted, of a value what may stand there is said.
[[nodiscard]] std::string suggestion(std::string_view unknown,
                                     std::span<const std::string_view> known,
                                     std::string_view otherwise = ": delete it");

/// The same for words that are made while the program runs.
[[nodiscard]] std::string suggestion(std::string_view unknown,
                                     std::span<const std::string> known,
                                     std::string_view otherwise);

/// Between two `mark`s, each `mark` of its own twice: as SQL and CSV take whatever a text holds.
[[nodiscard]] inline std::string in_quotes(std::string_view text, char mark = '"') {
    std::string out(1, mark);
    for (const char c : text) {
        out.append(c == mark ? 2 : 1, c);
    }
    return out + mark;
}

/// The number that a text is as a whole; none for another text, a sign +, or one out of range.
template <class Number>
[[nodiscard]] std::optional<Number> parsed(std::string_view text) {
    Number value{};
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value);
    return error == std::errc{} && stop == end ? std::optional(value) : std::nullopt;
}

}  // namespace palpate

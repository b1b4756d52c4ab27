#pragma once

#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>

namespace palpate {

/// The number that a text is as a whole; none for another text, a sign +, or one out of range.
template <class Number>
[[nodiscard]] std::optional<Number> parsed(std::string_view text) {
    Number value{};
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value);
    return error == std::errc{} && stop == end ? std::optional(value) : std::nullopt;
}

}  // namespace palpate

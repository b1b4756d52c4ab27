#include "protocols/format/plain_text.hpp"

#include <fmt/format.h>

namespace palpate::protocols {

std::size_t utf8_length(std::string_view text) noexcept {
    const auto byte = [text](std::size_t i) {
        return i < text.size() ? static_cast<unsigned>(static_cast<unsigned char>(text[i])) : 0U;
    };
    const unsigned first = byte(0);
    const std::size_t length = text.empty()                     ? 0
                             : first < 0x80U                    ? 1
                             : first >= 0xC2U && first < 0xE0U  ? 2
                             : first >= 0xE0U && first < 0xF0U  ? 3
                             : first >= 0xF0U && first <= 0xF4U ? 4
                                                                : 0;
    for (std::size_t i = 1; i < length; ++i) {
        if ((byte(i) & 0xC0U) != 0x80U) {
            return 0;
        }
    }
    const bool overlong =
        (first == 0xE0U && byte(1) < 0xA0U) || (first == 0xF0U && byte(1) < 0x90U);
    const bool beyond =
        (first == 0xEDU && byte(1) >= 0xA0U) || (first == 0xF4U && byte(1) >= 0x90U);
    return overlong || beyond ? 0 : length;
}

bool is_utf8(std::string_view text) noexcept {
    while (!text.empty()) {
        const std::size_t length = utf8_length(text);
        if (length == 0) {
            return false;
        }
        text.remove_prefix(length);
    }
    return true;
}

Character first_character(std::string_view text) noexcept {
    const std::size_t length = utf8_length(text);
    const auto byte = [text](std::size_t i) {
        return static_cast<char32_t>(static_cast<unsigned char>(text[i]));
    };
    constexpr char32_t kLead[] = {0, 0x7F, 0x1F, 0x0F, 0x07};
    char32_t code = length == 0 ? 0 : byte(0) & kLead[length];
    for (std::size_t i = 1; i < length; ++i) {
        code = (code << 6U) | (byte(i) & 0x3FU);
    }
    return {code, length};
}

bool is_order(char32_t code) noexcept {
    const auto among = [code](char32_t first, char32_t last) {
        return first <= code && code <= last;
    };
    return among(0x00, 0x1F) || among(0x7F, 0x9F) || code == 0x061C || among(0x200E, 0x200F) ||
           among(0x2028, 0x202E) || among(0x2066, 0x2069) || code == 0xFEFF ||
           among(0xFFF9, 0xFFFB) || among(0xE0000, 0xE007F);
}

std::string plain(std::string_view text, Lines lines) {
    std::string out;
    out.reserve(text.size());
    while (!text.empty()) {
        const auto [code, length] = first_character(text);
        const bool blank = code == U'\n' || code == U'\t';
        if (length == 0 || (code < 0x80 && is_order(code) && !blank)) {
            out += fmt::format("\\x{:02x}",
                               static_cast<unsigned>(static_cast<unsigned char>(text[0])));
        } else if (blank) {
            out += lines == Lines::kept ? text[0] : ' ';
        } else if (is_order(code)) {
            out += fmt::format("\\u{{{:x}}}", static_cast<std::uint32_t>(code));
        } else {
            out += text.substr(0, length);
        }
        text.remove_prefix(length == 0 ? 1 : length);
    }
    return out;
}

}  // namespace palpate::protocols

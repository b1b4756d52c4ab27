#include "engine/base/text.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

#include "engine/base/refuse.hpp"

namespace palpate {
void require(bool ok, const char* what, double value, const char* remedy) {
    refuse_if(!ok, "{} is {:.9g}: {}", what, value, remedy);
}

void require_range(double value, double lowest, double highest, const std::string& what) {
    refuse_if(!(value >= lowest && value <= highest), "{} is {:.9g}: give {:.9g} to {:.9g}", what,
              value, lowest, highest);
}

std::string_view trimmed(std::string_view text, std::string_view of) noexcept {
    const std::size_t begin = text.find_first_not_of(of);
    return begin == std::string_view::npos
             ? std::string_view()
             : text.substr(begin, text.find_last_not_of(of) - begin + 1);
}

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

namespace {

std::string lower(std::string_view text) {
    std::string out(text);
    for (char& c : out) {
        c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    }
    return out;
}

/// Levenshtein's distance, an exchange of two neighbours counted as two.
std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i + 1;
        for (std::size_t j = 0; j < b.size(); ++j) {
            const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
            diagonal = row[j + 1];
            row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
        }
    }
    return row.back();
}

}  // namespace

std::string suggestion(std::string_view unknown,
                       std::span<const std::string_view> known,
                       std::string_view otherwise) {
    constexpr std::size_t kLongest = 64;  // beyond any word of ours: no need to measure
    if (unknown.size() > kLongest) {
        return std::string(otherwise);
    }
    const std::string given = lower(unknown);
    std::string_view nearest;
    std::size_t smallest = std::max<std::size_t>(2, given.size() / 3) + 1;
    for (const std::string_view word : known) {
        // A forgotten unit is the commonest slip: stiffness for stiffness_n_per_m.
        const bool unit_forgotten = given.size() >= 3 && word.starts_with(given);
        const std::size_t distance = unit_forgotten ? 1 : edit_distance(given, lower(word));
        // A short word is near to everything: some of it must be right.
        if (distance < smallest && distance < std::max<std::size_t>(given.size(), 1)) {
            smallest = distance;
            nearest = word;
        }
    }
    return nearest.empty() ? std::string(otherwise) : fmt::format(": did you mean {}?", nearest);
}

std::string suggestion(std::string_view unknown,
                       std::span<const std::string> known,
                       std::string_view otherwise) {
    const std::vector<std::string_view> views(known.begin(), known.end());
    return suggestion(unknown, views, otherwise);
}

}  // namespace palpate

#include "data/export/json_text.hpp"

#include <cmath>

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "data/export/number_text.hpp"

namespace palpate::data {
namespace {

/// A value one step further in.
std::string indented(std::string_view value) {
    std::string out;
    for (const char c : value) {
        out += c == '\n' ? "\n  " : std::string(1, c);
    }
    return out;
}

}  // namespace

std::string json_string(std::string_view text) {
    std::string out = "\"";
    while (!text.empty()) {
        const auto [code, length] = first_character(text);
        if (length == 0) {
            out += "\\ufffd";  // RFC 8259 knows no other bytes than UTF-8
        } else if (code == U'"' || code == U'\\') {
            out += fmt::format("\\{}", text[0]);
        } else if (!is_order(code)) {
            out += text.substr(0, length);
        } else if (code < 0x10000) {
            out += fmt::format("\\u{:04x}", static_cast<std::uint32_t>(code));
        } else {
            const auto rest = static_cast<std::uint32_t>(code) - 0x10000U;
            out += fmt::format("\\u{:04x}\\u{:04x}", 0xD800U + (rest >> 10U),
                               0xDC00U + (rest & 0x3FFU));
        }
        text.remove_prefix(length == 0 ? 1 : length);
    }
    return out + '"';
}

std::string json_number(double value) {
    return std::isfinite(value) ? number_text(value) : "null";
}

std::string json_object(const JsonMembers& members) {
    std::string out;
    for (const auto& [name, value] : members) {
        out +=
            fmt::format("{}\n  {}: {}", out.empty() ? "" : ",", json_string(name), indented(value));
    }
    return out.empty() ? "{}" : "{" + out + "\n}";
}

std::string json_array(const std::vector<std::string>& values) {
    std::string out;
    for (const std::string& value : values) {
        out += fmt::format("{}\n  {}", out.empty() ? "" : ",", indented(value));
    }
    return out.empty() ? "[]" : "[" + out + "\n]";
}

}  // namespace palpate::data

#include "data/export/json_text.hpp"

#include <cmath>

#include <fmt/format.h>

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
    for (const char c : text) {
        const auto code = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\') {
            out += fmt::format("\\{}", c);
        } else if (code < 0x20) {
            out += fmt::format("\\u{:04x}", static_cast<unsigned>(code));
        } else {
            out += c;
        }
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

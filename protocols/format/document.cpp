#include "protocols/format/document.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "protocols/format/protocol_file.hpp"

namespace palpate::protocols {
namespace {

Position position_of(const toml::source_region& source) {
    // The library says line 0 for what has no place of its own, such as the file as a whole.
    return {std::max<std::size_t>(source.begin.line, 1),
            std::max<std::size_t>(source.begin.column, 1)};
}

Value value_of(const toml::node& node);

Table table_of(const toml::table& from) {
    Table table;
    for (const auto& [key, node] : from) {
        table.push_back({std::string(key.str()), position_of(key.source()), value_of(node)});
    }
    // The library sorts by name.
    std::stable_sort(table.begin(), table.end(),
                     [](const Entry& a, const Entry& b) { return a.at < b.at; });
    return table;
}

Array array_of(const toml::array& from) {
    Array array;
    for (const toml::node& node : from) {
        array.push_back(value_of(node));
    }
    return array;
}

Value value_of(const toml::node& node) {
    Value value{.at = position_of(node.source()), .data = Moment{}};
    if (const auto* table = node.as_table()) {
        value.data = table_of(*table);
    } else if (const auto* array = node.as_array()) {
        value.data = array_of(*array);
    } else if (const auto* text = node.as_string()) {
        value.data = text->get();
    } else if (const auto* integer = node.as_integer()) {
        value.data = integer->get();
    } else if (const auto* number = node.as_floating_point()) {
        value.data = number->get();
    } else if (const auto* flag = node.as_boolean()) {
        value.data = flag->get();
    }
    return value;
}

}  // namespace

std::string_view kind_of(const Value& value) {
    constexpr std::array<std::string_view, 7> kKinds{
        "true or false", "an integer", "a number", "text", "a date or time", "an array", "a table"};
    return kKinds.at(value.data.index());
}

std::string shown(std::string_view text) {
    constexpr std::size_t kMost = 60;  // bytes; what follows says no more to the reader
    std::string out = "\"";
    for (const char c : text.substr(0, kMost)) {
        const bool plain = static_cast<unsigned char>(c) >= 0x20 && c != 0x7f;
        out += plain ? std::string(1, c) : fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
    }
    if (text.size() > kMost) {
        while (!out.empty() && (static_cast<unsigned char>(out.back()) & 0xC0U) == 0x80U) {
            out.pop_back();  // no half of a character
        }
        if (static_cast<unsigned char>(out.back()) >= 0xC0U) {
            out.pop_back();
        }
        out += "...";
    }
    return out + '"';
}

std::string shown(const Value& value) {
    if (const auto* text = std::get_if<std::string>(&value.data)) {
        return shown(*text);
    }
    if (const auto* flag = std::get_if<bool>(&value.data)) {
        return *flag ? "true" : "false";
    }
    if (const auto* integer = std::get_if<std::int64_t>(&value.data)) {
        return fmt::format("{}", *integer);
    }
    if (const auto* number = std::get_if<double>(&value.data)) {
        return fmt::format("{}", *number);
    }
    if (const auto* array = std::get_if<Array>(&value.data)) {
        return fmt::format("an array of {}", array->size());
    }
    return std::string(kind_of(value));
}

Table parse_document(std::string_view text, std::string_view file_name) {
    try {
        return table_of(toml::parse(text, std::string_view{}));
    } catch (const toml::parse_error& error) {
        const Position at = position_of(error.source());
        std::string what(error.description());
        std::replace(what.begin(), what.end(), '\n', ' ');
        throw ProtocolError(fmt::format("{}:{}:{}: not TOML: {}; see https://toml.io", file_name,
                                        at.line, at.column, what));
    }
}

}  // namespace palpate::protocols

#include "data/csv/csv_text.hpp"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "engine/base/text.hpp"
#include "data/csv/json_text.hpp"

namespace palpate::data {
namespace {

bool is_number(std::string_view text) {
    if (text.starts_with('+') || text.starts_with('-')) {
        text.remove_prefix(1);
    }
    return text == "inf" || (parsed<double>(text) &&
                             text.find_first_not_of("0123456789.eE+-") == std::string_view::npos &&
                             text.find_first_of("+-") != 0);
}

/// Begins, after any number of ', as a formula does.
bool is_formula(std::string_view text) {
    const std::string_view start = text.substr(std::min(text.find_first_not_of('\''), text.size()));
    return !start.empty() &&
           std::string_view("=+-@\t\r\n").find(start.front()) != std::string_view::npos;
}

std::string no_formula(std::string_view text) {
    return (is_formula(text) && !is_number(text) ? "'" : "") + std::string(text);
}

/// Where the field at the start of `line` ends: at a comma outside of quotes, or with the line.
std::size_t end_of_field(std::string_view line) {
    const std::size_t first = line.find_first_not_of(" \t");
    if (first == std::string_view::npos || line[first] != '"') {
        return std::min(line.find(','), line.size());
    }
    bool quoted = false;
    for (std::size_t i = first; i < line.size(); ++i) {
        if (line[i] == '"') {
            quoted = !quoted;
        } else if (line[i] == ',' && !quoted) {
            return i;
        }
    }
    return line.size();
}

std::string_view unquoted(std::string_view name) {
    return name.size() >= 2 && name.front() == '"' && name.back() == '"'
             ? name.substr(1, name.size() - 2)
             : name;
}

}  // namespace

std::string csv_field(std::string_view text) {
    const std::string field = no_formula(text);
    return field.empty() || field.find_first_of(",\"\r\n") != std::string::npos ? in_quotes(field)
                                                                                : field;
}

std::string_view without_mark(std::string_view field) {
    return field.starts_with('\'') && is_formula(field) ? field.substr(1) : field;
}

std::string tsv_field(std::string_view text) {
    std::string field = no_formula(text);
    std::replace_if(
        field.begin(), field.end(), [](char c) { return c == '\t' || c == '\n' || c == '\r'; },
        ' ');
    return field.empty() ? "n/a" : field.find('"') == std::string::npos ? field : in_quotes(field);
}

std::vector<Field> fields_of(std::string_view line) {
    std::vector<Field> fields;
    const char* const begin = line.data();
    while (true) {
        const std::size_t end = end_of_field(line);
        const std::string_view text = trimmed(line.substr(0, end), kBlank);
        const char* const at = text.empty() ? line.data() : text.data();
        fields.push_back({unquoted(text), static_cast<std::size_t>(at - begin) + 1});
        if (end == line.size()) {
            return fields;
        }
        line.remove_prefix(end + 1);
    }
}

std::string plain_text(std::string_view field) {
    std::string text;
    for (std::size_t i = 0; i < field.size(); ++i) {
        text += field[i];
        i += std::size_t{field[i] == '"' && i + 1 < field.size() && field[i + 1] == '"'};
    }
    return text;
}

std::size_t RowEnd::in(std::string_view text) {
    for (; at_ < text.size(); ++at_) {
        const char c = text[at_];
        if (c == '"' && (blank_ || quoted_)) {
            quoted_ = true;
            blank_ = false;
            open_ = !open_;
        } else if (!open_ && c == '\n') {
            return at_;
        } else if (!open_) {
            quoted_ = quoted_ && c != ',';
            blank_ = c == ',' || (blank_ && (c == ' ' || c == '\t'));
        }
    }
    return std::string_view::npos;
}

std::string json_text(const Json& value) {
    const std::string text = value.dump(2, ' ', false, Json::error_handler_t::replace);
    std::string out;
    for (std::string_view rest = text; !rest.empty();) {
        const auto [code, length] = first_character(rest);
        if (code == U'\n' || !is_order(code)) {
            out += rest.substr(0, length);
        } else {  // in a string: nothing else of JSON is one
            const std::string escaped = Json(rest.substr(0, length)).dump(-1, ' ', true);
            out += std::string_view(escaped).substr(1, escaped.size() - 2);
        }
        rest.remove_prefix(length);
    }
    return out;
}

std::string json_string(std::string_view text) {
    return json_text(text);
}

}  // namespace palpate::data

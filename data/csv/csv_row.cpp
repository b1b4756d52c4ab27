#include "data/csv/csv_row.hpp"

#include <algorithm>

#include "engine/base/text.hpp"

namespace palpate::data {
namespace {

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

}  // namespace palpate::data

#include "data/csv/csv_text.hpp"

#include <algorithm>

#include "engine/base/parsed.hpp"
#include "engine/base/quotes.hpp"

namespace palpate::data {
namespace {

bool is_number(std::string_view text) {
    if (text.starts_with('+') || text.starts_with('-')) {
        text.remove_prefix(1);
    }
    return parsed<double>(text) &&
           text.find_first_not_of("0123456789.eE+-") == std::string_view::npos &&
           text.find_first_of("+-") != 0;
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

}  // namespace palpate::data

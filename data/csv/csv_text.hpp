#pragma once

#include <string>
#include <string_view>

/// One text as a field of a table that a spreadsheet may open. A spreadsheet takes a field that
/// begins with = + - @, a tab or a carriage return for a formula, so such a text gets ' in front,
/// unless it is a number; one that has ' there already gets one more. To read back: of a text that
/// begins with one or more ' and then one of these characters, drop the first '. Numbers are
/// written as they are, and never come here.
namespace palpate::data {

/// RFC 4180: in quotes if it holds a comma, a quote or an end of line, or nothing (nothing without
/// quotes is what is not there).
[[nodiscard]] std::string csv_field(std::string_view text);

/// The text of a field as csv_field() and tsv_field() made it, read back: without the ' before a
/// formula.
[[nodiscard]] std::string_view without_mark(std::string_view field);

/// BIDS (common principles, tabular files): n/a for nothing, tabs and ends of lines become spaces,
/// and a text with quotation marks is quoted as in CSV.
[[nodiscard]] std::string tsv_field(std::string_view text);

}  // namespace palpate::data

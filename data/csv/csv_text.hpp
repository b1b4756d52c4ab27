#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

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

/// Around a field, and none of it.
inline constexpr std::string_view kBlank = " \t\r";

/// A field of a row, without blanks and quotes around it.
struct Field {
    std::string_view text;
    std::size_t character = 1;  ///< where it begins, from 1
};

/// All fields of a row.
[[nodiscard]] std::vector<Field> fields_of(std::string_view row);

/// "" inside of quotes means one of them.
[[nodiscard]] std::string plain_text(std::string_view field);

/// Looks for the end of a row: a line break outside of quotes, which open where a field begins.
class RowEnd {
public:
    /// @param text  the row from its beginning; as much as before, or more
    /// @return npos: the row goes on
    [[nodiscard]] std::size_t in(std::string_view text);
    /// A quote waits for its end.
    [[nodiscard]] bool open() const { return open_; }

private:
    std::size_t at_ = 0;
    bool blank_ = true;  ///< of the field nothing but blanks was seen
    bool quoted_ = false;
    bool open_ = false;
};

/// A row longer than this is none of a table, and would fill the memory.
inline constexpr std::size_t kMaxLine = std::size_t{1} << 20U;

}  // namespace palpate::data

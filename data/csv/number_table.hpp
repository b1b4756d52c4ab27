#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

/// Tables of numbers as CSV: a head with the columns' names (units in them), then one row a line.
namespace palpate::data {

/// What is wrong with a CSV file: "file:line: what, the value, what to do", or file:line:character
/// where a field is.
class CsvError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// Rows of finite numbers, one after the other.
struct NumberTable {
    std::vector<std::string> columns;
    std::vector<double> values;             ///< row by row
    std::vector<std::size_t> lines;         ///< line of the file of each row, from 1
    std::vector<std::uint32_t> characters;  ///< of each value: where in its line it begins, from 1
    std::vector<std::string> text_columns;  ///< those of `texts` that the file has
    std::vector<std::string> texts;         ///< row by row
    std::vector<std::uint32_t>
        text_characters;  ///< of each text: where in its line it begins, from 1

    [[nodiscard]] std::size_t rows() const noexcept { return lines.size(); }
    [[nodiscard]] double at(std::size_t row, std::size_t column) const {
        return values[row * columns.size() + column];
    }
    /// "line:character" of a value.
    [[nodiscard]] std::string place(std::size_t row, std::size_t column) const;
    /// The text of a column; nothing if the file has no such column.
    [[nodiscard]] std::optional<std::string_view> text(std::size_t row,
                                                       std::string_view column) const;
    /// "line:character" of a text. @pre the file has the column
    [[nodiscard]] std::string text_place(std::size_t row, std::string_view column) const;
};

/// Reads the columns `wanted` of a CSV text, in that order; other columns are not looked at.
/// Columns of `optional` follow if the file has them all, texts of `texts` each if it is there.
/// Commas part the fields; blanks around a field, quotes around it (which may hold commas, and ""
/// for one of their own), blank lines, a byte-order mark and CR LF are fine. A field ends with its
/// line.
/// @throws CsvError for a missing column or one that is there twice, a field that is no finite
///         number, a text that is not UTF-8, a row too short or too long
[[nodiscard]] NumberTable parse_numbers(std::string_view text,
                                        std::string_view file_name,
                                        std::span<const std::string_view> wanted,
                                        std::span<const std::string_view> optional = {},
                                        std::span<const std::string_view> texts = {});

/// parse_numbers of a file's text. @throws CsvError also if the file cannot be read
[[nodiscard]] NumberTable read_numbers(const std::filesystem::path& file,
                                       std::span<const std::string_view> wanted,
                                       std::span<const std::string_view> optional = {},
                                       std::span<const std::string_view> texts = {});

}  // namespace palpate::data

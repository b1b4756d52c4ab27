#pragma once

#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

/// Tables of numbers as CSV: a head with the columns' names (units in them), then one row a line.
namespace palpate::data {

/// What is wrong with a CSV file: "file:line: what, the value, what to do".
class CsvError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// Rows of finite numbers, one after the other.
struct NumberTable {
    std::vector<std::string> columns;
    std::vector<double> values;      ///< row by row
    std::vector<std::size_t> lines;  ///< line of the file of each row, from 1

    [[nodiscard]] std::size_t rows() const noexcept { return lines.size(); }
    [[nodiscard]] double at(std::size_t row, std::size_t column) const {
        return values[row * columns.size() + column];
    }
};

/// Reads the columns `wanted` of a CSV text, in that order; other columns are not looked at. Columns of
/// `optional` follow if the file has them all. Commas part the fields; blanks around a field, quotes
/// around a name, blank lines, a byte-order mark and CR LF are fine.
/// @throws CsvError for a missing column, a field that is no finite number, a row too short or too long
[[nodiscard]] NumberTable parse_numbers(std::string_view text,
                                        std::string_view file_name,
                                        std::span<const std::string_view> wanted,
                                        std::span<const std::string_view> optional = {});

/// parse_numbers of a file's text. @throws CsvError also if the file cannot be read
[[nodiscard]] NumberTable read_numbers(const std::filesystem::path& file,
                                       std::span<const std::string_view> wanted,
                                       std::span<const std::string_view> optional = {});

}  // namespace palpate::data

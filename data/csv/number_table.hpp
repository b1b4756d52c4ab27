#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
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

    /// Rows of numbers, the head not counted.
    [[nodiscard]] std::size_t rows() const noexcept { return lines.size(); }
    /// @pre row < rows(), column < columns.size()
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

/// The text of a file that can be read more than once: what is no file on a disk, a pipe or
/// standard input, is copied to one without a name.
class RereadableText {
public:
    /// @throws CsvError if it cannot be read or copied
    explicit RereadableText(const std::filesystem::path& file);

    /// Where its text can be read from, again and again.
    [[nodiscard]] const std::filesystem::path& place() const noexcept { return place_; }
    [[nodiscard]] const std::string& name() const noexcept { return name_; }  ///< as it was given

private:
    struct Close {
        void operator()(std::FILE* file) const noexcept { std::fclose(file); }
    };

    std::string name_;
    std::filesystem::path place_;
    std::unique_ptr<std::FILE, Close> copy_{};
};

/// parse_numbers of a file's text. @throws CsvError also if the file cannot be read
[[nodiscard]] NumberTable read_numbers(const std::filesystem::path& file,
                                       std::span<const std::string_view> wanted,
                                       std::span<const std::string_view> optional = {},
                                       std::span<const std::string_view> texts = {});

/// The same, named as it was given.
[[nodiscard]] NumberTable read_numbers(const RereadableText& text,
                                       std::span<const std::string_view> wanted,
                                       std::span<const std::string_view> optional = {},
                                       std::span<const std::string_view> texts = {});

/// parse_numbers() row by row, for what is longer than the memory: some 100 KiB of it are held.
class NumberRows {
public:
    /// Reads the head. @throws CsvError as parse_numbers() does, as next() does
    NumberRows(const RereadableText& text, std::span<const std::string_view> wanted);
    ~NumberRows();
    NumberRows(const NumberRows&) = delete;
    NumberRows& operator=(const NumberRows&) = delete;

    /// Reads the next row. @return false at the end
    [[nodiscard]] bool next();
    /// Its value in column `column` of `wanted`. @pre next()
    [[nodiscard]] double at(std::size_t column) const;
    /// Line of the file in which it stands, from 1.
    [[nodiscard]] std::size_t line() const;

private:
    struct Source;
    std::unique_ptr<Source> source_;
};

}  // namespace palpate::data

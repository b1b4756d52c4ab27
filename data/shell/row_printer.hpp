#pragma once

#include <cstdint>
#include <cstdio>
#include <string>
#include <variant>
#include <vector>

namespace palpate::data {

/// A blob as its bytes; a text is UTF-8.
struct BlobCell {
    std::string bytes;
};
using SqlValue = std::variant<std::monostate, std::int64_t, double, std::string, BlobCell>;

/// What rows look like.
enum class RowFormat : std::uint8_t {
    /// Aligned by the first 1,000 rows or 16 MB, for people; NULL is empty; of a cell the first
    /// 1,000 characters.
    table,
    csv,  ///< texts by csv_field(), "\n"; NULL is empty; a blob is hexadecimal
    /// One array of objects; NULL is null; a blob is hexadecimal. JSON has no infinity: it is
    /// 1e999, which is JSON and which JavaScript, Python, R and SQLite read as infinity; -1e999 the
    /// other one. Of columns of one name the second is NAME_2.
    json,
};

/// Writes the rows of one statement. Numbers in the fewest digits that read back to the same bits.
class RowPrinter {
public:
    /// @param names  of the columns   @param out  stays the caller's
    RowPrinter(std::FILE* out, RowFormat format, std::vector<std::string> names);
    /// The next row, one cell a name. A table is held back until its widths are known.
    void row(std::vector<SqlValue> cells);
    /// After the last row: what is still held back, and the end of an array.
    void end();

private:
    void table_row(std::vector<SqlValue> cells);
    void print_table_rows();
    void print_table_row(const std::vector<SqlValue>& cells) const;
    void print_json_row(const std::vector<SqlValue>& cells);

    std::FILE* out_;
    RowFormat format_;
    std::vector<std::string> names_;
    std::vector<std::size_t> widths_;
    std::vector<std::vector<SqlValue>> waiting_;  ///< rows of a table until its widths are known
    std::size_t held_ = 0;                        ///< bytes of these
    bool head_printed_ = false;
    std::size_t rows_ = 0;
};

}  // namespace palpate::data

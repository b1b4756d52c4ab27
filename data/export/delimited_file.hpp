#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "data/store/statement.hpp"
#include "data/trace/columns.hpp"

namespace palpate::data {

/// How a table is written: texts as csv_field() or tsv_field() has them, lines end in "\n". csv:
/// nothing for what is not there; tsv: n/a.
enum class TableStyle : std::uint8_t { csv, tsv };

/// A table of text, row by row. A name that ends in .gz is compressed, the same bytes for the same
/// rows. Numbers as number_text() has them; NaN is not there. Every call throws std::runtime_error
/// if the file cannot be written.
class DelimitedFile {
public:
    /// Begins the file anew: what stood there is gone.
    DelimitedFile(std::filesystem::path path, TableStyle style);
    DelimitedFile(const DelimitedFile&) = delete;
    DelimitedFile& operator=(const DelimitedFile&) = delete;
    ~DelimitedFile();

    /// The next field of the row; none() leaves it empty (csv) or says n/a (tsv).
    void text(std::string_view value);
    void integer(std::int64_t value);
    void real(double value);
    void none();
    void value(const TickValue& value);
    /// Column `column` of a query's row.
    void value(const Statement& row, int column);
    void end_row();
    /// What was not closed is not whole.
    void close();

private:
    void raw(std::string_view value);
    void flush();
    [[noreturn]] void fail() const;

    std::filesystem::path path_;
    TableStyle style_;
    std::string pending_;
    void* file_ = nullptr;  ///< zlib's
    bool first_ = true;     ///< of its row
};

/// The rows of a query, with which the file ends.
void write_rows(Statement row, DelimitedFile& file);

}  // namespace palpate::data

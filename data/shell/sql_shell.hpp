#pragma once

#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include "data/sql/statement.hpp"
#include "data/store/database.hpp"

namespace palpate::data {

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
    void row(std::vector<ColumnValue> cells);
    /// After the last row: what is still held back, and the end of an array.
    void end();

private:
    void table_row(std::vector<ColumnValue> cells);
    void print_table_rows();
    void print_table_row(const std::vector<ColumnValue>& cells) const;
    void print_json_row(const std::vector<ColumnValue>& cells);

    std::FILE* out_;
    RowFormat format_;
    std::vector<std::string> names_;
    std::vector<std::size_t> widths_;
    std::vector<std::vector<ColumnValue>> waiting_;  ///< rows of a table until its widths are known
    std::size_t held_ = 0;                           ///< bytes of these
    bool head_printed_ = false;
    std::size_t rows_ = 0;
};

/// What a query may.
struct SqlLimits {
    bool attach = false;  ///< read other files too
    bool tells = false;   ///< after 10 s of the processor, to stderr, how to end it
    std::int64_t steps =
        2'000'000'000;  ///< of SQLite's machine, and us of processor time, a statement
};

/// While it lives, statements on a database read that file alone, by plain functions, make no value
/// of more than 50 MB, and end: somebody may have pasted them from anywhere. A single step that
/// goes on a second longer than all of them may ends the program, with exit code 1. One at a time.
class SqlGuard {
public:
    /// @param database  outlives this; nothing else may set its authorizer meanwhile
    SqlGuard(Database& database, SqlLimits limits);
    SqlGuard(const SqlGuard&) = delete;
    SqlGuard& operator=(const SqlGuard&) = delete;
    ~SqlGuard();

    /// Before each statement.
    void begin() noexcept;
    /// What is said of a statement that was refused.
    [[nodiscard]] std::string refusal(std::string_view statement) const;
    [[nodiscard]] const SqlLimits& limits() const noexcept { return limits_; }

private:
    static int count(void* guard) noexcept;
    static int authorize(void* guard,
                         int action,
                         const char* first,
                         const char* second,
                         const char* database,
                         const char* inner) noexcept;

    Database& database_;
    SqlLimits limits_;
    std::int64_t steps_left_ = 0;
    bool attached_ = false;  ///< another file was asked for
};

/// SQL on a database that is only read, with the virtual table `sample` and the statistics, and
/// words that begin with a dot. What is wrong goes to `error` as a sentence with its place.
class SqlShell {
public:
    /// @throws StoreError if the functions cannot be added
    SqlShell(Database& database,
             RowFormat format,
             std::FILE* out,
             std::FILE* error,
             SqlLimits limits = {});

    /// Statements, separated by semicolons, and words, each on its line. Stops at the first that
    /// fails.
    /// @param first_line  line that `text` begins in, for messages
    /// @return all of it went well
    bool run(std::string_view text, std::size_t first_line = 1);

    /// `text` ends a statement or is a word: it can be run.
    [[nodiscard]] static bool complete(std::string_view text);
    /// .quit was said.
    [[nodiscard]] bool quit() const noexcept { return quit_; }
    /// A statement or a word has been run, and not only blanks, semicolons and comments.
    [[nodiscard]] bool asked() const noexcept { return asked_; }

private:
    bool statement(std::string_view& text, std::string_view all, std::size_t first_line);
    /// All rows. @return what the last step of SQLite gave
    int print_rows(sqlite3_stmt* raw);
    [[nodiscard]] bool no_ticks();
    bool word(std::string_view line);
    void tables();
    void no_such(std::string_view table);
    bool columns(std::string_view table);
    bool schema(std::string_view table);
    void complain(std::string_view all, std::size_t offset, std::size_t first_line);

    Database& database_;
    RowFormat format_;
    std::FILE* out_;
    std::FILE* error_;
    SqlGuard guard_;
    bool quit_ = false;
    bool asked_ = false;
};

}  // namespace palpate::data

#pragma once

#include <cstdio>
#include <string_view>

#include "data/shell/row_printer.hpp"
#include "data/shell/sql_guard.hpp"
#include "data/store/database.hpp"

namespace palpate::data {

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

#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

namespace palpate::data {

/// Something went wrong with a database: which file, what was being done, why, and the remedy.
class StoreError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

class Database;

/// A prepared statement. Columns are counted from 0, parameters from 1.
class Statement {
public:
    Statement(Database& database, std::string_view sql);
    Statement(Statement&&) noexcept;
    Statement& operator=(Statement&&) = delete;
    Statement(const Statement&) = delete;
    Statement& operator=(const Statement&) = delete;
    ~Statement();

    Statement& bind(int parameter, std::int64_t value);
    Statement& bind(int parameter, double value);
    Statement& bind(int parameter, std::string_view value);
    Statement& bind(int parameter, std::span<const std::byte> value);
    Statement& bind_null(int parameter);
    template <class T>
    Statement& bind(int parameter, const std::optional<T>& value) {
        return value ? bind(parameter, *value) : bind_null(parameter);
    }

    /// The next row is there. @throws StoreError
    bool step();
    /// Runs to the end and makes the statement ready for new values.
    void run();
    void reset();

    [[nodiscard]] int columns() const;
    [[nodiscard]] std::string_view name(int column) const;
    [[nodiscard]] int type(
        int column) const;  ///< SQLite's: 1 integer, 2 real, 3 text, 4 blob, 5 null
    [[nodiscard]] std::int64_t integer(int column) const;
    [[nodiscard]] double real(int column) const;
    [[nodiscard]] std::string text(int column) const;
    /// Valid until the next step().
    [[nodiscard]] std::span<const std::byte> blob(int column) const;
    [[nodiscard]] bool null(int column) const { return type(column) == 5; }

private:
    Database* database_;
    sqlite3_stmt* statement_ = nullptr;
};

enum class Access { read, write };

/// One palpate database file.
class Database {
public:
    /// write: makes the file (mode 0600) with the current schema, or opens one; WAL, every commit
    /// synced to the disk, foreign keys on. read: never changes anything.
    /// @throws StoreError for a file that is no palpate database (which stays as it is), one of a newer
    ///         program, or one that cannot be opened
    Database(std::string file, Access access);
    Database(const Database&) = delete;
    Database& operator=(const Database&) = delete;
    ~Database();

    void execute(const char* sql);
    [[nodiscard]] Statement prepare(std::string_view sql) { return {*this, sql}; }
    [[nodiscard]] std::int64_t last_row() const;
    [[nodiscard]] const std::string& file() const { return file_; }
    /// Moves the log into the file, so that a copy of the file alone is whole. A reader that is still
    /// looking delays it to the next time.
    void checkpoint();

    [[noreturn]] void fail(std::string_view doing) const;
    [[nodiscard]] sqlite3* handle() const { return handle_; }

private:
    void open(Access access);
    void check_identity(Access access);

    std::string file_;
    sqlite3* handle_ = nullptr;
};

/// All or nothing: rolls back unless commit() was reached.
class Transaction {
public:
    explicit Transaction(Database& database);
    Transaction(const Transaction&) = delete;
    Transaction& operator=(const Transaction&) = delete;
    ~Transaction();
    void commit();

private:
    Database* database_;
};

/// Now, UTC, "2026-01-31T12:34:56.789Z".
[[nodiscard]] std::string utc_now();

}  // namespace palpate::data

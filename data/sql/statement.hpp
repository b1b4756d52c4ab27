#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <iterator>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

struct sqlite3;
struct sqlite3_stmt;

namespace palpate::data {

/// Something went wrong with a database: which file, what was being done, why, and the remedy.
class StoreError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// The file named cannot be meant: not a palpate database, or no name at all. Nothing was changed.
class WrongFile : public StoreError {
public:
    using StoreError::StoreError;
};

/// Another program holds a lock on the file: later it may work.
class LockedFile : public StoreError {
public:
    using StoreError::StoreError;
};

/// The disk did not take the data: it is full, or it fails. With more room it may work.
class DiskError : public StoreError {
public:
    using StoreError::StoreError;
};

/// When a file was last written to, ns since 1970; 0: there is none.
[[nodiscard]] std::int64_t written_ns(const std::string& name);

/// An open file of SQLite: who closes it is its owner. One thread at a time.
struct Connection {
    std::string file;
    sqlite3* handle = nullptr;
    /// Of what is read as a file that cannot change: written_ns() of it then; 0: of all others.
    std::int64_t as_of_ns = 0;
    /// Prepared and not in use, by their text: most are needed again soon.
    mutable std::multimap<std::string, sqlite3_stmt*, std::less<>> idle{};
    /// Throws in words of the owner's; null: fail() says what SQLite says.
    void (*failed)(const Connection& file, std::string_view doing) = nullptr;

    /// Before the handle is closed.
    void forget_idle() const noexcept;
    /// A file that should not change was written to: what was read may be of two moments.
    [[nodiscard]] bool written_since() const;
    /// @throws what `failed` throws, StoreError without it, by SQLite's last error
    [[noreturn]] void fail(std::string_view doing) const;
    /// Runs statements without results.
    void execute(const char* sql) const;
};

/// A name of a table or column as SQL takes it, whatever it holds: in ", each " twice.
[[nodiscard]] std::string quoted_name(std::string_view name);
/// A text of a statement as SQL takes it: in ', each ' twice.
[[nodiscard]] std::string quoted_text(std::string_view text);

/// A value of a column: of NULL none. Bytes stay where they are.
using ColumnValue =
    std::variant<std::monostate, std::int64_t, double, std::string, std::span<const std::byte>>;

/// Of the row that a statement stands on; its bytes are valid until the next step.
[[nodiscard]] ColumnValue column_value(sqlite3_stmt* row, int column);

/// A prepared statement. Columns are counted from 0, parameters from 1. Every call throws as
/// Connection::fail() if SQLite refuses it. A NaN is stored as NULL: SQLite has none.
class Statement {
public:
    /// @param connection  outlives the statement
    Statement(const Connection& connection, std::string_view sql);
    /// The same with `values` given to its parameters from 1 on.
    template <class... Values>
    Statement(const Connection& connection, std::string_view sql, const Values&... values)
        : Statement(connection, sql) {
        int parameter = 0;
        (bind(++parameter, values), ...);
    }
    Statement(Statement&&) noexcept;
    Statement& operator=(Statement&&) = delete;
    Statement(const Statement&) = delete;
    Statement& operator=(const Statement&) = delete;
    ~Statement();

    /// Parameters count from 1; NaN and no value are NULL; texts and bytes are copied. @throws
    /// StoreError for a parameter that the statement does not have
    Statement& bind(int parameter, std::int64_t value);
    Statement& bind(int parameter, double value);
    Statement& bind(int parameter, std::string_view value);
    Statement& bind(int parameter, std::span<const std::byte> value);
    Statement& bind(int parameter, std::monostate null);
    template <std::integral T>
    Statement& bind(int parameter, T value) {
        return bind(parameter, static_cast<std::int64_t>(value));
    }
    template <class T>
    Statement& bind(int parameter, const std::optional<T>& value) {
        return value ? bind(parameter, *value) : bind(parameter, std::monostate());
    }
    template <class... T>
    Statement& bind(int parameter, const std::variant<T...>& value) {
        std::visit([&](const auto& one) { bind(parameter, one); }, value);
        return *this;
    }

    /// The next row is there.
    bool step();
    /// for (const Statement& row : ...) goes through the rows that are left.
    struct Rows {
        Statement* row;
        bool there;
        const Statement& operator*() const { return *row; }
        void operator++() { there = row->step(); }
        friend bool operator==(const Rows& rows, std::default_sentinel_t /*end*/) {
            return !rows.there;
        }
    };
    [[nodiscard]] Rows begin() { return {this, step()}; }
    [[nodiscard]] static std::default_sentinel_t end() { return {}; }
    /// Runs to the end and makes the statement ready for new values.
    void run();
    void reset();

    /// Columns count from 0; their names are those that the query gives them.
    [[nodiscard]] int columns() const;
    [[nodiscard]] std::string_view name(int column) const;
    [[nodiscard]] int type(
        int column) const;  ///< SQLite's: 1 integer, 2 real, 3 text, 4 blob, 5 null
    [[nodiscard]] std::int64_t integer(int column) const;
    [[nodiscard]] double real(int column) const;
    [[nodiscard]] std::string text(int column) const;
    /// Valid until the next step().
    [[nodiscard]] std::span<const std::byte> blob(int column) const;
    /// Its bytes as blob() has them.
    [[nodiscard]] ColumnValue value(int column) const { return column_value(statement_, column); }
    [[nodiscard]] bool null(int column) const { return type(column) == 5; }
    /// None where it is NULL.
    [[nodiscard]] std::optional<std::int64_t> integer_or_none(int column) const {
        return null(column) ? std::nullopt : std::optional(integer(column));
    }
    [[nodiscard]] std::optional<double> real_or_none(int column) const {
        return null(column) ? std::nullopt : std::optional(real(column));
    }
    [[nodiscard]] std::optional<std::string> text_or_none(int column) const {
        return null(column) ? std::nullopt : std::optional(text(column));
    }

    /// What `make` makes of each row that is left.
    template <class Make>
    [[nodiscard]] auto all(const Make& make) {
        std::vector<std::invoke_result_t<Make, const Statement&>> made;
        while (step()) {
            made.push_back(make(*this));
        }
        return made;
    }

private:
    Statement& bound(int code);

    const Connection* connection_;
    sqlite3_stmt* statement_ = nullptr;
};

/// The first column of each row that is left.
[[nodiscard]] inline std::vector<std::string> texts(Statement row) {
    return row.all([](const Statement& one) { return one.text(0); });
}
[[nodiscard]] inline std::vector<std::int64_t> integers(Statement row) {
    return row.all([](const Statement& one) { return one.integer(0); });
}

}  // namespace palpate::data

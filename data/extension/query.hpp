#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

namespace palpate::data {

/// A connection of somebody else's, with the statements that were asked on it: most are asked
/// again. Ends before the connection.
class StatementCache {
public:
    /// @param db  stays the caller's
    explicit StatementCache(sqlite3* db) noexcept : db_(db) {}
    StatementCache(const StatementCache&) = delete;
    StatementCache& operator=(const StatementCache&) = delete;
    ~StatementCache();

private:
    friend class Query;

    sqlite3* db_;
    std::multimap<std::string, sqlite3_stmt*, std::less<>> idle_;
};

/// A statement, through the extension's function table. Columns are counted from 0, parameters from
/// 1. Throws SampleError.
class Query {
public:
    /// Takes an idle statement of this text, or prepares one.
    Query(StatementCache& database, std::string_view sql);
    Query(const Query&) = delete;
    Query& operator=(const Query&) = delete;
    ~Query();

    /// Values stay bound through reset(). step() is true while there is a row; integer, real and
    /// text are as SQLite converts them.
    Query& bind(int parameter, std::int64_t value);
    bool step();
    void reset();
    [[nodiscard]] std::int64_t integer(int column) const;
    [[nodiscard]] double real(int column) const;
    [[nodiscard]] bool null(int column) const;
    [[nodiscard]] std::string text(int column) const;
    /// Valid until the next step().
    [[nodiscard]] std::span<const std::byte> blob(int column) const;

private:
    void check(int code, std::string_view doing) const;

    StatementCache& asked_;
    sqlite3_stmt* statement_ = nullptr;
};

}  // namespace palpate::data

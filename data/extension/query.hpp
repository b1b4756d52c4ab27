#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

#include "engine/realtime/tick_record.hpp"

/// What is asked of stored ticks, and how they come.
struct sqlite3;
struct sqlite3_stmt;
namespace palpate::data {

/// Stored ticks cannot be read, or not be computed again: a sentence with the trial, and the
/// remedy.
class SampleError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// One interval of one trial.
struct TrialPart {
    std::int64_t trial = 0;
    std::int64_t interval = 1;

    friend auto operator<=>(const TrialPart&, const TrialPart&) = default;
};

/// Trials wanted, both ends among them.
struct TrialRange {
    std::int64_t first = INT64_MIN;
    std::int64_t last = INT64_MAX;
};

/// Ticks wanted; others may come too.
struct TickRange {
    std::int64_t first = 0;  ///< tick >= first
    std::int64_t last = INT64_MAX;
    double from_s = -1e300;  ///< time_s >= from_s
    double to_s = 1e300;

    friend bool operator==(const TickRange&, const TickRange&) = default;
};

/// The ticks of a part, block by block in order.
class TickBlocks {
public:
    TickBlocks() = default;
    TickBlocks(const TickBlocks&) = delete;
    TickBlocks& operator=(const TickBlocks&) = delete;
    virtual ~TickBlocks() = default;
    /// The next ticks, valid until the next call; empty at the end. Those of the range are among
    /// them, and the one before its first if velocities are wanted. @throws SampleError
    virtual std::span<const engine::TickRecord> next() = 0;
};

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

#pragma once

#include <compare>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string_view>

#include "engine/realtime/tick_record.hpp"
#include "data/sql/statement.hpp"

/// What is asked of stored ticks, and how they come.
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

/// Connection::failed of ticks. @throws SampleError
[[noreturn]] void fail_asking(const Connection& connection, std::string_view doing);

/// A connection of somebody else's, through the extension's function table: what SQLite refuses is
/// a SampleError. Ends before the connection.
struct LentConnection : Connection {
    /// @param db  stays the caller's
    explicit LentConnection(sqlite3* db)
        : Connection{.file = {}, .handle = db, .failed = fail_asking} {}
    LentConnection(const LentConnection&) = delete;
    LentConnection& operator=(const LentConnection&) = delete;
    ~LentConnection() { forget_idle(); }
};

}  // namespace palpate::data

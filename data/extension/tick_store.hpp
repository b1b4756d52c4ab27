#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <vector>

#include "engine/realtime/tick_record.hpp"
#include "data/trace/sample_columns.hpp"

struct sqlite3;

namespace palpate::data {

/// Stored ticks cannot be read, or not be computed again: a sentence with the trial, and the remedy.
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

/// The ticks in a database that somebody else opened: main of `db`. Reads only. Refuses while another
/// database with ticks is attached.
class TickStore {
public:
    explicit TickStore(sqlite3* db);
    TickStore(const TickStore&) = delete;
    TickStore& operator=(const TickStore&) = delete;
    ~TickStore();

    /// Parts with ticks, or of which ticks are counted, in order.
    [[nodiscard]] std::vector<TrialPart> parts(const TrialRange& trials);

    class Blocks;
    /// The ticks of a part, block by block in order. `columns` says which fields of the ticks are read;
    /// others may hold anything.
    [[nodiscard]] std::unique_ptr<Blocks> blocks(const TrialPart& part,
                                                 SampleColumns columns,
                                                 const TickRange& range);

private:
    struct State;
    std::unique_ptr<State> state_;
};

class TickStore::Blocks {
public:
    Blocks() = default;
    Blocks(const Blocks&) = delete;
    Blocks& operator=(const Blocks&) = delete;
    virtual ~Blocks() = default;
    /// The next ticks, valid until the next call; empty at the end. Those of the range are among them, and
    /// the one before its first if velocities are wanted. @throws SampleError
    virtual std::span<const engine::TickRecord> next() = 0;
};

}  // namespace palpate::data

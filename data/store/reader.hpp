#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "engine/realtime/tick_record.hpp"
#include "data/store/database.hpp"
#include "data/trace/replay.hpp"

namespace palpate::data {

/// Ids of the answered trials, in the order in which they were run.
[[nodiscard]] std::vector<std::int64_t> answered_trials(Database& database);

/// The intervals that a trial has, in order. @throws std::invalid_argument if there is no such
/// trial
[[nodiscard]] std::vector<std::int64_t> intervals_of(Database& database, std::int64_t trial);

/// Reads many traces of one database: what they share is read once.
class TraceReader {
public:
    /// @param database  must outlive this
    explicit TraceReader(Database& database);
    TraceReader(const TraceReader&) = delete;
    TraceReader& operator=(const TraceReader&) = delete;
    ~TraceReader();

    /// All stored ticks of an interval of a trial, each chunk checked, every field to the bit as
    /// the servo had it; empty for one without ticks. Where a full ring lost ticks the tick numbers
    /// jump, which only evidence may do: for replay take read().
    /// @throws TraceError if a chunk is damaged, ReplayError if what was not stored does not come
    /// back
    /// @throws std::invalid_argument if there is no such trial
    [[nodiscard]] Ticks stored(std::int64_t trial, std::int64_t interval = 1);

    /// The same, and whole: tick k is the k-th, and none is missing of those that the trial's
    /// summary counted. @throws TraceError also if ticks are missing
    [[nodiscard]] Ticks read(std::int64_t trial, std::int64_t interval = 1);

    /// One column as every chunk holds it, without any replay; stored_columns() has its scale.
    [[nodiscard]] std::vector<std::int64_t> column(std::int64_t trial,
                                                   ColumnId column,
                                                   std::int64_t interval = 1);

private:
    Database& database_;
    std::map<std::int64_t, SessionTraces> sessions_;
};

/// TraceReader::stored() and read() of one trial.
[[nodiscard]] Ticks stored_ticks(Database& database, std::int64_t trial);
[[nodiscard]] Ticks read_trace(Database& database, std::int64_t trial);

}  // namespace palpate::data

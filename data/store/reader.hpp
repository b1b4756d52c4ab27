#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "data/store/database.hpp"
#include "data/trace/chunk.hpp"
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
    explicit TraceReader(Database& database) : database_(database) {}

    /// All stored ticks of an interval of a trial, each chunk checked, every field to the bit as
    /// the servo had it; empty for one without ticks. Where a full ring lost ticks the tick numbers
    /// jump, which only evidence may do: for replay take read().
    /// @throws TraceError if a chunk is damaged, or what was not stored does not come back
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

/// The chunks of one interval as they lie in the file, by first_tick.
struct StoredChunks {
    std::vector<ChunkView> views;  ///< of `data`: move this, do not copy it
    std::vector<std::vector<std::byte>> data;
};

/// @throws TraceError if a row cannot be a chunk
[[nodiscard]] StoredChunks stored_chunks(Database& database,
                                         std::int64_t trial,
                                         std::int64_t interval = 1);

/// Whose a trial is, and what its scene was.
struct TrialContext {
    std::int64_t session = 0;
    TraceTrial trial;
};

/// @throws std::invalid_argument if there is no such trial
[[nodiscard]] TrialContext trial_context(Database& database,
                                         std::int64_t trial,
                                         std::int64_t interval = 1);

/// The protocol and the calibration with which the session began. @throws protocols::ProtocolError
[[nodiscard]] SessionTraces session_traces(Database& database, std::int64_t session);

/// The calibration text with which a session began; empty: its device has none.
[[nodiscard]] std::string first_calibration(Database& database, std::int64_t session);

}  // namespace palpate::data

#pragma once

#include <cstdint>
#include <vector>

#include "engine/realtime/tick_record.hpp"
#include "data/store/database.hpp"

namespace palpate::data {

/// Ids of the answered trials, in the order in which they were run.
[[nodiscard]] std::vector<std::int64_t> answered_trials(Database& database);

/// All stored ticks of a trial, each chunk checked; empty for a trial without ticks. Where a full ring
/// lost ticks the tick numbers jump, which only evidence may do: for replay take read_trace().
/// @throws TraceError if a chunk is damaged
/// @throws StoreError if there is no such trial
[[nodiscard]] std::vector<engine::TickRecord> stored_ticks(Database& database, std::int64_t trial);

/// The same, and whole: tick k is the k-th, and none is missing of those that the trial's summary counted.
/// @throws TraceError also if ticks are missing
[[nodiscard]] std::vector<engine::TickRecord> read_trace(Database& database, std::int64_t trial);

}  // namespace palpate::data

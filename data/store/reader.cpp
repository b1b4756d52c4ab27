#include "data/store/reader.hpp"

#include <utility>

#include <fmt/format.h>

#include "engine/realtime/felt_scene.hpp"
#include "data/store/stored_chunks.hpp"
#include "data/trace/chunk.hpp"

namespace palpate::data {

std::vector<std::int64_t> answered_trials(Database& database) {
    return integers(
        database.prepare("SELECT trial.trial_id FROM trial JOIN response USING (trial_id) ORDER BY "
                         "session_id, plan_position, attempt"));
}

std::vector<std::int64_t> intervals_of(Database& database, std::int64_t trial) {
    std::vector<std::int64_t> intervals = integers(database.prepare(
        "SELECT interval FROM presentation WHERE trial_id = ?1 ORDER BY 1", trial));
    if (intervals.empty()) {
        static_cast<void>(trial_context(database, trial));
    }
    return intervals;
}

TraceReader::TraceReader(Database& database) : database_(database) {}
TraceReader::~TraceReader() = default;

Ticks TraceReader::stored(std::int64_t trial, std::int64_t interval) {
    const Snapshot now(database_);
    const TrialContext context = trial_context(database_, trial, interval);
    const StoredChunks chunks = stored_chunks(database_, trial, interval);
    auto session = sessions_.find(context.session);
    if (session == sessions_.end()) {
        session =
            sessions_.emplace(context.session, session_traces(database_, context.session)).first;
    }
    ReplayResult all = session->second.replay(context.trial, chunks.views);
    if (all.differs_from) {
        throw ReplayError(replay_sentence(trial, *all.differs_from));
    }
    engine::FeltTrack track;
    find_closest_points(*session->second.scene_of(context.trial), track, all.ticks);
    return std::move(all.ticks);
}

std::vector<std::int64_t> TraceReader::column(std::int64_t trial,
                                              ColumnId column,
                                              std::int64_t interval) {
    const StoredChunks chunks = stored_chunks(database_, trial, interval);
    std::vector<std::int64_t> all;
    for (const ChunkView& chunk : chunks.views) {
        all.resize(all.size() + chunk.ticks);
        read_stored(chunk, column, std::span(all).last(chunk.ticks));
    }
    return all;
}

namespace {

[[noreturn]] void missing(Database& database,
                          std::int64_t trial,
                          std::int64_t first,
                          std::int64_t last) {
    Statement none = database.prepare(
        "SELECT 1 FROM trial JOIN session_provenance USING (session_id) WHERE trial_id = ?1 AND "
        "key = 'traces' AND value = 'none'",
        trial);
    if (none.step()) {
        throw TraceError(
            fmt::format("trial {} has no ticks: it was simulated with --no-traces", trial));
    }
    throw TraceError(fmt::format("trial {}: ticks {} to {} are missing", trial, first, last));
}

}  // namespace

Ticks TraceReader::read(std::int64_t trial, std::int64_t interval) {
    const Snapshot now(database_);
    Ticks trace = stored(trial, interval);
    std::int64_t next = 0;
    for (const engine::TickRecord& tick : trace) {
        if (tick.tick > next) {
            missing(database_, trial, next, tick.tick - 1);
        }
        if (tick.tick < next) {
            throw TraceError(
                fmt::format("trial {}: tick {} follows tick {}", trial, tick.tick, next - 1));
        }
        ++next;
    }
    Statement counted = database_.first(
        "SELECT coalesce(max(ticks), 0) FROM presentation WHERE trial_id = ?1 AND interval = ?2",
        trial, interval);
    if (counted.integer(0) > next) {
        missing(database_, trial, next, counted.integer(0) - 1);
    }
    return trace;
}

Ticks stored_ticks(Database& database, std::int64_t trial) {
    return TraceReader(database).stored(trial);
}

Ticks read_trace(Database& database, std::int64_t trial) {
    return TraceReader(database).read(trial);
}

}  // namespace palpate::data

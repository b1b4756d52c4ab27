#include "data/store/reader.hpp"

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "engine/realtime/felt_scene.hpp"

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

Ticks TraceReader::stored(std::int64_t trial, std::int64_t interval) {
    const Snapshot now(database_);
    const TrialContext context = trial_context(database_, trial, interval);
    const StoredChunks chunks = stored_chunks(database_, trial, interval);
    auto session = sessions_.find(context.session);
    if (session == sessions_.end()) {
        session =
            sessions_.emplace(context.session, session_traces(database_, context.session)).first;
    }
    Ticks ticks = session->second.replay(trial, context.trial, chunks.views);
    engine::FeltTrack track;
    find_closest_points(*session->second.scene_of(context.trial), track, ticks);
    return ticks;
}

std::vector<std::int64_t> TraceReader::column(std::int64_t trial,
                                              ColumnId column,
                                              std::int64_t interval) {
    const StoredChunks chunks = stored_chunks(database_, trial, interval);
    std::vector<std::int64_t> all;
    for (const ChunkView& chunk : chunks.views) {
        all.resize(all.size() + chunk.ticks);
        ChunkReader(chunk).read(column, std::span(all).last(chunk.ticks));
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
    refuse_if<TraceError>(none.step(), "trial {} has no ticks: it was simulated with --no-traces",
                          trial);
    throw TraceError(fmt::format("trial {}: ticks {} to {} are missing", trial, first, last));
}

constexpr const char* kChunks =
    "SELECT first_tick, ticks, codec, crc32, data, interval, period_ns, holds, derived FROM "
    "trace_chunk WHERE trial_id = ?1 AND interval = ?2 ORDER BY first_tick";

/// An interval that was never begun has no presentation, and no chunks.
constexpr const char* kContext =
    "SELECT trial.session_id, coalesce(p.felt_object, plan.planned_object), coalesce(p.friction, "
    "plan.friction), coalesce(p.slip_decay, 0), coalesce(p.heal_decay, 0), p.curvature_per_m, "
    "p.mu_s, p.mu_d, p.stimulus FROM trial JOIN plan USING (session_id, plan_position) LEFT JOIN "
    "presentation AS p ON p.trial_id = trial.trial_id AND p.interval = ?2 WHERE trial.trial_id = "
    "?1";

}  // namespace

Ticks TraceReader::read(std::int64_t trial, std::int64_t interval) {
    const Snapshot now(database_);
    Ticks trace = stored(trial, interval);
    std::int64_t next = 0;
    for (const engine::TickRecord& tick : trace) {
        if (tick.tick > next) {
            missing(database_, trial, next, tick.tick - 1);
        }
        refuse_if<TraceError>(tick.tick < next, "trial {}: tick {} follows tick {}", trial,
                              tick.tick, next - 1);
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

StoredChunks stored_chunks(Database& database, std::int64_t trial, std::int64_t interval) {
    StoredChunks all;
    for (const Statement& row : database.prepare(kChunks, trial, interval)) {
        const auto blob = row.blob(4);
        const auto& data = all.data.emplace_back(blob.begin(), blob.end());
        refuse_if<TraceError>(row.integer(1) < 1, "trial {}: a chunk of {} ticks", trial,
                              row.integer(1));
        all.views.push_back({.interval = row.integer(5),
                             .first_tick = row.integer(0),
                             .ticks = static_cast<std::size_t>(row.integer(1)),
                             .codec = row.integer(2),
                             .period_ns = row.integer(6),
                             .parts = parts_of(row.text(7)),
                             .crc32 = crc32_of(row.integer(3)),
                             .derived = static_cast<std::uint64_t>(row.integer(8)),
                             .data = data});
    }
    return all;
}

TrialContext trial_context(Database& database, std::int64_t trial, std::int64_t interval) {
    Statement row = database.prepare(kContext, trial, interval);
    refuse_if(!row.step(), "{}: there is no trial {}; SELECT trial_id FROM trial lists them",
              database.file(), trial);
    return {.session = row.integer(0),
            .trial = {.object = row.text(1),
                      .friction = row.text(2),
                      .slip_decay = row.real(3),
                      .heal_decay = row.real(4),
                      .curvature = row.real_or_none(5),
                      .mu_s = row.real_or_none(6),
                      .mu_d = row.real_or_none(7),
                      .stimulus = row.real_or_none(8)}};
}

std::string first_calibration(Database& database, std::int64_t session) {
    Statement row = database.prepare(
        "SELECT value FROM session_provenance WHERE session_id = ?1 AND key = 'calibration'",
        session);
    return row.step() ? row.text(0) : std::string();
}

SessionTraces session_traces(Database& database, std::int64_t session) {
    return {database
                .first("SELECT protocol_toml FROM session JOIN study USING (study_id) WHERE "
                       "session.session_id = ?1",
                       session)
                .text(0),
            first_calibration(database, session)};
}

}  // namespace palpate::data

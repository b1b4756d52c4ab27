#include "data/store/stored_chunks.hpp"

#include <stdexcept>

#include <fmt/format.h>

namespace palpate::data {
namespace {

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

StoredChunks stored_chunks(Database& database, std::int64_t trial, std::int64_t interval) {
    StoredChunks all;
    for (const Statement& row : database.prepare(kChunks, trial, interval)) {
        const auto blob = row.blob(4);
        const auto& data = all.data.emplace_back(blob.begin(), blob.end());
        if (row.integer(1) < 1) {
            throw TraceError(fmt::format("trial {}: a chunk of {} ticks", trial, row.integer(1)));
        }
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
    if (!row.step()) {
        throw std::invalid_argument(
            fmt::format("{}: there is no trial {}; SELECT trial_id FROM trial lists them",
                        database.file(), trial));
    }
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

#include "data/store/reader.hpp"

#include <fmt/format.h>

#include "data/trace/codec.hpp"

namespace palpate::data {

std::vector<std::int64_t> answered_trials(Database& database) {
    std::vector<std::int64_t> ids;
    Statement row = database.prepare(
        "SELECT trial.id FROM trial JOIN response ON response.trial = trial.id"
        " ORDER BY session, position, attempt");
    while (row.step()) {
        ids.push_back(row.integer(0));
    }
    return ids;
}

std::vector<engine::TickRecord> stored_ticks(Database& database, std::int64_t trial) {
    Statement there = database.prepare("SELECT 1 FROM trial WHERE id = ?1");
    if (!there.bind(1, trial).step()) {
        throw StoreError(fmt::format("{}: there is no trial {}; SELECT id FROM trial lists them",
                                     database.file(), trial));
    }
    std::vector<engine::TickRecord> all;
    Statement row = database.prepare(
        "SELECT first_tick, ticks, codec, crc32, data FROM trace_chunk"
        " WHERE trial = ?1 ORDER BY first_tick");
    row.bind(1, trial);
    while (row.step()) {
        if (row.integer(2) != kTraceCodec) {
            throw TraceError(fmt::format("trial {}: trace codec {} is unknown; update palpate",
                                         trial, row.integer(2)));
        }
        const auto ticks = decode(row.blob(4), static_cast<std::size_t>(row.integer(1)),
                                  static_cast<std::uint32_t>(row.integer(3)));
        if (ticks.front().tick != row.integer(0)) {
            throw TraceError(fmt::format("trial {}: the chunk of tick {} begins with tick {}",
                                         trial, row.integer(0), ticks.front().tick));
        }
        all.insert(all.end(), ticks.begin(), ticks.end());
    }
    return all;
}

std::vector<engine::TickRecord> read_trace(Database& database, std::int64_t trial) {
    const Snapshot now(database);
    std::vector<engine::TickRecord> trace = stored_ticks(database, trial);
    const auto missing = [trial](std::int64_t first, std::int64_t last) {
        throw TraceError(fmt::format("trial {}: ticks {} to {} are missing", trial, first, last));
    };
    std::int64_t next = 0;
    for (const engine::TickRecord& tick : trace) {
        if (tick.tick > next) {
            missing(next, tick.tick - 1);
        }
        if (tick.tick < next) {
            throw TraceError(
                fmt::format("trial {}: tick {} follows tick {}", trial, tick.tick, next - 1));
        }
        ++next;
    }
    Statement counted = database.prepare("SELECT coalesce(ticks, 0) FROM trial WHERE id = ?1");
    counted.bind(1, trial).step();
    if (counted.integer(0) > next) {
        missing(next, counted.integer(0) - 1);
    }
    return trace;
}

}  // namespace palpate::data

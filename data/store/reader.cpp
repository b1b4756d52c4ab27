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

std::vector<engine::TickRecord> read_trace(Database& database, std::int64_t trial) {
    Statement there = database.prepare("SELECT 1 FROM trial WHERE id = ?1");
    if (!there.bind(1, trial).step()) {
        throw StoreError(fmt::format("{}: there is no trial {}; SELECT id FROM trial lists them",
                                     database.file(), trial));
    }
    std::vector<engine::TickRecord> trace;
    Statement row = database.prepare(
        "SELECT first_tick, ticks, codec, crc32, data FROM trace_chunk"
        " WHERE trial = ?1 ORDER BY first_tick");
    row.bind(1, trial);
    while (row.step()) {
        if (row.integer(0) != static_cast<std::int64_t>(trace.size())) {
            throw TraceError(fmt::format("trial {}: ticks {} to {} are missing", trial,
                                         trace.size(), row.integer(0) - 1));
        }
        if (row.integer(2) != kTraceCodec) {
            throw TraceError(fmt::format("trial {}: trace codec {} is unknown; update palpate",
                                         trial, row.integer(2)));
        }
        const auto ticks = decode(row.blob(4), static_cast<std::size_t>(row.integer(1)),
                                  static_cast<std::uint32_t>(row.integer(3)));
        trace.insert(trace.end(), ticks.begin(), ticks.end());
    }
    return trace;
}

}  // namespace palpate::data

#include "data/extension/part_chunks.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace palpate::data {
namespace {

/// ?2 is used either way: a file from before schema 5 has one interval.
std::string interval_of(bool old) {
    return old ? " AND ?2 = 1" : " AND interval = ?2";
}

std::uint32_t checksum(std::int64_t stored) {
    if (stored < 0 || stored > std::numeric_limits<std::uint32_t>::max()) {
        throw TraceError(fmt::format("crc32 {} has more than 32 bits", stored));
    }
    return static_cast<std::uint32_t>(stored);
}

}  // namespace

void fail(const TrialPart& part, const std::string& why) {
    throw SampleError(
        fmt::format("trial {}, interval {}: {}; palpate verify lists all that is wrong", part.trial,
                    part.interval, why));
}

std::span<const engine::TickRecord> ticks_in(std::span<const engine::TickRecord> ticks,
                                             const TickRange& range) noexcept {
    const auto early = [&range](const engine::TickRecord& tick) {
        return tick.tick < range.first || static_cast<double>(tick.time_ns) * 1e-9 < range.from_s;
    };
    const auto inside = [&range](const engine::TickRecord& tick) {
        return tick.tick <= range.last && static_cast<double>(tick.time_ns) * 1e-9 <= range.to_s;
    };
    auto first = std::partition_point(ticks.begin(), ticks.end(), early);
    const auto last = std::partition_point(first, ticks.end(), inside);
    first -= first == ticks.begin() ? 0 : 1;
    return {first, last};
}

PartChunks::PartChunks(sqlite3* db, bool old, const TrialPart& part)
    : part_(part),
      rows_(db,
            std::string("SELECT first_tick, ticks, codec, crc32, ") +
                (old ? "0, '', 0" : "period_ns, holds, derived") +
                ", data FROM main.trace_chunk WHERE trial = ?1" + interval_of(old) +
                " AND first_tick = ?3") {
    Query heads(db, "SELECT first_tick FROM main.trace_chunk WHERE trial = ?1" + interval_of(old) +
                        " ORDER BY first_tick");
    heads.bind(1, part.trial).bind(2, part.interval);
    while (heads.step()) {
        first_ticks_.push_back(heads.integer(0));
    }
}

PartChunk PartChunks::at(std::size_t i) {
    rows_.reset();
    rows_.bind(1, part_.trial).bind(2, part_.interval).bind(3, first_ticks_.at(i));
    if (!rows_.step()) {
        fail(part_, fmt::format("the chunk of tick {} is gone", first_ticks_[i]));
    }
    PartChunk chunk;
    const auto data = rows_.blob(7);
    chunk.bytes.assign(data.begin(), data.end());
    chunk.view = {.interval = part_.interval,
                  .first_tick = rows_.integer(0),
                  .ticks = static_cast<std::size_t>(std::max<std::int64_t>(0, rows_.integer(1))),
                  .codec = rows_.integer(2),
                  .period_ns = rows_.integer(4),
                  .parts = parts_of(rows_.text(5)),
                  .crc32 = checksum(rows_.integer(3)),
                  .derived = static_cast<std::uint64_t>(rows_.integer(6)),
                  .data = chunk.bytes};
    rows_.reset();
    if (chunk.view.ticks == 0) {
        throw TraceError(fmt::format("the chunk of tick {} has no ticks", first_ticks_[i]));
    }
    return chunk;
}

}  // namespace palpate::data

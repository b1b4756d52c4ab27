#include "data/extension/part_chunks.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "data/trace/columns.hpp"

namespace palpate::data {

void fail(const TrialPart& part, const std::string& why) {
    throw SampleError(
        fmt::format("trial {}, interval {}: {}; palpate verify lists all that is wrong", part.trial,
                    part.interval, why));
}

std::span<const engine::TickRecord> ticks_in(std::span<const engine::TickRecord> ticks,
                                             const TickRange& range) noexcept {
    const auto early = [&range](const engine::TickRecord& tick) {
        return tick.tick < range.first || seconds_of(tick.time_ns) < range.from_s;
    };
    const auto inside = [&range](const engine::TickRecord& tick) {
        return tick.tick <= range.last && seconds_of(tick.time_ns) <= range.to_s;
    };
    auto first = std::partition_point(ticks.begin(), ticks.end(), early);
    const auto last = std::partition_point(first, ticks.end(), inside);
    first -= first == ticks.begin() ? 0 : 1;
    return {first, last};
}

PartChunks::PartChunks(StatementCache& db, const TrialPart& part)
    : part_(part),
      rows_(db,
            "SELECT first_tick, ticks, codec, crc32, period_ns, holds, derived, data FROM "
            "main.trace_chunk WHERE trial_id = ?1 AND interval = ?2 AND first_tick = ?3") {
    Query heads(db,
                "SELECT first_tick, ticks FROM main.trace_chunk WHERE trial_id = ?1 AND interval = "
                "?2 ORDER BY first_tick");
    heads.bind(1, part.trial).bind(2, part.interval);
    std::vector<std::int64_t> counts;
    while (heads.step()) {
        first_ticks_.push_back(heads.integer(0));
        counts.push_back(heads.integer(1));
    }
    require_all(db, counts);
}

namespace {

/// The first gap between chunks, or before `ticks`; empty: none.
std::string gap_in(const std::vector<std::int64_t>& first_ticks,
                   const std::vector<std::int64_t>& counts,
                   std::int64_t ticks) {
    std::int64_t next = 0;
    for (std::size_t i = 0; i < counts.size(); ++i) {
        if (first_ticks[i] != next) {
            return fmt::format("a chunk begins with tick {} where tick {} belongs", first_ticks[i],
                               next);
        }
        next += counts[i];
    }
    return ticks > next ? fmt::format("ticks {} to {} are missing", next, ticks - 1) : "";
}

}  // namespace

void PartChunks::require_all(StatementCache& db, const std::vector<std::int64_t>& counts) {
    Query stored(
        db,
        "SELECT session.session_id, rate_hz, felt.ticks FROM main.trial JOIN "
        "main.presentation AS felt ON felt.trial_id = trial.trial_id AND felt.interval = ?2 "
        "JOIN main.session USING (session_id) WHERE trial.trial_id = ?1");
    if (!stored.bind(1, part_.trial).bind(2, part_.interval).step()) {
        fail(part_, "it has ticks, but no row in trial and presentation");
    }
    period_ns_ = engine::tick_period_ns(stored.real(1));
    // NULL, of a trial that did not end, is 0.
    const std::string missing = gap_in(first_ticks_, counts, stored.integer(2));
    if (missing.empty()) {
        return;
    }
    Query lost(db,
               "SELECT 1 FROM main.event WHERE session_id = ?1 AND event_kind = 'ticks lost' UNION "
               "ALL SELECT 1 FROM main.session_provenance WHERE session_id = ?1 AND key = 'traces' "
               "AND value = 'none'");
    if (!lost.bind(1, stored.integer(0)).step()) {
        fail(part_, missing);
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
                  .crc32 = crc32_of(rows_.integer(3)),
                  .derived = static_cast<std::uint64_t>(rows_.integer(6)),
                  .data = chunk.bytes};
    rows_.reset();
    if (chunk.view.ticks == 0) {
        throw TraceError(fmt::format("the chunk of tick {} has no ticks", first_ticks_[i]));
    }
    if (chunk.view.period_ns != period_ns_) {
        throw TraceError(fmt::format("the chunk of tick {} has a period of {} ns, not {}",
                                     first_ticks_[i], chunk.view.period_ns, period_ns_));
    }
    return chunk;
}

}  // namespace palpate::data

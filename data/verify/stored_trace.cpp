#include "data/verify/stored_trace.hpp"

#include <algorithm>
#include <limits>
#include <span>

#include <fmt/format.h>

#include "data/trace/codec.hpp"

namespace palpate::data {
namespace {

/// One chunk as it should follow `next` ticks; throws what is wrong with it.
std::vector<engine::TickRecord> checked_chunk(const Statement& row, std::int64_t next) {
    const std::int64_t first = row.integer(0);
    const std::int64_t count = row.integer(1);
    if (row.integer(2) != kTraceCodec) {
        throw TraceError(fmt::format("codec {} is unknown", row.integer(2)));
    }
    if (count < 1 || count > static_cast<std::int64_t>(kChunkTicks)) {
        throw TraceError(fmt::format("{} ticks", count));
    }
    if (row.integer(3) < 0 || row.integer(3) > std::numeric_limits<std::uint32_t>::max()) {
        throw TraceError(fmt::format("crc32 {} has more than 32 bits", row.integer(3)));
    }
    auto ticks = decode(row.blob(4), static_cast<std::size_t>(count),
                        static_cast<std::uint32_t>(row.integer(3)));
    if (first != next) {
        throw TraceError(first > next ? fmt::format("ticks {} to {} are missing", next, first - 1)
                                      : fmt::format("it begins with tick {} again", first));
    }
    for (const engine::TickRecord& tick : ticks) {
        if (tick.tick != next) {
            throw TraceError(fmt::format("tick {} stands where tick {} belongs", tick.tick, next));
        }
        ++next;
    }
    return ticks;
}

/// A changed bit of a zlib stream can unpack to the same ticks: padding, or another way to say the same run.
/// Packing them again shows it, with the zlib that packed them. One program wrote all chunks of a trial:
/// where this zlib packs some of them as they are stored, it must pack all of them so.
class Packing {
public:
    void add(std::int64_t first,
             std::span<const std::byte> data,
             const std::vector<engine::TickRecord>& ticks) {
        if (std::ranges::equal(encode(ticks).data, data)) {
            ++same_;
        } else {
            other_.push_back(first);
        }
    }
    void check(Findings& findings) const {
        for (std::size_t i = 0; same_ > 0 && i < other_.size(); ++i) {
            findings.add({.kind = FindingKind::differs,
                          .trial = {},
                          .tick = other_[i],
                          .what = "trace_chunk.data",
                          .stored = "the same ticks in other bytes",
                          .recomputed = "packed as the trial's other chunks"});
        }
    }

private:
    std::size_t same_ = 0;
    std::vector<std::int64_t> other_;
};

}  // namespace

StoredTrace load_trace(Database& database, std::int64_t trial, Findings& findings) {
    StoredTrace trace;
    Packing packing;
    Statement row = database.prepare(
        "SELECT first_tick, ticks, codec, crc32, data FROM trace_chunk WHERE trial = ?1"
        " ORDER BY first_tick");
    row.bind(1, trial);
    while (row.step()) {
        const auto next = static_cast<std::int64_t>(trace.ticks.size());
        try {
            if (next % static_cast<std::int64_t>(kChunkTicks) != 0) {
                throw TraceError(
                    fmt::format("the one before it is not full: it ends before {}", next));
            }
            const auto ticks = checked_chunk(row, next);
            packing.add(next, row.blob(4), ticks);
            trace.ticks.insert(trace.ticks.end(), ticks.begin(), ticks.end());
        } catch (const TraceError& e) {
            trace.whole = false;
            findings.add({.kind = FindingKind::differs,
                          .trial = trial,
                          .tick = row.integer(0),
                          .what = "trace_chunk",
                          .stored = e.what(),
                          .recomputed = fmt::format("nothing is replayed from tick {} on", next)});
            break;
        }
    }
    packing.check(findings);
    return trace;
}

}  // namespace palpate::data

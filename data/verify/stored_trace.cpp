#include "data/verify/stored_trace.hpp"

#include <algorithm>
#include <optional>
#include <span>

#include <fmt/format.h>

#include "data/store/stored_chunks.hpp"
#include "data/trace/codec.hpp"

namespace palpate::data {
namespace {

std::size_t full(const ChunkView& chunk) noexcept {
    return chunk.codec == kTraceCodec ? kChunkTicks : kChunk2Ticks;
}

/// The stored columns of a chunk of either codec; its checksum is looked at once.
class Columns {
public:
    explicit Columns(const ChunkView& chunk) : chunk_(chunk) {
        if (chunk.codec != kTraceCodec) {
            reader_.emplace(chunk);
        }
        values_.resize(chunk.ticks);
    }
    /// Good until the next call.
    const std::vector<std::int64_t>& read(Stored column) {
        if (reader_) {
            reader_->read(column, values_);
        } else {
            read_stored(chunk_, column, values_);
        }
        return values_;
    }
    void unpack_exact() {
        if (reader_) {
            std::vector<engine::TickRecord> exact(chunk_.ticks);
            reader_->read_exact(exact);
        }
    }

private:
    ChunkView chunk_;
    std::optional<ChunkReader> reader_;
    std::vector<std::int64_t> values_;
};

/// Throws what is wrong with a chunk that should follow `next` ticks.
void check_chunk(const ChunkView& chunk, std::int64_t next, std::int64_t period_ns) {
    const std::int64_t first = chunk.first_tick;
    if (first != next) {
        throw TraceError(first > next ? fmt::format("ticks {} to {} are missing", next, first - 1)
                                      : fmt::format("it begins with tick {} again", first));
    }
    const std::int64_t period = chunk.codec == kTraceCodec ? 0 : period_ns;
    if (chunk.period_ns != period) {
        throw TraceError(fmt::format("its period is {} ns, not {}", chunk.period_ns, period));
    }
    Columns columns(chunk);
    for (std::size_t column = 1; column < (period == 0 ? 1 : kStoredColumns); ++column) {
        static_cast<void>(columns.read(static_cast<Stored>(column)));
    }
    for (const std::int64_t tick : columns.read(Stored::tick)) {
        if (tick != next) {
            throw TraceError(fmt::format("tick {} stands where tick {} belongs", tick, next));
        }
        ++next;
    }
    columns.unpack_exact();
}

/// A changed bit of a zlib stream of codec 1 can unpack to the same ticks: padding, or another way to say the
/// same run. Packing them again shows it, with the zlib that packed them. One program wrote all chunks of a
/// trial: where this zlib packs some of them as they are stored, it must pack all of them so.
class Packing {
public:
    void add(const ChunkView& chunk) {
        if (std::ranges::equal(encode(decode(chunk.data, chunk.ticks, chunk.crc32)).data,
                               chunk.data)) {
            ++same_;
        } else {
            other_.push_back(chunk.first_tick);
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

/// The chunks before the first that is not what was written.
std::size_t good_chunks(std::span<const ChunkView> chunks,
                        std::int64_t period_ns,
                        Findings& findings) {
    Packing packing;
    std::int64_t next = 0;
    std::size_t good = 0;
    for (; good < chunks.size(); ++good) {
        const ChunkView& chunk = chunks[good];
        try {
            if (good > 0 && chunks[good - 1].ticks != full(chunks[good - 1])) {
                throw TraceError(
                    fmt::format("the one before it is not full: it ends before {}", next));
            }
            check_chunk(chunk, next, period_ns);
            if (chunk.codec == kTraceCodec) {
                packing.add(chunk);
            }
            next += static_cast<std::int64_t>(chunk.ticks);
        } catch (const TraceError& e) {
            findings.add({.kind = FindingKind::differs,
                          .trial = {},
                          .tick = chunk.first_tick,
                          .what = "trace_chunk",
                          .stored = e.what(),
                          .recomputed = fmt::format("nothing is replayed from tick {} on", next)});
            break;
        }
    }
    packing.check(findings);
    return good;
}

/// What everybody can read must be what the exact numbers say.
void check_readable(std::span<const ChunkView> chunks,
                    std::span<const engine::TickRecord> ticks,
                    Findings& findings) {
    for (const ChunkView& chunk : chunks) {
        Columns columns(chunk);
        for (std::size_t i = 0; i < kStoredColumns; ++i) {
            const auto column = static_cast<Stored>(i);
            const std::vector<std::int64_t>& values = columns.read(column);
            const auto wrong = std::ranges::mismatch(
                values, ticks.first(chunk.ticks), {}, {},
                [column](const engine::TickRecord& tick) { return stored_value(column, tick); });
            if (wrong.in1 != values.end()) {
                findings.add({.kind = FindingKind::differs,
                              .trial = {},
                              .tick = wrong.in2->tick,
                              .what = fmt::format("trace.{}", stored_columns()[i].name),
                              .stored = fmt::format("{}", *wrong.in1),
                              .recomputed = fmt::format("{}", stored_value(column, *wrong.in2))});
            }
        }
        ticks = ticks.subspan(chunk.ticks);
    }
}

}  // namespace

StoredTrace load_trace(Database& database,
                       std::int64_t trial,
                       std::int64_t interval,
                       const engine::Scene* scene,
                       const std::optional<engine::PantographSpec>& machine,
                       std::int64_t period_ns,
                       Findings& findings) {
    StoredTrace trace;
    try {
        const StoredChunks chunks = stored_chunks(database, trial, interval);
        const std::size_t good = good_chunks(chunks.views, period_ns, findings);
        trace.whole = good == chunks.views.size();
        Replayed all = replay(scene, machine, std::span(chunks.views).first(good));
        if (all.differs_from) {
            findings.add({.kind = FindingKind::differs,
                          .trial = {},
                          .tick = all.differs_from,
                          .what = "trace_chunk.derived",
                          .stored = "the hash of what the servo had",
                          .recomputed = "another one by replay"});
        }
        check_readable(std::span(chunks.views).first(good), all.ticks, findings);
        trace.ticks = std::move(all.ticks);
    } catch (const TraceError& e) {
        trace.whole = false;
        findings.differs("trace_chunk", e.what(), "a chunk that can be read");
    }
    return trace;
}

}  // namespace palpate::data

#include "data/verify/stored_trace.hpp"

#include <algorithm>
#include <optional>
#include <span>

#include <fmt/format.h>

#include "data/store/stored_chunks.hpp"
#include "data/trace/chunk.hpp"

namespace palpate::data {
namespace {

/// Throws what is wrong with a chunk that should follow `next` ticks.
void check_chunk(const ChunkView& chunk, std::int64_t next, std::int64_t period_ns) {
    const std::int64_t first = chunk.first_tick;
    if (first != next) {
        throw TraceError(first > next ? fmt::format("ticks {} to {} are missing", next, first - 1)
                                      : fmt::format("it begins with tick {} again", first));
    }
    if (chunk.period_ns != period_ns) {
        throw TraceError(fmt::format("its period is {} ns, not {}", chunk.period_ns, period_ns));
    }
    ChunkReader reader(chunk);
    std::vector<std::int64_t> values(chunk.ticks);
    for (std::size_t column = kStoredColumns; column-- > 0;) {  // Stored::tick comes last
        reader.read(static_cast<Stored>(column), values);
    }
    for (const std::int64_t tick : values) {
        if (tick != next) {
            throw TraceError(fmt::format("tick {} stands where tick {} belongs", tick, next));
        }
        ++next;
    }
    std::vector<engine::TickRecord> exact(chunk.ticks);
    reader.read_exact(exact);
}

/// The chunks before the first that is not what was written.
std::size_t good_chunks(std::span<const ChunkView> chunks,
                        std::int64_t period_ns,
                        Findings& findings) {
    std::int64_t next = 0;
    std::size_t good = 0;
    for (; good < chunks.size(); ++good) {
        const ChunkView& chunk = chunks[good];
        try {
            if (good > 0 && chunks[good - 1].ticks != kChunkTicks) {
                throw TraceError(
                    fmt::format("the one before it is not full: it ends before {}", next));
            }
            check_chunk(chunk, next, period_ns);
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
    return good;
}

/// What everybody can read must be what the exact numbers say.
void check_readable(std::span<const ChunkView> chunks,
                    std::span<const engine::TickRecord> ticks,
                    Findings& findings) {
    for (const ChunkView& chunk : chunks) {
        ChunkReader reader(chunk);
        std::vector<std::int64_t> values(chunk.ticks);
        for (std::size_t i = 0; i < kStoredColumns; ++i) {
            const auto column = static_cast<Stored>(i);
            reader.read(column, values);
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

#include "data/verify/stored_trace.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "data/trace/chunk.hpp"
#include "data/trace/chunk_replay.hpp"
#include "data/trace/column_codec.hpp"

namespace palpate::data {
namespace {

using engine::TickRecord;

void differs_from(std::int64_t tick,
                  std::string what,
                  std::string stored,
                  std::string recomputed,
                  Findings& findings) {
    findings.add({.kind = FindingKind::differs,
                  .trial = {},
                  .tick = tick,
                  .what = std::move(what),
                  .stored = std::move(stored),
                  .recomputed = std::move(recomputed)});
}

/// Chunk by chunk, as far as they are what was written.
class TraceCheck {
public:
    TraceCheck(std::span<const ChunkView> chunks,
               const engine::SceneView& scene,
               const std::optional<engine::PantographSpec>& machine,
               std::int64_t period_ns,
               Findings& findings,
               Ticks room)
        : chunks_(chunks),
          replay_(machine, scene, chunks, false, std::move(room)),
          period_ns_(period_ns),
          findings_(findings) {}

    StoredTrace run() {
        StoredTrace trace;
        for (std::size_t i = 0; i < chunks_.size() && trace.whole; ++i) {
            try {
                check(i);
                trace.holds_contacts =
                    trace.holds_contacts || (chunks_[i].parts & part_contact) != 0;
            } catch (const TraceError& e) {
                differs_from(chunks_[i].first_tick, "trace_chunk", e.what(),
                             fmt::format("nothing is replayed from tick {} on", next_), findings_);
                trace.whole = false;
            }
        }
        trace.ticks = replay_.take();
        trace.ticks.resize(static_cast<std::size_t>(next_));
        return trace;
    }

private:
    /// @throws TraceError what is wrong with a chunk that should follow next_ ticks
    void check(std::size_t i) {
        const ChunkView& chunk = chunks_[i];
        if (i > 0 && chunks_[i - 1].ticks != kChunkTicks) {
            throw TraceError(
                fmt::format("the one before it is not full: it ends before {}", next_));
        }
        const std::int64_t first = chunk.first_tick;
        if (first != next_) {
            throw TraceError(first > next_
                                 ? fmt::format("ticks {} to {} are missing", next_, first - 1)
                                 : fmt::format("it begins with tick {} again", first));
        }
        if (chunk.period_ns != period_ns_) {
            throw TraceError(
                fmt::format("its period is {} ns, not {}", chunk.period_ns, period_ns_));
        }
        const ChunkReplay::Again again = replay_.chunk(i);
        std::int64_t due = next_;
        for (const TickRecord& tick : again.ticks) {
            if (tick.tick != due) {
                throw TraceError(
                    fmt::format("tick {} stands where tick {} belongs", tick.tick, due));
            }
            ++due;
        }
        check_readable(chunk, again.ticks);
        next_ = due;
        if (!again.as_recorded && !another_hash_) {
            another_hash_ = true;
            differs_from(first, "trace_chunk.derived", "the hash of what the servo had",
                         "another one by replay", findings_);
        }
    }

    /// What everybody can read must be what the exact numbers say. The other columns are the ticks'
    /// own.
    void check_readable(const ChunkView& chunk, std::span<const TickRecord> ticks) {
        constexpr std::array kReadable{
            ColumnId::lateness_ns, ColumnId::flags,     ColumnId::hip_x,     ColumnId::hip_y,
            ColumnId::hip_z,       ColumnId::command_x, ColumnId::command_y, ColumnId::command_z};
        const ChunkReader reader(chunk);
        stored_.resize(chunk.ticks);
        exact_.resize(chunk.ticks);
        const bool flat = std::ranges::all_of(ticks, [](const TickRecord& tick) {
            return tick.hip.z == 0.0 && tick.command.z == 0.0;
        });
        for (const ColumnId column : kReadable) {
            if (flat && (column == ColumnId::hip_z || column == ColumnId::command_z) &&
                reader.all_zero(column)) {
                continue;
            }
            reader.read(column, stored_);
            stored_values(column, ticks, exact_);
            if (stored_ != exact_) {
                const auto wrong = std::ranges::mismatch(stored_, exact_);
                const auto at = static_cast<std::size_t>(wrong.in1 - stored_.begin());
                differs_from(ticks[at].tick,
                             fmt::format("trace.{}",
                                         stored_columns()[static_cast<std::size_t>(column)].name),
                             fmt::format("{}", *wrong.in1), fmt::format("{}", *wrong.in2),
                             findings_);
            }
        }
    }

    std::span<const ChunkView> chunks_;
    ChunkReplay replay_;
    std::int64_t period_ns_;
    Findings& findings_;
    std::int64_t next_ = 0;  ///< tick after the last good chunk
    bool another_hash_ = false;
    std::vector<std::int64_t> stored_;
    std::vector<std::int64_t> exact_;
};

}  // namespace

StoredTrace check_trace(std::span<const ChunkView> chunks,
                        const engine::SceneView& scene,
                        const std::optional<engine::PantographSpec>& machine,
                        std::int64_t period_ns,
                        Findings& findings,
                        Ticks room) {
    return TraceCheck(chunks, scene, machine, period_ns, findings, std::move(room)).run();
}

}  // namespace palpate::data

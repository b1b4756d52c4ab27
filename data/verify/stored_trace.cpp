#include "data/verify/stored_trace.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <span>

#include <fmt/format.h>

#include "engine/realtime/felt_scene.hpp"
#include "data/trace/chunk.hpp"
#include "data/trace/chunk_replay.hpp"
#include "data/trace/column_codec.hpp"
#include "data/trace/columns.hpp"
#include "data/trace/derived_hash.hpp"
#include "data/trace/retrace.hpp"

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

namespace {

using engine::TickRecord;

template <class T>
bool equal_bits(const T& a, const T& b) noexcept {
    return std::memcmp(&a, &b, sizeof a) == 0;
}

std::string text_of(const engine::Vec3& v) {
    return fmt::format("({}, {}, {})", v.x, v.y, v.z);
}
std::string text_of(double value) {
    return fmt::format("{}", value);
}

/// Columns that follow from HIP, by what they are called in the trace.
struct Column {
    const char* name;
    bool (*same)(const TickRecord& stored, const TickRecord& again) noexcept;
    std::string (*text)(const TickRecord& tick);
};

template <auto Field>
bool same_field(const TickRecord& stored, const TickRecord& again) noexcept {
    return equal_bits(stored.*Field, again.*Field);
}
template <auto Field>
std::string field_text(const TickRecord& tick) {
    return text_of(tick.*Field);
}
template <auto Field>
constexpr Column column(const char* name) {
    return {name, same_field<Field>, field_text<Field>};
}

constexpr std::array kColumns{
    column<&TickRecord::force>("trace.force"),
    column<&TickRecord::go>("trace.go"),
    column<&TickRecord::mu>("trace.mu"),
    column<&TickRecord::normal_force>("trace.rendered_normal_n"),
    column<&TickRecord::tangential_force>("trace.rendered_tangential_n"),
    column<&TickRecord::u>("trace.u"),
    column<&TickRecord::v>("trace.v"),
    Column{"trace.segment", same_field<&TickRecord::segment>,
           [](const TickRecord& tick) {
               return fmt::format("{}", tick.segment);
           }},
    Column{"trace.mode", same_field<&TickRecord::mode>,
           [](const TickRecord& tick) {
               return std::string(to_string(tick.mode));
           }},
    Column{"trace.flags",
           [](const TickRecord& stored, const TickRecord& again) noexcept {
               return (stored.flags & engine::kSceneFlags) == (again.flags & engine::kSceneFlags);
           },
           [](const TickRecord& tick) {
               return fmt::format("{}", tick.flags & engine::kSceneFlags);
           }},
};

}  // namespace

void check_replay(const engine::SceneView& scene, const StoredTrace& trace, Findings& findings) {
    if (!trace.holds_contacts) {
        return;
    }
    std::array<Finding, kColumns.size()> found;
    for (Finding& finding : found) {
        finding.count = 0;
    }
    engine::FeltState state;
    for (const TickRecord& tick : trace.ticks) {
        TickRecord again;
        again.hip = tick.hip;
        engine::set_contacts(std::span(&again, 1), scene, state);
        for (std::size_t i = 0; i < kColumns.size(); ++i) {
            if (kColumns[i].same(tick, again) || found[i].count++ > 0) {
                continue;
            }
            found[i].tick = tick.tick;
            found[i].what = kColumns[i].name;
            found[i].stored = kColumns[i].text(tick);
            found[i].recomputed = kColumns[i].text(again);
        }
    }
    for (Finding& finding : found) {
        if (finding.count > 0) {
            findings.add(std::move(finding));
        }
    }
}

void check_counts(const engine::Gantry& gantry, const StoredTrace& trace, Findings& findings) {
    Finding finding;
    finding.what = "trace.hip";
    finding.count = 0;
    std::optional<engine::Vec3> before;
    for (const TickRecord& tick : trace.ticks) {
        const auto there = gantry.locate(tick.counts);
        const bool none = !there || tick.counts == engine::Gantry::Counts{};
        const bool kept = none && (!before || tick.hip == *before);
        before = tick.hip;
        if (kept || (there && *there == tick.hip) || finding.count++ > 0) {
            continue;
        }
        finding.tick = tick.tick;
        finding.stored = text_of(tick.hip);
        finding.recomputed = there ? text_of(*there) : "outside the workspace";
    }
    if (finding.count > 0) {
        findings.add(std::move(finding));
    }
}

bool on_virtual_clock(const StoredTrace& trace) noexcept {
    return std::all_of(trace.ticks.begin(), trace.ticks.end(),
                       [](const TickRecord& tick) { return tick.lateness_us == 0.0F; });
}

void check_times(const StoredTrace& trace, std::int64_t period_ns, Findings& findings) {
    const bool is_virtual = on_virtual_clock(trace);
    std::int64_t before = 0;
    for (const TickRecord& tick : trace.ticks) {
        const std::int64_t due = tick.tick * period_ns;
        if (is_virtual ? tick.time_ns != due : tick.time_ns < before) {
            findings.add({.kind = FindingKind::differs,
                          .trial = {},
                          .tick = tick.tick,
                          .what = "trace.time_s",
                          .stored = fmt::format("{}", seconds_of(tick.time_ns)),
                          .recomputed = is_virtual ? fmt::format("{}", due)
                                                   : fmt::format("at least {}", before)});
            return;
        }
        before = tick.time_ns;
    }
}

}  // namespace palpate::data

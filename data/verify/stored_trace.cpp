#include <algorithm>
#include <array>
#include <cstring>
#include <iterator>
#include <optional>
#include <span>
#include <variant>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "engine/realtime/felt_scene.hpp"
#include "data/trace/chunk.hpp"
#include "data/trace/chunk_replay.hpp"
#include "data/trace/column_codec.hpp"
#include "data/trace/columns.hpp"
#include "data/trace/retrace.hpp"
#include "data/verify/trial_check.hpp"

namespace palpate::data {
namespace {

using engine::TickRecord;

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
                findings_.differs("trace_chunk", e.what(),
                                  fmt::format("nothing is replayed from tick {} on", next_),
                                  chunks_[i].first_tick);
                trace.whole = false;
            }
        }
        trace.ticks = replay_.take();
        trace.ticks.resize(static_cast<std::size_t>(next_));
        trace.on_virtual_clock = never_late_;
        trace.punctual = punctual_;
        return trace;
    }

private:
    /// @throws TraceError what is wrong with a chunk that should follow next_ ticks
    void check(std::size_t i) {
        const ChunkView& chunk = chunks_[i];
        refuse_if<TraceError>(i > 0 && chunks_[i - 1].ticks != kChunkTicks,
                              "the one before it is not full: it ends before {}", next_);
        const std::int64_t first = chunk.first_tick;
        refuse_if<TraceError>(first > next_, "ticks {} to {} are missing", next_, first - 1);
        refuse_if<TraceError>(first < next_, "it begins with tick {} again", first);
        refuse_if<TraceError>(chunk.period_ns != period_ns_, "its period is {} ns, not {}",
                              chunk.period_ns, period_ns_);
        const ChunkReplay::Again again = replay_.chunk(i);
        const Look look = look_at(*again.columns, again.ticks);
        if (!look.right) {
            require_order(again.ticks);
            check_readable(*again.columns, again.ticks);
        }
        never_late_ = never_late_ && look.never_late;
        punctual_ = punctual_ && look.punctual;
        next_ += static_cast<std::int64_t>(again.ticks.size());
        if (!again.as_recorded && !another_hash_) {
            another_hash_ = true;
            findings_.differs("trace_chunk.derived", "the hash of what the servo had",
                              "another one by replay", first);
        }
    }

    /// All that is asked of a chunk's ticks, at once.
    struct Look {
        bool right;  ///< in order, in the plane, and readable as they are; else it is asked again
        bool never_late;
        bool punctual;  ///< by whole periods
    };
    Look look_at(const ChunkReader& reader, std::span<const TickRecord> ticks) {
        for (std::size_t i = 0; i < kInPlane.size(); ++i) {
            columns_[i].resize(ticks.size());
            reader.read(kInPlane[i], columns_[i]);
        }
        const auto& [hip_x, hip_y, command_x, command_y, flags, lateness] = columns_;
        // These are the steps of a value: see in_steps().
        const auto are = [](std::int32_t steps, double value, double per_unit) {
            const double exact = value * per_unit + 0.5;
            return unsigned{steps <= exact} & unsigned{exact < steps + 1.0};
        };
        unsigned right = unsigned{reader.all_zero(ColumnId::hip_z)} &
                         unsigned{reader.all_zero(ColumnId::command_z)};
        unsigned never_late = 1;
        unsigned punctual = 1;
        for (std::size_t i = 0; i < ticks.size(); ++i) {
            const TickRecord& tick = ticks[i];
            const std::int64_t due = next_ + static_cast<std::int64_t>(i);
            right &= unsigned{tick.tick == due} & unsigned{tick.flags == flags[i]} &
                     are(hip_x[i], tick.hip.x, kHipSteps) & are(hip_y[i], tick.hip.y, kHipSteps) &
                     are(command_x[i], tick.command.x, kCommandSteps) &
                     are(command_y[i], tick.command.y, kCommandSteps) &
                     are(lateness[i], static_cast<double>(tick.lateness_us), kLatenessSteps) &
                     unsigned{tick.hip.z == 0.0} & unsigned{tick.command.z == 0.0};
            never_late &= unsigned{tick.lateness_us == 0.0F};
            punctual &= unsigned{tick.time_ns == due * period_ns_};
        }
        return {right != 0, never_late != 0, punctual != 0};
    }

    void require_order(std::span<const TickRecord> ticks) const {
        for (std::int64_t due = next_; const TickRecord& tick : ticks) {
            refuse_if<TraceError>(tick.tick != due, "tick {} stands where tick {} belongs",
                                  tick.tick, due);
            ++due;
        }
    }

    /// What everybody can read must be what the exact numbers say. The other columns are the ticks'
    /// own.
    void check_readable(const ChunkReader& reader, std::span<const TickRecord> ticks) {
        std::vector<std::int64_t> stored(ticks.size());
        std::vector<std::int64_t> exact(ticks.size());
        for (const ColumnId column : kReadable) {
            reader.read(column, stored);
            stored_values(column, ticks, exact);
            if (stored != exact) {
                const auto wrong = std::ranges::mismatch(stored, exact);
                const auto at = static_cast<std::size_t>(wrong.in1 - stored.begin());
                findings_.differs(
                    fmt::format("trace.{}",
                                stored_columns()[static_cast<std::size_t>(column)].name),
                    fmt::format("{}", *wrong.in1), fmt::format("{}", *wrong.in2), ticks[at].tick);
            }
        }
    }

    static constexpr std::array kReadable{
        ColumnId::lateness_ns, ColumnId::flags,     ColumnId::hip_x,     ColumnId::hip_y,
        ColumnId::hip_z,       ColumnId::command_x, ColumnId::command_y, ColumnId::command_z};
    /// Those of sessions in the plane.
    static constexpr std::array kInPlane{ColumnId::hip_x,     ColumnId::hip_y,
                                         ColumnId::command_x, ColumnId::command_y,
                                         ColumnId::flags,     ColumnId::lateness_ns};

    std::span<const ChunkView> chunks_;
    ChunkReplay replay_;
    std::int64_t period_ns_;
    Findings& findings_;
    std::int64_t next_ = 0;  ///< tick after the last good chunk
    bool another_hash_ = false;
    bool never_late_ = true;
    bool punctual_ = true;
    std::array<std::vector<std::int32_t>, kInPlane.size()> columns_;
};

std::string text_of(const engine::Vec3& v) {
    return fmt::format("({}, {}, {})", v.x, v.y, v.z);
}
std::string text_of(const TickValue& value) {
    return std::visit([](const auto& one) { return fmt::format("{}", one); }, value);
}

/// Columns of a tick that follow from HIP: what a chunk holds where they do not, and the flags.
std::vector<TraceColumn> columns_of_contacts() {
    const auto holds = [](const TraceColumn& column) {
        return column.name == "flags" ||
               std::ranges::any_of(stored_columns(), [&column](const StoredColumn& stored) {
                   return stored.name == column.name && stored.part == part_contact;
               });
    };
    std::vector<TraceColumn> columns;
    std::ranges::copy_if(trace_columns(), std::back_inserter(columns), holds);
    return columns;
}

bool equal_bits(const TraceColumn& column, const TickRecord& a, const TickRecord& b) noexcept {
    const auto at = [&column](const TickRecord& tick) {
        return reinterpret_cast<const std::byte*>(&tick) + column.offset;
    };
    return std::memcmp(at(a), at(b), column.size) == 0;
}

}  // namespace

StoredTrace check_trace(std::span<const ChunkView> chunks,
                        const engine::SceneView& scene,
                        const std::optional<engine::PantographSpec>& machine,
                        std::int64_t period_ns,
                        Findings& findings,
                        Ticks room) {
    return TraceCheck(chunks, scene, machine, period_ns, findings, std::move(room)).run();
}

void check_replay(const engine::SceneView& scene, const StoredTrace& trace, Findings& findings) {
    if (!trace.holds_contacts) {
        return;
    }
    const std::vector<TraceColumn> columns = columns_of_contacts();
    std::vector<Finding> found(columns.size(), Finding{.what = {}, .recomputed = {}, .count = 0});
    engine::FeltState state;
    for (const TickRecord& tick : trace.ticks) {
        TickRecord again;
        again.hip = tick.hip;
        engine::set_contacts(std::span(&again, 1), scene, state);
        constexpr unsigned kScene = engine::kSceneFlags;
        again.flags = static_cast<std::uint8_t>((tick.flags & ~kScene) | (again.flags & kScene));
        for (std::size_t i = 0; i < columns.size(); ++i) {
            const TraceColumn& column = columns[i];
            if (equal_bits(column, tick, again) || found[i].count++ > 0) {
                continue;
            }
            found[i].tick = tick.tick;
            found[i].what = fmt::format("trace.{}", column.name);
            found[i].stored = text_of(column.value(tick));
            found[i].recomputed = text_of(column.value(again));
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

void check_times(const StoredTrace& trace, std::int64_t period_ns, Findings& findings) {
    const bool is_virtual = trace.on_virtual_clock;
    if (is_virtual && trace.punctual) {
        return;
    }
    std::int64_t before = 0;
    for (const TickRecord& tick : trace.ticks) {
        const std::int64_t due = tick.tick * period_ns;
        if (is_virtual ? tick.time_ns != due : tick.time_ns < before) {
            findings.differs(
                "trace.time_s", fmt::format("{}", seconds_of(tick.time_ns)),
                fmt::format("{}{}", is_virtual ? "" : "at least ", is_virtual ? due : before),
                tick.tick);
            return;
        }
        before = tick.time_ns;
    }
}

}  // namespace palpate::data

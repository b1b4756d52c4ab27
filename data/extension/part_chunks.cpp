#include <algorithm>
#include <string_view>

#include <fmt/format.h>
#include <sqlite3ext.h>

#include "engine/base/refuse.hpp"
#include "data/extension/sample_cursor.hpp"
#include "data/trace/columns.hpp"
#include "data/trace/replay.hpp"
#include "data/trace/retrace.hpp"
#include "data/trace/ticks.hpp"

SQLITE_EXTENSION_INIT3

namespace palpate::data {

void fail_asking(const Connection& connection, std::string_view doing) {
    throw SampleError(fmt::format("{}: {}",
                                  doing.starts_with("preparing")
                                      ? "this is not a palpate database, or a damaged one"
                                  : doing.starts_with("giving") ? "asking for ticks"
                                                                : "reading ticks",
                                  sqlite3_errmsg(connection.handle)));
}

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

PartChunks::PartChunks(const Connection& db, const TrialPart& part)
    : part_(part),
      rows_(db,
            "SELECT first_tick, ticks, codec, crc32, period_ns, holds, derived, data FROM "
            "main.trace_chunk WHERE trial_id = ?1 AND interval = ?2 AND first_tick = ?3") {
    std::vector<std::int64_t> counts;
    for (Statement heads(db,
                         "SELECT first_tick, ticks FROM main.trace_chunk WHERE trial_id = ?1 AND "
                         "interval = ?2 ORDER BY first_tick",
                         part.trial, part.interval);
         heads.step();) {
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

using engine::TickRecord;

class StoredBlocks {
public:
    StoredBlocks(const Connection& db,
                 const TrialPart& part,
                 SampleColumns columns,
                 const TickRange& range,
                 const SessionTraces* session)
        : part_(part),
          columns_(columns | bits_of({"tick"})),  // every row has its number
          range_(range),
          chunks_(db, part),
          in_space_(session != nullptr && session->in_space()) {
        if (session != nullptr && session->machine()) {
            hip_.emplace(*session->machine());
        }
        if (range.to_s < kNoTime || range.from_s > -kNoTime) {
            columns_ |= bits_of({"time_s"});
        }
        next_ = of_part(part_, [this] { return first_chunk(); });
    }

    std::span<const TickRecord> next() {
        if (next_ == chunks_.size() || chunks_.first_tick(next_) > range_.last) {
            return {};
        }
        of_part(part_, [this] { load(chunks_.at(next_++)); });
        return ticks_in(ticks_, range_);
    }

private:
    static constexpr double kNoTime = 1e299;

    /// The last chunk that begins at or before the first tick wanted; with velocities, at the one
    /// before. A chunk's ticks may jump, but never beyond the next chunk; nor does time go back.
    std::size_t first_chunk() {
        const std::int64_t lead = (columns_ & kVelocityColumns) != 0 ? 1 : 0;
        std::size_t low = 0;
        std::size_t high = chunks_.size();
        while (high - low > 1) {
            const std::size_t middle = low + (high - low) / 2;
            const bool early = chunks_.first_tick(middle) + lead <= range_.first ||
                               (range_.from_s > -kNoTime && begins_before(middle));
            (early ? low : high) = middle;
        }
        return low;
    }

    /// Its second tick is not after the range begins, so that the one before that is in it too.
    bool begins_before(std::size_t i) {
        const PartChunk chunk = chunks_.at(i);
        std::vector<std::int64_t> times(chunk.view.ticks);
        ChunkReader(chunk.view).read(ColumnId::time_ns, times);
        return times.size() > 1 && seconds_of(times[1]) < range_.from_s;
    }

    [[nodiscard]] bool wants(SampleColumns columns) const noexcept {
        return (columns_ & columns) != 0;
    }

    void load(const PartChunk& chunk) {
        ChunkReader reader(chunk.view);
        ticks_.resize(chunk.view.ticks);
        values_.resize(chunk.view.ticks);
        load_numbers(reader);
        load_lateness(reader);
        if (wants(kHipColumns)) {
            load_hip(reader);
        }
    }

    template <class Set>
    void each(ChunkReader& reader, ColumnId column, SampleColumns wanted, const Set& set) {
        if (!wants(wanted)) {
            return;
        }
        reader.read(column, values_);
        for (std::size_t i = 0; i < ticks_.size(); ++i) {
            set(ticks_[i], values_[i]);
        }
    }

    void load_numbers(ChunkReader& reader) {
        const auto small = [](std::int64_t value) {
            return static_cast<std::int32_t>(value);
        };
        each(reader, ColumnId::tick, bits_of({"tick"}),
             [](TickRecord& t, std::int64_t v) { t.tick = v; });
        each(reader, ColumnId::time_ns, bits_of({"time_s"}) | kVelocityColumns,
             [](TickRecord& t, std::int64_t v) { t.time_ns = v; });
        each(reader, ColumnId::count_1, bits_of({"count_1"}) | kHipColumns,
             [&](TickRecord& t, std::int64_t v) { t.counts[0] = small(v); });
        each(reader, ColumnId::count_2, bits_of({"count_2"}) | kHipColumns,
             [&](TickRecord& t, std::int64_t v) { t.counts[1] = small(v); });
        each(reader, ColumnId::code_1, bits_of({"code_1"}),
             [&](TickRecord& t, std::int64_t v) { t.codes[0] = small(v); });
        each(reader, ColumnId::code_2, bits_of({"code_2"}),
             [&](TickRecord& t, std::int64_t v) { t.codes[1] = small(v); });
        each(reader, ColumnId::count_3, bits_of({"count_3"}),
             [&](TickRecord& t, std::int64_t v) { t.counts[2] = small(v); });
        each(reader, ColumnId::code_3, bits_of({"code_3"}),
             [&](TickRecord& t, std::int64_t v) { t.codes[2] = small(v); });
        each(reader, ColumnId::flags, bits_of({"flags"}),
             [](TickRecord& t, std::int64_t v) { t.flags = static_cast<std::uint8_t>(v); });
        each(reader, ColumnId::command_x, bits_of({"commanded_x_n"}),
             [](TickRecord& t, std::int64_t v) { t.command.x = steps_in_newton(v); });
        each(reader, ColumnId::command_y, bits_of({"commanded_y_n"}),
             [](TickRecord& t, std::int64_t v) { t.command.y = steps_in_newton(v); });
        each(reader, ColumnId::command_z, bits_of({"commanded_z_n"}),
             [](TickRecord& t, std::int64_t v) { t.command.z = steps_in_newton(v); });
    }

    void load_lateness(ChunkReader& reader) {
        each(reader, ColumnId::lateness_ns, bits_of({"lateness_us"}),
             [](TickRecord& t, std::int64_t v) { t.lateness_us = lateness_us(v); });
        if (wants(bits_of({"lateness_us"})) && (reader.chunk().parts & part_lateness) != 0) {
            load_exact(reader, &TickRecord::lateness_us);
        }
    }

    template <class Field>
    void load_exact(const ChunkReader& reader, Field TickRecord::*field) {
        exact_.resize(ticks_.size());
        reader.read_exact(exact_);
        for (std::size_t i = 0; i < ticks_.size(); ++i) {
            ticks_[i].*field = exact_[i].*field;
        }
    }

    /// HIP as the device had it, which is what the fixed-point columns say to 0.1 um.
    void load_hip(ChunkReader& reader) {
        if ((reader.chunk().parts & part_hip) != 0) {
            load_exact(reader, &TickRecord::hip);
        } else if (!hip_ && !in_space_) {
            throw TraceError(
                "HIP follows from the encoder counts by a calibration that the session has not");
        } else if (hip_) {
            counts_.resize(ticks_.size());
            hips_.resize(ticks_.size());
            std::ranges::transform(ticks_, counts_.begin(), &TickRecord::counts);
            hip_->at(counts_, hips_);
            for (std::size_t i = 0; i < ticks_.size(); ++i) {
                ticks_[i].hip = engine::Vec3(hips_[i], 0.0);
            }
        }
        compare_hip(reader, (reader.chunk().parts & part_hip) == 0 && !hip_);
    }

    /// @param steps  HIP is what these columns say; else they must say what HIP is
    void compare_hip(ChunkReader& reader, bool steps) {
        const auto axis = [&](ColumnId column, auto&& place) {
            reader.read(column, values_);
            for (std::size_t i = 0; i < ticks_.size(); ++i) {
                if (steps) {
                    place(ticks_[i]) = steps_in_metres(values_[i]);
                } else if (in_steps(place(ticks_[i]), kHipSteps) != values_[i]) {
                    throw SampleError(replay_sentence(part_.trial, reader.chunk().first_tick));
                }
            }
        };
        axis(ColumnId::hip_x, [](TickRecord& tick) -> double& { return tick.hip.x; });
        axis(ColumnId::hip_y, [](TickRecord& tick) -> double& { return tick.hip.y; });
        axis(ColumnId::hip_z, [](TickRecord& tick) -> double& { return tick.hip.z; });
    }

    TrialPart part_;
    SampleColumns columns_;
    TickRange range_;
    PartChunks chunks_;
    bool in_space_;
    std::optional<HipFromCounts> hip_;
    std::size_t next_ = 0;
    Ticks ticks_;  ///< the fields of columns that are read
    std::vector<TickRecord> exact_;
    std::vector<std::int64_t> values_;
    std::vector<engine::Pantograph::Counts> counts_;
    std::vector<engine::Vec2> hips_;
};

}  // namespace

void PartChunks::require_all(const Connection& db, const std::vector<std::int64_t>& counts) {
    Statement stored(
        db,
        "SELECT session.session_id, rate_hz, felt.ticks FROM main.trial JOIN "
        "main.presentation AS felt ON felt.trial_id = trial.trial_id AND felt.interval = ?2 "
        "JOIN main.session USING (session_id) WHERE trial.trial_id = ?1",
        part_.trial, part_.interval);
    if (!stored.step()) {
        fail(part_, "it has ticks, but no row in trial and presentation");
    }
    period_ns_ = engine::tick_period_ns(stored.real(1));
    // NULL, of a trial that did not end, is 0.
    const std::string missing = gap_in(first_ticks_, counts, stored.integer(2));
    if (missing.empty()) {
        return;
    }
    Statement lost(
        db,
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
    refuse_if<TraceError>(chunk.view.ticks == 0, "the chunk of tick {} has no ticks",
                          first_ticks_[i]);
    refuse_if<TraceError>(chunk.view.period_ns != period_ns_,
                          "the chunk of tick {} has a period of {} ns, not {}", first_ticks_[i],
                          chunk.view.period_ns, period_ns_);
    return chunk;
}

TickBlocks stored_blocks(const Connection& db,
                         const TrialPart& part,
                         SampleColumns columns,
                         const TickRange& range,
                         const SessionTraces* session) {
    return [blocks = std::make_shared<StoredBlocks>(db, part, columns, range, session)] {
        return blocks->next();
    };
}

}  // namespace palpate::data

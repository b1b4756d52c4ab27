#include "data/extension/stored_blocks.hpp"

#include "data/extension/part_chunks.hpp"
#include "data/trace/chunk.hpp"
#include "data/trace/columns.hpp"
#include "data/trace/replay.hpp"
#include "data/trace/retrace.hpp"
#include "data/trace/ticks.hpp"

namespace palpate::data {
namespace {

using engine::TickRecord;
using C = SampleColumn;

constexpr SampleColumns kTime = bit(C::time_s) | kVelocityColumns;

class StoredBlocks : public TickBlocks {
public:
    StoredBlocks(StatementCache& db,
                 const TrialPart& part,
                 SampleColumns columns,
                 const TickRange& range,
                 const HipSource& source)
        : part_(part),
          columns_(columns | bit(C::tick)),  // every row has its number
          range_(range),
          chunks_(db, part),
          in_space_(source.in_space) {
        if (source.machine && (columns & kHipColumns) != 0) {
            hip_.emplace(*source.machine);
        }
        if (range.to_s < kNoTime || range.from_s > -kNoTime) {
            columns_ |= bit(C::time_s);
        }
        next_ = of_part(part_, [this] { return first_chunk(); });
    }

    std::span<const TickRecord> next() override {
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
        read_stored(chunk.view, ColumnId::time_ns, times);
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
        each(reader, ColumnId::tick, bit(C::tick),
             [](TickRecord& t, std::int64_t v) { t.tick = v; });
        each(reader, ColumnId::time_ns, kTime,
             [](TickRecord& t, std::int64_t v) { t.time_ns = v; });
        each(reader, ColumnId::count_1, bit(C::count_1) | kHipColumns,
             [&](TickRecord& t, std::int64_t v) { t.counts[0] = small(v); });
        each(reader, ColumnId::count_2, bit(C::count_2) | kHipColumns,
             [&](TickRecord& t, std::int64_t v) { t.counts[1] = small(v); });
        each(reader, ColumnId::code_1, bit(C::code_1),
             [&](TickRecord& t, std::int64_t v) { t.codes[0] = small(v); });
        each(reader, ColumnId::code_2, bit(C::code_2),
             [&](TickRecord& t, std::int64_t v) { t.codes[1] = small(v); });
        each(reader, ColumnId::count_3, bit(C::count_3),
             [&](TickRecord& t, std::int64_t v) { t.counts[2] = small(v); });
        each(reader, ColumnId::code_3, bit(C::code_3),
             [&](TickRecord& t, std::int64_t v) { t.codes[2] = small(v); });
        each(reader, ColumnId::flags, bit(C::flags),
             [](TickRecord& t, std::int64_t v) { t.flags = static_cast<std::uint8_t>(v); });
        each(reader, ColumnId::command_x, bit(C::commanded_x_n),
             [](TickRecord& t, std::int64_t v) { t.command.x = steps_in_newton(v); });
        each(reader, ColumnId::command_y, bit(C::commanded_y_n),
             [](TickRecord& t, std::int64_t v) { t.command.y = steps_in_newton(v); });
        each(reader, ColumnId::command_z, bit(C::commanded_z_n),
             [](TickRecord& t, std::int64_t v) { t.command.z = steps_in_newton(v); });
    }

    void load_lateness(ChunkReader& reader) {
        each(reader, ColumnId::lateness_ns, bit(C::lateness_us),
             [](TickRecord& t, std::int64_t v) { t.lateness_us = lateness_us(v); });
        if (wants(bit(C::lateness_us)) && (reader.chunk().parts & part_lateness) != 0) {
            exact_.resize(ticks_.size());
            reader.read_exact(exact_);
            for (std::size_t i = 0; i < ticks_.size(); ++i) {
                ticks_[i].lateness_us = exact_[i].lateness_us;
            }
        }
    }

    /// HIP as the device had it, which is what the fixed-point columns say to 0.1 um.
    void load_hip(ChunkReader& reader) {
        if ((reader.chunk().parts & part_hip) != 0) {
            exact_.resize(ticks_.size());
            reader.read_exact(exact_);
            for (std::size_t i = 0; i < ticks_.size(); ++i) {
                ticks_[i].hip = exact_[i].hip;
            }
        } else if (!hip_ && !in_space_) {
            throw TraceError(
                "HIP follows from the encoder counts by a calibration that the session has not");
        } else if (hip_) {
            counts_.resize(ticks_.size());
            hips_.resize(ticks_.size());
            for (std::size_t i = 0; i < ticks_.size(); ++i) {
                counts_[i] = ticks_[i].counts;
            }
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

std::unique_ptr<TickBlocks> stored_blocks(StatementCache& db,
                                          const TrialPart& part,
                                          SampleColumns columns,
                                          const TickRange& range,
                                          const HipSource& source) {
    return std::make_unique<StoredBlocks>(db, part, columns, range, source);
}

}  // namespace palpate::data

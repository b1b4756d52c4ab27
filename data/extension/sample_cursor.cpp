#include "data/extension/sample_cursor.hpp"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "engine/realtime/felt_scene.hpp"
#include "data/trace/chunk.hpp"
#include "data/trace/chunk_replay.hpp"

namespace palpate::data {

using engine::TickRecord;

SampleColumns bits_of(std::initializer_list<std::string_view> names) {
    std::vector<std::string_view> columns{"trial_id", "interval"};
    std::ranges::transform(trace_columns(), std::back_inserter(columns), &TraceColumn::name);
    columns.insert(columns.end(), {"hip_vx_m_per_s", "hip_vy_m_per_s", "hip_vz_m_per_s"});
    SampleColumns bits = 0;
    for (const std::string_view name : names) {
        for (std::size_t i = 0; i < columns.size(); ++i) {
            const bool meant =
                name.ends_with('_') ? columns[i].starts_with(name) : columns[i] == name;
            bits |= SampleColumns{meant} << i;
        }
    }
    return bits;
}

/// The ticks of a part that follow from the hand's path from tick 0 on, replayed as far as somebody
/// asks.
class PartReplay {
public:
    PartReplay(const TrialPart& part,
               std::vector<std::vector<std::byte>> bytes,
               std::span<const ChunkView> chunks,
               std::shared_ptr<const engine::FeltScene> scene,
               const std::optional<engine::PantographSpec>& machine,
               Ticks room,
               ChunkReplay::Keeps keeps)
        : part_(part),
          bytes_(std::move(bytes)),
          scene_(std::move(scene)),
          replay_(machine, scene_.get(), chunks, true, std::move(room), keeps),
          keeps_all_(keeps == ChunkReplay::Keeps::all) {
        for (const ChunkView& chunk : chunks) {
            first_ticks_.push_back(chunk.first_tick);
            ticks_ += keeps_all_ ? chunk.ticks : 0;
        }
    }

    [[nodiscard]] std::size_t chunks() const noexcept { return first_ticks_.size(); }
    /// How many stay; 0: whoever goes over them does so once.
    [[nodiscard]] std::size_t ticks() const noexcept { return ticks_; }
    [[nodiscard]] bool keeps_all() const noexcept { return keeps_all_; }
    /// Its memory, for another. @pre nobody asks it again
    [[nodiscard]] Ticks take_room() noexcept { return replay_.take(); }
    /// Nobody is to be given this one again: the rows may be mended.
    void gives_up() noexcept { given_up_ = true; }
    [[nodiscard]] bool is_of(const TrialPart& part,
                             const std::vector<std::vector<std::byte>>& bytes) const {
        const auto same = [](const auto& a, const auto& b) {  // == goes byte by byte
            return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size()) == 0;
        };
        return !given_up_ && part_ == part && std::ranges::equal(bytes_, bytes, same);
    }

    /// @throws SampleError if the ticks are not what was recorded, TraceError if they are damaged
    std::span<const TickRecord> chunk(std::size_t i, bool closest) {
        const std::span<TickRecord> ticks = checked(i);
        for (; closest && with_closest_ <= i; ++with_closest_) {
            find_closest_points(*scene_, track_, checked(with_closest_));
        }
        return ticks;
    }

private:
    std::span<TickRecord> checked(std::size_t i) {
        const ChunkReplay::Again again = replay_.chunk(i);
        if (!again.as_recorded) {
            throw SampleError(replay_sentence(part_.trial, first_ticks_[i]));
        }
        return again.ticks;
    }

    TrialPart part_;
    std::vector<std::vector<std::byte>> bytes_;  ///< what it is made of
    std::shared_ptr<const engine::FeltScene> scene_;
    ChunkReplay replay_;
    bool keeps_all_;
    std::vector<std::int64_t> first_ticks_;
    std::size_t ticks_ = 0;
    std::size_t with_closest_ = 0;  ///< the first chunk without closest points
    engine::FeltTrack track_;
    bool given_up_ = false;
};

TickStore::Context TickStore::context_of(const TrialPart& part) {
    Statement row(
        db_,
        "SELECT coalesce(felt.felt_object, plan.planned_object), coalesce(felt.friction, "
        "plan.friction), coalesce(felt.slip_decay, 0), "
        "coalesce(felt.heal_decay, 0), felt.curvature_per_m, felt.mu_s, "
        "felt.mu_d, felt.stimulus, study.protocol_toml, (SELECT value FROM "
        "main.session_provenance AS p "
        "WHERE p.session_id = session.session_id AND p.key = 'calibration') FROM main.trial "
        "JOIN main.plan USING (session_id, plan_position) JOIN main.session USING "
        "(session_id) JOIN main.study USING (study_id) LEFT JOIN main.presentation AS felt "
        "ON felt.trial_id = trial.trial_id AND felt.interval = ?2 WHERE trial.trial_id = ?1",
        part.trial, part.interval);
    if (!row.step()) {
        fail(part, "it has ticks, but no row in trial");
    }
    const std::pair key(row.text(8), row.text(9));
    auto session = sessions_.find(key);
    if (session == sessions_.end()) {
        session = sessions_.emplace(key, SessionTraces(key.first, key.second)).first;
    }
    return {.trial = {.object = row.text(0),
                      .friction = row.text(1),
                      .slip_decay = row.real(2),
                      .heal_decay = row.real(3),
                      .curvature = row.real_or_none(4),
                      .mu_s = row.real_or_none(5),
                      .mu_d = row.real_or_none(6),
                      .stimulus = row.real_or_none(7)},
            .session = &session->second};
}

std::shared_ptr<PartReplay> TickStore::replayed(const TrialPart& part) {
    PartChunks rows(db_, part);
    std::vector<std::vector<std::byte>> bytes;
    std::vector<ChunkView> views;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        PartChunk chunk = rows.at(i);
        views.push_back(chunk.view);
        bytes.push_back(std::move(chunk.bytes));  // the view looks at the same bytes
    }
    const auto same =
        std::ranges::find_if(kept_, [&](const auto& one) { return one->is_of(part, bytes); });
    const bool again = same != kept_.end();
    const bool stays = again || asked_again_;
    asked_again_ = again;
    if (again && (*same)->keeps_all()) {
        std::rotate(same, same + 1, kept_.end());
        return kept_.back();
    }
    if (again) {  // whoever goes over it goes on
        kept_.erase(same);
    }
    Ticks room = make_room();
    const Context context = context_of(part);
    kept_.push_back(std::make_shared<PartReplay>(
        part, std::move(bytes), views, context.session->scene_of(context.trial),
        context.session->machine(), std::move(room),
        stays ? ChunkReplay::Keeps::all : ChunkReplay::Keeps::last));
    return kept_.back();
}

/// For one more: of a long trial none is kept beside it. @return the memory of one that went
Ticks TickStore::make_room() {
    constexpr std::size_t kMaxParts = 4;
    constexpr std::size_t kMaxTicks = 400'000;  // 60 MB
    const auto ticks = [this] {
        std::size_t sum = 0;
        for (const auto& one : kept_) {
            sum += one->ticks();
        }
        return sum;
    };
    Ticks room;
    while (kept_.size() >= kMaxParts || ticks() > kMaxTicks) {
        if (kept_.front().use_count() == 1) {
            room = kept_.front()->take_room();
        }
        kept_.erase(kept_.begin());
    }
    return room;
}

/// SQLite does not tell a table of this kind which database was named: b.sample would be main's
/// ticks.
void TickStore::require_one_study() {
    // Statements: a table of the file may be called pragma_database_list.
    for (Statement others(db_, "PRAGMA database_list"); others.step();) {
        const std::string name = others.text(1);
        refuse_if<SampleError>(
            name != "main" && name != "temp" &&
                Statement(db_, "PRAGMA " + in_quotes(name) + ".table_info(trace_chunk)").step(),
            "sample is of the file that was opened first, and another palpate database is "
            "attached: DETACH {}, and ask each by itself",
            name);
    }
}

std::vector<TrialPart> TickStore::parts(const TrialRange& trials) {
    require_one_study();
    // A part whose chunks are gone is one too: it is refused.
    Statement part(
        db_,
        "SELECT trial_id, interval FROM main.trace_chunk WHERE trial_id BETWEEN ?1 AND ?2 "
        "UNION SELECT trial_id, interval FROM main.presentation WHERE trial_id BETWEEN ?1 "
        "AND ?2 AND ticks > 0 ORDER BY 1, 2",
        trials.first, trials.last);
    return part.all([](const Statement& row) {
        return TrialPart{.trial = row.integer(0), .interval = row.integer(1)};
    });
}

TickBlocks TickStore::blocks(const TrialPart& part, SampleColumns columns, const TickRange& range) {
    if ((columns & kReplayedColumns) != 0) {
        const bool closest = (columns & kClosestColumns) != 0;
        // Chunk by chunk, while those to come are worked on.
        return [part, range, closest, replay = of_part(part, [&] { return replayed(part); }),
                next = std::size_t{0}]() mutable -> std::span<const TickRecord> {
            if (next == replay->chunks()) {
                return {};
            }
            const std::size_t i = next++;
            try {
                return ticks_in(of_part(part, [&] { return replay->chunk(i, closest); }), range);
            } catch (const SampleError&) {
                replay->gives_up();
                throw;
            }
        };
    }
    const SessionTraces* session = nullptr;
    if ((columns & kHipColumns) != 0) {
        session = of_part(part, [&] { return context_of(part).session; });
    }
    return stored_blocks(db_, part, columns, range, session);
}

void SampleCursor::start(const SampleScan& scan) {
    scan_ = scan;
    tick_ = nullptr;
    blocks_ = nullptr;
    merged_.reset();
    next_part_ = 0;
    parts_ = scan.nothing ? std::vector<TrialPart>() : store_->parts(scan.trials);
    std::erase_if(parts_, [&scan](const TrialPart& part) {
        return scan.interval && part.interval != *scan.interval;
    });
    next_part();
}

void SampleCursor::next_part() {
    while (tick_ == nullptr && next_part_ < parts_.size()) {
        const bool several = next_part_ + 1 < parts_.size() &&
                             parts_[next_part_ + 1].trial == parts_[next_part_].trial;
        if (several && (scan_.by_time || scan_.by_tick)) {
            merge_trial();
            continue;
        }
        part_ = parts_[next_part_++];
        blocks_ = store_->blocks(part_, scan_.columns, scan_.range);
        has_last_ = false;
        block_ = {};
        next_block();
    }
}

void SampleCursor::next_block() {
    if (!block_.empty()) {
        last_ = block_.back();
        has_last_ = true;
    }
    block_ = blocks_();
    tick_ = block_.empty() ? nullptr : block_.data();
    end_ = tick_ + block_.size();
}

void SampleCursor::leave_block() {
    tick_ = nullptr;
    if (merged_) {
        next_merged();
        return;
    }
    next_block();
    if (tick_ == nullptr) {
        next_part();
    }
}

void SampleCursor::merge_trial() {
    MergedRows& all = merged_.emplace();
    const std::int64_t trial = parts_[next_part_].trial;
    for (; next_part_ < parts_.size() && parts_[next_part_].trial == trial; ++next_part_) {
        const auto blocks = store_->blocks(parts_[next_part_], scan_.columns, scan_.range);
        for (auto block = blocks(); !block.empty(); block = blocks()) {
            all.rows.insert(all.rows.end(), block.begin(), block.end());
        }
        all.of.resize(all.rows.size(), parts_[next_part_]);
    }
    all.order.resize(all.rows.size());
    std::iota(all.order.begin(), all.order.end(), std::size_t{0});
    std::ranges::stable_sort(all.order, [&](std::size_t a, std::size_t b) {
        return scan_.by_time ? all.rows[a].time_ns < all.rows[b].time_ns
                             : all.rows[a].tick < all.rows[b].tick;
    });
    next_merged();
}

void SampleCursor::next_merged() {
    if (merged_->next < merged_->order.size()) {
        const std::size_t row = merged_->order[merged_->next++];
        tick_ = &merged_->rows[row];
        end_ = tick_ + 1;
        part_ = merged_->of[row];
        has_last_ = row > 0 && merged_->of[row - 1] == part_;
        last_ = has_last_ ? merged_->rows[row - 1] : TickRecord{};
        return;
    }
    merged_.reset();
    tick_ = nullptr;
    next_part();
}

engine::Vec3 SampleCursor::velocity() const noexcept {
    const bool inside = !merged_ && tick_ != block_.data();
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    if (!inside && !has_last_) {
        return {kNone, kNone, kNone};
    }
    const TickRecord& before = inside ? tick_[-1] : last_;
    const double time = static_cast<double>(tick_->time_ns - before.time_ns) * 1e-9;
    if (!(time > 0.0)) {
        return {kNone, kNone, kNone};
    }
    return (tick_->hip - before.hip) / time;
}

}  // namespace palpate::data

#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "data/extension/part_chunks.hpp"
#include "data/trace/columns.hpp"
#include "data/trace/replay.hpp"

struct sqlite3;
namespace palpate::data {

class PartReplay;

/// The ticks in a database that somebody else opened: main of `db`. Reads only. Refuses while
/// another database with ticks is attached.
class TickStore {
public:
    /// @param db  stays the caller's, and outlives this
    explicit TickStore(sqlite3* db) : db_(db) {}

    /// Parts with ticks, or of which ticks are counted, in order.
    [[nodiscard]] std::vector<TrialPart> parts(const TrialRange& trials);

    /// The ticks of a part, block by block in order. `columns` says which fields of the ticks are
    /// read; others may hold anything.
    [[nodiscard]] TickBlocks blocks(const TrialPart& part,
                                    SampleColumns columns,
                                    const TickRange& range);

private:
    struct Context {
        TraceTrial trial;
        SessionTraces* session = nullptr;
    };
    Context context_of(const TrialPart& part);
    std::shared_ptr<PartReplay> replayed(const TrialPart& part);
    Ticks make_room();
    void require_one_study();

    LentConnection db_;
    /// By protocol and calibration, so that nothing here can be out of date.
    std::map<std::pair<std::string, std::string>, SessionTraces> sessions_;
    /// Last used last. A join asks for the same parts again and again: two trials of two intervals.
    std::vector<std::shared_ptr<PartReplay>> kept_;
    bool asked_again_ = false;  ///< for the last part: so may the next one be
};

/// What one scan of `sample` is to give.
struct SampleScan {
    SampleColumns columns = 0;
    TrialRange trials{};
    std::optional<std::int64_t> interval{};  ///< only this one
    TickRange range{};
    bool by_time = false;  ///< within a trial by time_s, also where it has two intervals
    bool by_tick = false;  ///< the same by tick
    bool nothing = false;  ///< no row can be meant
};

/// A trial with several intervals in one order: rows by part, and the order they are given in.
struct MergedRows {
    std::vector<engine::TickRecord> rows;
    std::vector<TrialPart> of;
    std::vector<std::size_t> order;
    std::size_t next = 0;  ///< in that order
};

/// Walks over ticks in the order trial, interval, tick (or as the scan says).
class SampleCursor {
public:
    /// @param store  outlives this
    explicit SampleCursor(TickStore& store) : store_(&store) {}

    /// To the first row. @throws SampleError, also in next()
    void start(const SampleScan& scan);
    void next() {
        if (++tick_ == end_) {
            leave_block();
        }
    }
    [[nodiscard]] bool at_end() const noexcept { return tick_ == nullptr; }

    /// Where it stands: the interval and its tick. @pre not at_end()
    [[nodiscard]] const TrialPart& part() const noexcept { return part_; }
    [[nodiscard]] const engine::TickRecord& tick() const noexcept { return *tick_; }
    /// What it gives was replayed: commands to the last bit, not in the steps that chunks hold.
    [[nodiscard]] bool replayed() const noexcept { return (scan_.columns & kReplayedColumns) != 0; }
    /// Velocity of HIP from the stored tick before, m/s; NaN without one, or with no time between.
    [[nodiscard]] engine::Vec3 velocity() const noexcept;

private:
    void next_part();
    void next_block();
    void leave_block();
    void merge_trial();
    void next_merged();

    TickStore* store_;
    SampleScan scan_{};
    std::vector<TrialPart> parts_;
    std::size_t next_part_ = 0;
    TrialPart part_{};
    TickBlocks blocks_;
    std::span<const engine::TickRecord> block_;
    const engine::TickRecord* tick_ = nullptr;
    const engine::TickRecord* end_ = nullptr;  ///< of those that lie behind the tick
    engine::TickRecord last_{};                ///< of the block before
    bool has_last_ = false;
    std::optional<MergedRows> merged_;
};

}  // namespace palpate::data

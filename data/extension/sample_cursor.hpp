#pragma once

#include <compare>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <limits>
#include <map>
#include <memory>
#include <new>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/realtime/tick_record.hpp"
#include "data/sql/statement.hpp"
#include "data/trace/chunk.hpp"
#include "data/trace/columns.hpp"
#include "data/trace/replay.hpp"

struct sqlite3;
namespace palpate::data {

/// What a query needs of the columns of `sample`: bit i is the i-th of sample_declaration().
using SampleColumns = std::uint64_t;

/// @param names  of columns; one that ends with _ is all that begin so
[[nodiscard]] SampleColumns bits_of(std::initializer_list<std::string_view> names);

/// Columns that need HIP, and the tick before.
inline const SampleColumns kVelocityColumns =
    bits_of({"hip_vx_m_per_s", "hip_vy_m_per_s", "hip_vz_m_per_s"});
inline const SampleColumns kHipColumns = bits_of({"hip_"});
/// Columns of commanded forces.
inline const SampleColumns kCommandColumns = bits_of({"commanded_"});
/// Columns that no force needs: looked for where they are asked for.
inline const SampleColumns kClosestColumns = bits_of({"cp_"});
/// Columns that follow from the hand's whole path: they need a replay.
inline const SampleColumns kReplayedColumns =
    bits_of({"cp_", "go_", "rendered_", "mode", "segment", "u", "v", "mu"});

// What is asked of stored ticks, and how they come.

/// Stored ticks cannot be read, or not be computed again: a sentence with the trial, and the
/// remedy.
class SampleError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// One interval of one trial.
struct TrialPart {
    std::int64_t trial = 0;
    std::int64_t interval = 1;

    friend auto operator<=>(const TrialPart&, const TrialPart&) = default;
};

/// Trials wanted, both ends among them.
struct TrialRange {
    std::int64_t first = INT64_MIN;
    std::int64_t last = INT64_MAX;
};

/// Ticks wanted; others may come too.
struct TickRange {
    std::int64_t first = 0;  ///< tick >= first
    std::int64_t last = INT64_MAX;
    double from_s = -1e300;  ///< time_s >= from_s
    double to_s = 1e300;

    friend bool operator==(const TickRange&, const TickRange&) = default;
};

/// The ticks of a part, block by block in order: the next ones, valid until the next call; empty at
/// the end. Those of the range are among them, and the one before its first if velocities are
/// wanted. Throws SampleError.
using TickBlocks = std::function<std::span<const engine::TickRecord>()>;

/// Connection::failed of ticks. @throws SampleError
[[noreturn]] void fail_asking(const Connection& connection, std::string_view doing);

/// A connection of somebody else's, through the extension's function table: what SQLite refuses is
/// a SampleError. Ends before the connection.
struct LentConnection : Connection {
    /// @param db  stays the caller's
    explicit LentConnection(sqlite3* db)
        : Connection{.file = {}, .handle = db, .failed = fail_asking} {}
    LentConnection(const LentConnection&) = delete;
    LentConnection& operator=(const LentConnection&) = delete;
    ~LentConnection() { forget_idle(); }
};

/// A chunk's row; the view looks at the bytes beside it.
struct PartChunk {
    ChunkView view{};
    std::vector<std::byte> bytes;
};

/// Rows of trace_chunk of one part, in the order of their ticks, read when they are asked for.
///
/// Checksums see nothing outside the columns' bytes: that a chunk is of this trial, in its place
/// and of this servo is what the other chunks and the rows of trial, presentation and session say.
class PartChunks {
public:
    /// @throws SampleError if ticks are missing, but not where the session says that some were lost
    PartChunks(const Connection& db, const TrialPart& part);

    /// Chunks, and the tick that one begins with. @throws std::out_of_range for i >= size()
    [[nodiscard]] std::size_t size() const noexcept { return first_ticks_.size(); }
    [[nodiscard]] std::int64_t first_tick(std::size_t i) const { return first_ticks_.at(i); }
    /// @throws TraceError if the row cannot be one of a chunk, SampleError if it cannot be read
    [[nodiscard]] PartChunk at(std::size_t i);

private:
    void require_all(const Connection& db, const std::vector<std::int64_t>& counts);

    TrialPart part_;
    Statement rows_;
    std::int64_t period_ns_ = 0;
    std::vector<std::int64_t> first_ticks_;
};

/// @throws SampleError that names trial and interval
[[noreturn]] void fail(const TrialPart& part, const std::string& why);

/// Whatever goes wrong in `work` with a part becomes a SampleError that names it.
template <class Work>
auto of_part(const TrialPart& part, const Work& work) {
    try {
        return work();
    } catch (const SampleError&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& e) {
        fail(part, e.what());
    }
}

/// A commanded force in the steps that chunks hold, N; NaN for what was no number.
[[nodiscard]] inline double steps_in_newton(std::int64_t steps) noexcept {
    return steps == kNotANumber ? std::numeric_limits<double>::quiet_NaN()
                                : static_cast<double>(steps) / kCommandSteps;
}

/// Those of the range and the one before, which velocities need. Numbers and times never go back.
[[nodiscard]] std::span<const engine::TickRecord> ticks_in(
    std::span<const engine::TickRecord> ticks, const TickRange& range) noexcept;

/// Columns that chunks hold, and HIP from the encoder counts: chunk by chunk without any replay,
/// decoding the columns wanted only, those chunks left out that are out of range.
/// @param session  of the trial, if columns of HIP are wanted; else null
[[nodiscard]] TickBlocks stored_blocks(const Connection& db,
                                       const TrialPart& part,
                                       SampleColumns columns,
                                       const TickRange& range,
                                       const SessionTraces* session);

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

#pragma once

#include <array>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <thread>
#include <utility>
#include <vector>

#include "engine/device/many_hips.hpp"
#include "engine/realtime/scene_view.hpp"
#include "engine/realtime/tick_record.hpp"
#include "data/trace/chunk.hpp"
#include "data/trace/retrace.hpp"
#include "data/trace/ticks.hpp"

namespace palpate::data {

/// Replays the chunks of one interval: who waits for one works on it, and a thread beside it works
/// ahead.
///
///     bytes to whole numbers to HIP    each chunk by itself
///     ticks of these, HIP to contact   from tick to tick, so one chunk after the other
///     command, and hash of the ticks   each chunk by itself
///
/// What is to be done of these first is done by whichever of the two is free, so that both cores
/// are busy whatever the scene costs. The numbers do not depend on who computed them. Nothing is
/// done for chunks more than a few beyond the last one that was asked for. One caller at a time.
class ChunkReplay {
public:
    /// Whose ticks stay: of all chunks, or of the one that was asked for last, where chunks are
    /// asked for in their order; then a long interval lies in the processor's caches.
    enum class Keeps : bool { all, last };

    /// @param machine  nothing: HIP is (0, 0) where the chunks do not hold it; in space it is what
    ///                 its columns say there
    /// @param scene    nothing: contacts are what the chunks hold
    /// @param chunks   in the order of their ticks; their bytes and the scene must outlive this
    /// @param helped   by a thread, if there is a second core; not where intervals are replayed
    ///                 side by side
    /// @param room     of an earlier replay: memory that is there already
    /// @param keeps    last: a chunk before the last one must not be asked for
    ChunkReplay(const std::optional<engine::PantographSpec>& machine,
                const engine::SceneView& scene,
                std::span<const ChunkView> chunks,
                bool helped = true,
                Ticks room = {},
                Keeps keeps = Keeps::all);
    ChunkReplay(const ChunkReplay&) = delete;
    ChunkReplay& operator=(const ChunkReplay&) = delete;
    ~ChunkReplay();

    /// How many chunks there are.
    [[nodiscard]] std::size_t size() const noexcept { return chunks_.size(); }

    /// What a chunk's ticks are again, each field as it was, without closest points.
    struct Again {
        std::span<engine::TickRecord> ticks;   ///< good as long as they stay
        bool as_recorded = false;              ///< they give the chunk's hash
        const ChunkReader* columns = nullptr;  ///< as they are stored
    };
    /// @throws TraceError if the chunk or one before it is damaged
    [[nodiscard]] Again chunk(std::size_t i);

    /// All ticks that stay, in order, those of chunks that were asked for as they are again; ends
    /// the replay.
    [[nodiscard]] Ticks take() noexcept {
        end();
        return std::move(ticks_);
    }

private:
    class Unpacker;
    struct Chunk {
        ChunkView view{};
        std::optional<ChunkReader> columns{};   ///< once it is unpacked
        std::unique_ptr<Unpacker> numbers{};    ///< while it is unpacked and has no contacts
        std::span<engine::TickRecord> ticks{};  ///< its part of ticks_, maybe after another one
        std::vector<engine::TickRecord>
            exact{};            ///< that hold what a contact would overwrite, if any is held
        bool has_gaps = false;  ///< in HIP: NaN
        std::exception_ptr damage{};
        bool unpacked = false;
        bool finished = false;
        bool as_recorded = false;
    };
    /// The columns of a chunk on their way into its ticks. Used again for later chunks.
    class Unpacker {
    public:
        /// What the bytes tell without the scene. HIP is NaN where the linkage has no pose. @throws
        /// TraceError
        void unpack(Chunk& chunk, const std::optional<engine::ManyHips>& machine, bool in_space);
        void fill(std::span<engine::TickRecord> ticks, std::size_t first) const noexcept;
        [[nodiscard]] const std::vector<ExactColumn>& exact() const noexcept { return exact_; }

    private:
        [[nodiscard]] std::span<const std::int32_t> read(const ChunkReader& reader,
                                                         ColumnId column);
        void read_small(const ChunkReader& reader, std::size_t size);
        bool read_hips(const ChunkReader& reader,
                       const std::optional<engine::ManyHips>& machine,
                       bool in_space);
        void steps(const ChunkReader& reader, ColumnId column, double engine::Vec2::*axis);
        void read_third(const ChunkReader& reader, std::size_t size);

        std::vector<std::int64_t> numbers_;
        std::vector<std::int64_t> times_;
        std::array<std::vector<std::int32_t>, 6> small_;  ///< from count_1 to flags
        std::vector<engine::Pantograph::Counts> counts_;
        std::vector<engine::Vec2> hips_;
        std::array<std::vector<std::int32_t>, 3> third_;
        std::vector<std::int32_t> column_;
        std::vector<ExactColumn> exact_;
    };
    using Lock = std::unique_lock<std::mutex>;

    void end() noexcept;
    bool work(Lock& lock) noexcept;
    void work_ahead() noexcept;
    [[nodiscard]] bool may_follow() const noexcept;
    void follow(Chunk& chunk) noexcept;
    static void finish(Chunk& chunk) noexcept;
    static void finish(Chunk& chunk,
                       std::size_t first,
                       std::size_t count,
                       DerivedHash& hash) noexcept;
    static void is_again(Chunk& chunk, const DerivedHash& hash) noexcept;

    std::optional<engine::ManyHips> machine_;
    bool in_space_;
    Retrace contacts_;
    engine::Vec2 last_hip_{};  ///< that the machine gave
    Ticks ticks_;
    std::vector<Chunk> chunks_;
    std::size_t rooms_;  ///< a chunk has the room of the one so many before it
    bool alone_;         ///< nobody helps

    std::mutex mutex_;  ///< of what follows, and of the flags of the chunks
    std::condition_variable changed_;
    std::size_t wanted_ = 0;     ///< the last one that was asked for
    std::size_t unpacking_ = 0;  ///< the next one to be unpacked
    std::size_t following_ = 0;  ///< the next one whose contacts are computed
    std::size_t finishing_ = 0;  ///< the next one to be finished
    std::vector<std::unique_ptr<Unpacker>> spare_;
    bool is_following_ = false;
    bool ends_ = false;
    std::thread ahead_;
};

}  // namespace palpate::data

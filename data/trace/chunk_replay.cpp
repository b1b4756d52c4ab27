#include "data/trace/chunk_replay.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <system_error>

#include "data/trace/derived_hash.hpp"
#include "data/trace/fixed_point.hpp"

namespace palpate::data {
namespace {

using engine::TickRecord;

/// So many chunks from the one that is asked for on are worked on.
constexpr std::size_t kAhead = 4;

/// Where the ticks of each chunk lie. A number of ticks that is damaged takes no room: its chunk cannot be read.
std::size_t room_of(const ChunkView& chunk) noexcept {
    return std::min(chunk.ticks, kChunkTicks);
}

void exclusive_or(double& value, double with) noexcept {
    std::uint64_t a = 0;
    std::uint64_t b = 0;
    std::memcpy(&a, &value, sizeof a);
    std::memcpy(&b, &with, sizeof b);
    a ^= b;
    std::memcpy(&value, &a, sizeof a);
}

void require_modes(std::span<const TickRecord> ticks) {
    for (const TickRecord& tick : ticks) {
        if (static_cast<unsigned>(tick.mode) > static_cast<unsigned>(engine::Mode::transition)) {
            throw TraceError("a trace chunk holds an unknown contact mode");
        }
    }
}

void set_exact(TickRecord& tick, std::uint8_t parts, const TickRecord& exact) noexcept {
    if ((parts & part_contact) != 0) {
        tick.go = exact.go;
        tick.force = exact.force;
        tick.normal_force = exact.normal_force;
        tick.tangential_force = exact.tangential_force;
        tick.mu = exact.mu;
        tick.u = exact.u;
        tick.segment = exact.segment;
        tick.mode = exact.mode;
    }
    tick.command = tick.force;
    if ((parts & part_command) != 0) {
        tick.command = exact.command;
        exclusive_or(tick.command.x, tick.force.x);
        exclusive_or(tick.command.y, tick.force.y);
    }
    if ((parts & part_lateness) != 0) {
        tick.lateness_us = exact.lateness_us;
    }
}

}  // namespace

/// What the bytes of a chunk tell without its scene. Of one thread.
class ChunkReplay::Unpacker {
public:
    explicit Unpacker(const std::optional<engine::ManyHips>& machine) : machine_(machine) {}

    /// HIP is NaN where the linkage has no pose. @throws TraceError
    void unpack(Chunk& chunk) {
        ChunkReader reader(chunk.view);
        const std::span<TickRecord> ticks = chunk.ticks;
        for (std::size_t i = 0; i < numbers_.size(); ++i) {
            numbers_[i].resize(ticks.size());
            reader.read(static_cast<Stored>(i), numbers_[i]);  // HIP is told by the counts
        }
        counts_.resize(ticks.size());
        hips_.assign(ticks.size(), engine::Vec2{});
        for (std::size_t i = 0; i < ticks.size(); ++i) {
            counts_[i] = {whole(Stored::count_1, i), whole(Stored::count_2, i)};
        }
        if (machine_) {
            machine_->of(counts_, hips_);
        }
        for (std::size_t i = 0; i < ticks.size(); ++i) {
            set_stored(ticks[i], i);
        }
        if (chunk.view.parts != 0) {
            chunk.exact.resize(ticks.size());
            reader.read_exact(chunk.exact);
            require_modes(chunk.exact);
        }
    }

private:
    [[nodiscard]] std::int64_t at(Stored column, std::size_t tick) const noexcept {
        return numbers_[static_cast<std::size_t>(column)][tick];
    }
    [[nodiscard]] std::int32_t whole(Stored column, std::size_t tick) const noexcept {
        return static_cast<std::int32_t>(at(column, tick));
    }

    void set_stored(TickRecord& tick, std::size_t i) const noexcept {
        tick.tick = at(Stored::tick, i);
        tick.time_ns = at(Stored::time_ns, i);
        tick.hip = hips_[i];
        tick.counts = counts_[i];
        tick.codes = {whole(Stored::code_1, i), whole(Stored::code_2, i)};
        tick.lateness_us = lateness_us(at(Stored::lateness_ns, i));
        tick.flags = static_cast<std::uint8_t>(at(Stored::flags, i));
    }

    const std::optional<engine::ManyHips>& machine_;
    std::array<std::vector<std::int64_t>, static_cast<std::size_t>(Stored::hip_x)> numbers_;
    std::vector<engine::Pantograph::Counts> counts_;
    std::vector<engine::Vec2> hips_;
};

ChunkReplay::ChunkReplay(const std::optional<engine::PantographSpec>& machine,
                         const engine::Scene* scene,
                         std::span<const ChunkView> chunks)
    : contacts_(std::nullopt, scene) {
    if (machine) {
        machine_.emplace(*machine);
    }
    std::size_t ticks = 0;
    for (const ChunkView& chunk : chunks) {
        ticks += room_of(chunk);
    }
    ticks_.resize(ticks);
    std::span<TickRecord> left(ticks_);
    for (const ChunkView& chunk : chunks) {
        chunks_.push_back({.view = chunk, .ticks = left.first(room_of(chunk)), .exact = {}});
        left = left.subspan(room_of(chunk));
    }
    unpacker_ = std::make_unique<Unpacker>(machine_);
    if (chunks.size() > 1) {
        try {
            ahead_ = std::thread([this] { work_ahead(); });
        } catch (const std::system_error&) {  // then who asks does it all
        }
    }
}

ChunkReplay::~ChunkReplay() {
    {
        const Lock lock(mutex_);
        ends_ = true;
    }
    changed_.notify_all();
    if (ahead_.joinable()) {
        ahead_.join();
    }
}

ChunkReplay::Again ChunkReplay::chunk(std::size_t i) {
    Lock lock(mutex_);
    if (i > wanted_) {
        wanted_ = i;
        changed_.notify_all();
    }
    while (!chunks_.at(i).checked) {
        if (following_ <= i && chunks_[following_].unpacked && chunks_[following_].damage) {
            std::rethrow_exception(chunks_[following_].damage);
        }
        if (!work(lock, *unpacker_)) {
            changed_.wait(lock);
        }
    }
    return {.ticks = chunks_[i].ticks, .as_recorded = chunks_[i].as_recorded};
}

void ChunkReplay::work_ahead() noexcept {
    Unpacker unpacker(machine_);
    Lock lock(mutex_);
    while (!ends_ && checking_ < chunks_.size()) {
        if (!work(lock, unpacker)) {
            changed_.wait(lock);
        }
    }
}

/// Does what is most urgent. @return false if there is nothing to do now
bool ChunkReplay::work(Lock& lock, Unpacker& unpacker) noexcept {
    const auto unlocked = [&lock](const auto& task) {
        lock.unlock();
        task();
        lock.lock();
    };
    if (!is_following_ && following_ < chunks_.size() && chunks_[following_].unpacked &&
        !chunks_[following_].damage) {
        is_following_ = true;
        unlocked([this] { follow(chunks_[following_]); });
        is_following_ = false;
        ++following_;
    } else if (checking_ < following_) {
        Chunk& chunk = chunks_[checking_++];
        unlocked([&] { chunk.as_recorded = derived_hash(chunk.ticks) == chunk.view.derived; });
        chunk.checked = true;
    } else if (unpacking_ < std::min(chunks_.size(), wanted_ + kAhead)) {
        Chunk& chunk = chunks_[unpacking_++];
        unlocked([&] {
            try {
                unpacker.unpack(chunk);
            } catch (...) {
                chunk.damage = std::current_exception();
            }
        });
        chunk.unpacked = true;
    } else {
        return false;
    }
    changed_.notify_all();
    return true;
}

/// The contacts of an unpacked chunk, after those of the chunk before.
void ChunkReplay::follow(Chunk& chunk) noexcept {
    if (machine_) {
        for (TickRecord& tick : chunk.ticks) {
            last_hip_ = std::isnan(tick.hip.x) ? last_hip_ : tick.hip;
            tick.hip = last_hip_;
        }
    }
    const std::uint8_t parts = chunk.view.parts;
    if (parts == 0) {
        for (TickRecord& tick : chunk.ticks) {
            contacts_.contact(tick);
            tick.command = tick.force;
        }
        return;
    }
    for (std::size_t i = 0; i < chunk.ticks.size(); ++i) {
        TickRecord& tick = chunk.ticks[i];
        tick.hip = (parts & part_hip) != 0 ? chunk.exact[i].hip : tick.hip;
        const std::uint8_t flags = tick.flags;
        contacts_.contact(tick);
        tick.flags = (parts & part_contact) != 0 ? flags : tick.flags;
        set_exact(tick, parts, chunk.exact[i]);
    }
}

}  // namespace palpate::data

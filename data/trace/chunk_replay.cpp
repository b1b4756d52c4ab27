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

void exclusive_or(double& value, double with) noexcept {
    std::uint64_t a = 0;
    std::uint64_t b = 0;
    std::memcpy(&a, &value, sizeof a);
    std::memcpy(&b, &with, sizeof b);
    a ^= b;
    std::memcpy(&value, &a, sizeof a);
}

void require_modes(const ChunkReader& reader) {
    std::vector<TickRecord> ticks(reader.chunk().ticks);
    reader.read_exact(ticks);
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
        tick.flags = exact.flags;
        tick.go_z = exact.go_z;
        tick.force_z = exact.force_z;
        tick.v = exact.v;
    }
    tick.command = tick.force;
    tick.command_z = tick.force_z;
    if ((parts & part_command) != 0) {
        tick.command = exact.command;
        exclusive_or(tick.command.x, tick.force.x);
        exclusive_or(tick.command.y, tick.force.y);
        tick.command_z = exact.command_z;
        exclusive_or(tick.command_z, tick.force_z);
    }
    if ((parts & part_lateness) != 0) {
        tick.lateness_us = exact.lateness_us;
    }
}

}  // namespace

/// HIP is NaN where the linkage has no pose. @throws TraceError
void ChunkReplay::Unpacked::unpack(const ChunkView& view,
                                   const std::optional<engine::ManyHips>& machine,
                                   bool in_space) {
    const ChunkReader reader(view);  // without the columns of HIP, which the counts tell
    numbers.resize(view.ticks);
    times.resize(view.ticks);
    reader.read(Stored::tick, numbers);
    reader.read(Stored::time_ns, times);
    for (std::size_t i = 0; i < small.size(); ++i) {
        small[i].resize(view.ticks);
        reader.read(static_cast<Stored>(static_cast<std::size_t>(Stored::count_1) + i), small[i]);
    }
    counts.resize(view.ticks);
    hips.resize(view.ticks);
    for (std::size_t i = 0; i < view.ticks; ++i) {
        counts[i] = {small[0][i], small[1][i]};
    }
    third.clear();
    if (in_space) {
        unpack_steps(reader);
    } else if (machine) {
        machine->of(counts, hips);
    } else {
        std::fill(hips.begin(), hips.end(), engine::Vec2{});
    }
    if (!(reader.all_zero(Stored::count_3) && reader.all_zero(Stored::code_3) &&
          reader.all_zero(Stored::hip_z))) {
        third.resize(3 * view.ticks);
        const std::span all(third);
        reader.read(Stored::count_3, all.first(view.ticks));
        reader.read(Stored::code_3, all.subspan(view.ticks, view.ticks));
        reader.read(Stored::hip_z, all.last(view.ticks));
    }
    exact = reader.exact();
    if ((view.parts & part_contact) != 0) {
        require_modes(reader);
    }
}

/// HIP in the plane as its columns say. @throws TraceError
void ChunkReplay::Unpacked::unpack_steps(const ChunkReader& reader) {
    std::vector<std::int32_t> steps(hips.size());
    for (const Stored column : {Stored::hip_x, Stored::hip_y}) {
        reader.read(column, steps);
        const auto axis = column == Stored::hip_x ? &engine::Vec2::x : &engine::Vec2::y;
        for (std::size_t i = 0; i < hips.size(); ++i) {
            hips[i].*axis = steps_in_metres(steps[i]);
        }
    }
}

ChunkReplay::ChunkReplay(const std::optional<engine::PantographSpec>& machine,
                         const engine::SceneView& scene,
                         std::span<const ChunkView> chunks,
                         bool helped,
                         std::vector<TickRecord> room)
    : in_space_(scene.space != nullptr), contacts_(std::nullopt, scene), ticks_(std::move(room)) {
    if (machine) {
        machine_.emplace(*machine);
    }
    std::size_t ticks = 0;
    for (const ChunkView& chunk : chunks) {
        chunks_.emplace_back().view = chunk;
        ticks += std::min(chunk.ticks, kChunkTicks);  // a damaged number takes no room
    }
    ticks_.clear();
    ticks_.reserve(ticks);  // so that none of them moves
    spare_.reserve(chunks_.size());
    if (helped && chunks.size() > 1) {
        try {
            ahead_ = std::thread([this] { work_ahead(); });
        } catch (const std::system_error&) {  // then who asks does it all
        }
    }
}

ChunkReplay::~ChunkReplay() {
    end();
}

void ChunkReplay::end() noexcept {
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
        if (!work(lock)) {
            changed_.wait(lock);
        }
    }
    return {.ticks = chunks_[i].ticks, .as_recorded = chunks_[i].as_recorded};
}

void ChunkReplay::work_ahead() noexcept {
    Lock lock(mutex_);
    while (!ends_ && checking_ < chunks_.size()) {
        if (!work(lock)) {
            changed_.wait(lock);
        }
    }
}

/// Does what is most urgent. @return false if there is nothing to do now
bool ChunkReplay::work(Lock& lock) noexcept {
    const auto unlocked = [&lock](const auto& task) {
        lock.unlock();
        task();
        lock.lock();
    };
    if (!is_following_ && following_ < chunks_.size() && chunks_[following_].unpacked &&
        !chunks_[following_].damage) {
        is_following_ = true;
        Chunk& chunk = chunks_[following_];
        unlocked([&] { follow(chunk); });
        spare_.push_back(std::move(chunk.bytes));
        is_following_ = false;
        ++following_;
    } else if (checking_ < following_) {
        Chunk& chunk = chunks_[checking_++];
        unlocked([&] { chunk.as_recorded = derived_hash(chunk.ticks) == chunk.view.derived; });
        chunk.checked = true;
    } else if (unpacking_ < std::min(chunks_.size(), wanted_ + kAhead)) {
        Chunk& chunk = chunks_[unpacking_++];
        if (!spare_.empty()) {
            chunk.bytes = std::move(spare_.back());
            spare_.pop_back();
        }
        unlocked([&] {
            try {
                if (!chunk.bytes) {
                    chunk.bytes = std::make_unique<Unpacked>();
                }
                chunk.bytes->unpack(chunk.view, machine_, in_space_);
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

/// The ticks of an unpacked chunk, after those of the chunk before, a few at a time: they stay in the first cache.
void ChunkReplay::follow(Chunk& chunk) noexcept {
    constexpr std::size_t kAtOnce = 64;
    const Unpacked& bytes = *chunk.bytes;
    const std::uint8_t parts = chunk.view.parts;
    const std::size_t begin = ticks_.size();
    if (parts != 0) {  // there is room
        ticks_.resize(begin + chunk.view.ticks);
        for (const ExactColumn& column : bytes.exact) {
            column.into(std::span(ticks_).subspan(begin));
        }
    }
    std::array<TickRecord, kAtOnce> exact;
    for (std::size_t first = 0; first < chunk.view.ticks; first += kAtOnce) {
        const std::size_t count = std::min(kAtOnce, chunk.view.ticks - first);
        ticks_.resize(std::max(ticks_.size(), begin + first + count));
        const auto ticks = std::span(ticks_).subspan(begin + first, count);
        if (parts != 0) {
            std::ranges::copy(ticks, exact.begin());
        }
        set_stored(bytes, first, ticks);
        if ((parts & part_hip) != 0) {
            for (std::size_t i = 0; i < count; ++i) {
                ticks[i].hip = exact[i].hip;
                ticks[i].hip_z = exact[i].hip_z;
            }
        }
        contacts_.contacts(ticks);
        for (std::size_t i = 0; i < count; ++i) {
            ticks[i].command = ticks[i].force;
            ticks[i].command_z = ticks[i].force_z;
            if (parts != 0) {
                exact[i].flags = static_cast<std::uint8_t>(bytes.column(Stored::flags)[first + i]);
                set_exact(ticks[i], parts, exact[i]);
            }
        }
    }
    chunk.ticks = std::span(ticks_).subspan(begin);
}

/// What of a tick is stored, and HIP.
void ChunkReplay::set_stored(const Unpacked& bytes,
                             std::size_t first,
                             std::span<TickRecord> ticks) noexcept {
    const std::int32_t* const code_1 = bytes.column(Stored::code_1) + first;
    const std::int32_t* const code_2 = bytes.column(Stored::code_2) + first;
    const std::int32_t* const late = bytes.column(Stored::lateness_ns) + first;
    const std::int32_t* const flags = bytes.column(Stored::flags) + first;
    for (std::size_t i = 0; i < ticks.size(); ++i) {
        TickRecord& tick = ticks[i];
        tick.tick = bytes.numbers[first + i];
        tick.time_ns = bytes.times[first + i];
        tick.counts = bytes.counts[first + i];
        tick.codes = {code_1[i], code_2[i]};
        tick.lateness_us = lateness_us(late[i]);
        tick.flags = static_cast<std::uint8_t>(flags[i]);
        const engine::Vec2& hip = bytes.hips[first + i];
        last_hip_ = std::isnan(hip.x) ? last_hip_ : hip;
        tick.hip = last_hip_;
    }
    const std::size_t all = bytes.third.size() / 3;  // 0 in the plane
    for (std::size_t i = 0; all > 0 && i < ticks.size(); ++i) {
        ticks[i].count_3 = bytes.third[first + i];
        ticks[i].code_3 = bytes.third[all + first + i];
        ticks[i].hip_z = steps_in_metres(bytes.third[2 * all + first + i]);
    }
}

}  // namespace palpate::data

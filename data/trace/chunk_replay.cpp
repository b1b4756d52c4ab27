#include "data/trace/chunk_replay.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <new>
#include <system_error>

#include "engine/base/processor.hpp"
#include "engine/base/refuse.hpp"
#include "engine/base/side_by_side.hpp"
#include "engine/realtime/felt_scene.hpp"
#include "data/trace/chunk.hpp"
#include "data/trace/columns.hpp"

namespace palpate::data {
namespace {

using engine::TickRecord;

/// So many chunks from the one that is asked for on are worked on.
constexpr std::size_t kAhead = 4;

/// What a contact overwrites: kept apart until it is known. The rest lies in the ticks at once.
constexpr unsigned kApart = part_hip | part_contact;
/// Columns that are 0 in the plane.
constexpr std::array kThird{ColumnId::count_3, ColumnId::code_3, ColumnId::hip_z};

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
        refuse_if<TraceError>(
            static_cast<unsigned>(tick.mode) > static_cast<unsigned>(engine::Mode::transition),
            "a trace chunk holds an unknown contact mode");
    }
}

/// The rest of a tick whose contact is known. @param exact  may be the tick itself, see kApart
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
        tick.v = exact.v;
    }
    if ((parts & part_command) != 0) {
        tick.command = exact.command;
        exclusive_or(tick.command.x, tick.force.x);
        exclusive_or(tick.command.y, tick.force.y);
        exclusive_or(tick.command.z, tick.force.z);
    } else {
        tick.command = tick.force;
    }
    if ((parts & part_lateness) != 0) {
        tick.lateness_us = exact.lateness_us;
    }
}

}  // namespace

std::span<const std::int32_t> ChunkReplay::Unpacker::read(const ChunkReader& reader,
                                                          ColumnId column) {
    column_.resize(reader.chunk().ticks);
    reader.read(column, column_);
    return column_;
}

void ChunkReplay::Unpacker::steps(const ChunkReader& reader,
                                  ColumnId column,
                                  double engine::Vec2::*axis) {
    const auto steps = read(reader, column);
    for (std::size_t i = 0; i < hips_.size(); ++i) {
        hips_[i].*axis = steps_in_metres(steps[i]);
    }
}

/// Of sessions in space; else empty.
void ChunkReplay::Unpacker::read_third(const ChunkReader& reader, std::size_t size) {
    const bool none =
        std::ranges::all_of(kThird, [&reader](ColumnId column) { return reader.all_zero(column); });
    for (std::size_t i = 0; i < kThird.size(); ++i) {
        third_[i].resize(none ? 0 : size);
        if (!none) {
            reader.read(kThird[i], third_[i]);
        }
    }
}

/// The columns of whole numbers.
void ChunkReplay::Unpacker::read_small(const ChunkReader& reader, std::size_t size) {
    numbers_.resize(size);
    times_.resize(size);
    reader.read(ColumnId::tick, numbers_);
    reader.read(ColumnId::time_ns, times_);
    for (std::size_t i = 0; i < small_.size(); ++i) {
        small_[i].resize(size);
        reader.read(static_cast<ColumnId>(static_cast<std::size_t>(ColumnId::count_1) + i),
                    small_[i]);
    }
}

/// HIP by the counts, or as it was stored. @return somewhere the linkage has no pose
bool ChunkReplay::Unpacker::read_hips(const ChunkReader& reader,
                                      const std::optional<engine::ManyHips>& machine,
                                      bool in_space) {
    hips_.resize(counts_.size());
    if (in_space) {
        steps(reader, ColumnId::hip_x, &engine::Vec2::x);
        steps(reader, ColumnId::hip_y, &engine::Vec2::y);
    } else if (machine) {
        machine->of(counts_, hips_);
    } else {
        std::ranges::fill(hips_, engine::Vec2{});
    }
    return std::ranges::any_of(hips_, [](const engine::Vec2& hip) { return std::isnan(hip.x); });
}

void ChunkReplay::Unpacker::unpack(Chunk& chunk,
                                   const std::optional<engine::ManyHips>& machine,
                                   bool in_space) {
    const ChunkView& view = chunk.view;
    const ChunkReader& reader = chunk.columns.emplace(view);
    const std::size_t size = chunk.ticks.size();
    read_small(reader, size);
    read_third(reader, size);
    counts_.resize(size);
    for (std::size_t i = 0; i < size; ++i) {
        counts_[i] = {small_[0][i], small_[1][i]};
    }
    chunk.has_gaps = read_hips(reader, machine, in_space);
    exact_ = reader.exact();
    chunk.exact.resize((view.parts & kApart) != 0 ? size : 0);
    if ((view.parts & part_contact) != 0) {
        require_modes(reader);
    }
}

/// What was unpacked of some ticks, from `first` on in the chunk.
void ChunkReplay::Unpacker::fill(std::span<TickRecord> ticks, std::size_t first) const noexcept {
    const auto& [count_1, count_2, code_1, code_2, late, flags] = small_;
    as_this_processor_can([&] {
        for (std::size_t i = 0; i < ticks.size(); ++i) {
            // Field by field: g++ clears a whole record by a slow string instruction.
            TickRecord& tick = *::new (&ticks[i]) TickRecord;
            tick.tick = numbers_[first + i];
            tick.time_ns = times_[first + i];
            tick.hip = engine::Vec3(hips_[first + i], 0.0);
            tick.counts = counts_[first + i];
            tick.codes = {code_1[first + i], code_2[first + i]};
            tick.lateness_us = lateness_us(late[first + i]);
            tick.flags = static_cast<std::uint8_t>(flags[first + i]);
        }
    });
    for (std::size_t i = 0; !third_[0].empty() && i < ticks.size(); ++i) {
        ticks[i].counts[2] = third_[0][first + i];
        ticks[i].codes[2] = third_[1][first + i];
        ticks[i].hip.z = steps_in_metres(third_[2][first + i]);
    }
}

ChunkReplay::ChunkReplay(const std::optional<engine::PantographSpec>& machine,
                         const engine::SceneView& scene,
                         std::span<const ChunkView> chunks,
                         bool helped,
                         Ticks room,
                         Keeps keeps)
    : in_space_(scene.space != nullptr),
      contacts_(std::nullopt, scene),
      ticks_(std::move(room)),
      alone_(!helped || chunks.size() < 2 || usable_processors() < 2) {
    if (machine) {
        machine_.emplace(*machine);
    }
    const bool all = keeps == Keeps::all;
    rooms_ = all ? chunks.size() : alone_ ? 1 : kAhead;
    // A damaged number takes no room.
    const auto size_of = [](const ChunkView& chunk) {
        return std::min(chunk.ticks, kChunkTicks);
    };
    std::size_t ticks = 0;
    for (const ChunkView& chunk : chunks) {
        ticks += size_of(chunk);
    }
    ticks_.resize(all ? ticks : rooms_ * kChunkTicks);
    for (std::size_t first = 0; const ChunkView& chunk : chunks) {
        const std::size_t place = all ? first : chunks_.size() % rooms_ * kChunkTicks;
        chunks_.push_back(
            {.view = chunk, .ticks = std::span(ticks_).subspan(place, size_of(chunk))});
        first += size_of(chunk);
    }
    spare_.reserve(kAhead);
    if (!alone_) {
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
    while (!chunks_.at(i).finished) {
        if (following_ <= i && chunks_[following_].unpacked && chunks_[following_].damage) {
            std::rethrow_exception(chunks_[following_].damage);
        }
        if (!work(lock)) {
            changed_.wait(lock);
        }
    }
    return {.ticks = chunks_[i].ticks,
            .as_recorded = chunks_[i].as_recorded,
            .columns = &*chunks_[i].columns};
}

void ChunkReplay::work_ahead() noexcept {
    Lock lock(mutex_);
    while (!ends_ && finishing_ < chunks_.size()) {
        if (!work(lock)) {
            changed_.wait(lock);
        }
    }
}

/// The next contacts can be computed, and nobody reads what lies where they belong.
bool ChunkReplay::may_follow() const noexcept {
    if (is_following_ || following_ == chunks_.size() || !chunks_[following_].unpacked ||
        chunks_[following_].damage) {
        return false;
    }
    const std::size_t before = following_ - rooms_;
    return following_ < rooms_ || (chunks_[before].finished && before < wanted_);
}

/// Does what is most urgent. @return false if there is nothing to do now
bool ChunkReplay::work(Lock& lock) noexcept {
    const auto unlocked = [&lock](const auto& task) {
        lock.unlock();
        task();
        lock.lock();
    };
    if (may_follow()) {
        is_following_ = true;
        Chunk& chunk = chunks_[following_];
        unlocked([&] { follow(chunk); });
        spare_.push_back(std::move(chunk.numbers));  // there is room
        is_following_ = false;
        ++following_;
        chunk.finished = alone_;
        finishing_ += alone_ ? 1 : 0;
    } else if (finishing_ < following_) {
        Chunk& chunk = chunks_[finishing_++];
        unlocked([&] { finish(chunk); });
        chunk.finished = true;
    } else if (unpacking_ < std::min({chunks_.size(), wanted_ + kAhead, following_ + kAhead})) {
        Chunk& chunk = chunks_[unpacking_++];
        if (!spare_.empty()) {
            chunk.numbers = std::move(spare_.back());
            spare_.pop_back();
        }
        unlocked([&] {
            try {
                if (!chunk.numbers) {
                    chunk.numbers = std::make_unique<Unpacker>();
                }
                chunk.numbers->unpack(chunk, machine_, in_space_);
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

/// An unpacked chunk's ticks with their contacts, after those of the chunk before: all that cannot
/// be done side by side. A few ticks at a time: their memory comes while contacts wait for
/// themselves, and if nobody helps they are finished in the same way.
void ChunkReplay::follow(Chunk& chunk) noexcept {
    constexpr std::size_t kAtOnce = 8;
    const std::size_t at_once = chunk.view.parts == 0 ? kAtOnce : chunk.ticks.size();
    DerivedHash hash;
    for (std::size_t first = 0; first < chunk.ticks.size(); first += at_once) {
        const auto ticks =
            chunk.ticks.subspan(first, std::min(at_once, chunk.ticks.size() - first));
        chunk.numbers->fill(ticks, first);
        std::copy_n(ticks.begin(), chunk.exact.size(), chunk.exact.begin());
        for (const ExactColumn& column : chunk.numbers->exact()) {
            column.into(chunk.exact.empty() ? ticks : chunk.exact);
        }
        for (TickRecord& tick : chunk.has_gaps ? ticks : ticks.last(1)) {
            last_hip_ = std::isnan(tick.hip.x) ? last_hip_ : engine::Vec2(tick.hip);
            tick.hip = engine::Vec3(last_hip_, tick.hip.z);
        }
        for (std::size_t i = 0; (chunk.view.parts & part_hip) != 0 && i < ticks.size(); ++i) {
            ticks[i].hip = chunk.exact[i].hip;
        }
        contacts_.contacts(ticks);
        if (alone_) {
            finish(chunk, first, ticks.size(), hash);
        }
    }
    if (alone_) {
        is_again(chunk, hash);
    }
}

void ChunkReplay::finish(Chunk& chunk) noexcept {
    DerivedHash hash;
    finish(chunk, 0, chunk.ticks.size(), hash);
    is_again(chunk, hash);
}

/// What follows from the contact of `count` ticks or is held in full, and the hash so far: some
/// ticks at a time, while they are in the first cache.
void ChunkReplay::finish(Chunk& chunk,
                         std::size_t first,
                         std::size_t count,
                         DerivedHash& hash) noexcept {
    constexpr std::size_t kAtOnce = 64;
    for (const std::size_t end = first + count; first < end; first += kAtOnce) {
        const auto ticks = chunk.ticks.subspan(first, std::min(kAtOnce, end - first));
        for (std::size_t i = 0; i < ticks.size(); ++i) {
            set_exact(ticks[i], chunk.view.parts,
                      chunk.exact.empty() ? ticks[i] : chunk.exact[first + i]);
        }
        hash.add(ticks);
    }
}

void ChunkReplay::is_again(Chunk& chunk, const DerivedHash& hash) noexcept {
    chunk.as_recorded = hash.value() == chunk.view.derived;
    chunk.exact = {};
}

}  // namespace palpate::data

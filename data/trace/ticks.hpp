#pragma once

#include <cstddef>
#include <cstdlib>
#include <mutex>
#include <new>
#include <utility>
#include <vector>

#include <sys/mman.h>

#include "engine/realtime/tick_record.hpp"

namespace palpate::data {

/// Allocates what is written in full before it is read: resize() sets nothing, and many ticks lie
/// on large pages.
template <class T>
struct Unset {
    using value_type = T;

    Unset() = default;
    /// An allocator has no state: all are one.
    template <class U>
    Unset(const Unset<U>& /*other*/) noexcept {}  // NOLINT(*-explicit-*)

    [[nodiscard]] T* allocate(std::size_t count) {
        constexpr std::size_t kLarge = std::size_t{2} << 20U;
        const std::size_t bytes = count * sizeof(T);  // of ticks of a trial: far from overflow
        const bool many = bytes >= kLarge / 2;
        const std::size_t whole = (bytes + kLarge - 1) / kLarge * kLarge;
        void* const memory = many ? std::aligned_alloc(kLarge, whole) : std::malloc(bytes);
        if (memory == nullptr) {
            throw std::bad_alloc();
        }
        if (many) {
            static_cast<void>(::madvise(memory, whole, MADV_HUGEPAGE));  // or else small ones
        }
        return static_cast<T*>(memory);
    }
    /// Frees what allocate() gave.
    void deallocate(T* memory, std::size_t /*count*/) noexcept { std::free(memory); }

    /// Default construction leaves the bytes as they are; any other writes them.
    template <class U>
    void construct(U* /*place*/) noexcept {}
    template <class U, class... Arguments>
    void construct(U* place, Arguments&&... arguments) {
        ::new (static_cast<void*>(place)) U(std::forward<Arguments>(arguments)...);
    }
    bool operator==(const Unset& /*other*/) const noexcept { return true; }
};

/// Ticks that are written before they are read.
using Ticks = std::vector<engine::TickRecord, Unset<engine::TickRecord>>;

/// Memory of ticks that nobody needs any more, for those to come: pages that need not be cleared
/// again. For several threads, of which each holds one at a time.
class TickRooms {
public:
    /// Empty, maybe with room.
    [[nodiscard]] Ticks take() {
        const std::lock_guard lock(mutex_);
        if (rooms_.empty()) {
            return {};
        }
        Ticks room = std::move(rooms_.back());
        rooms_.pop_back();
        return room;
    }
    void give(Ticks room) {
        room.clear();
        const std::lock_guard lock(mutex_);
        rooms_.push_back(std::move(room));
    }

private:
    std::mutex mutex_;
    std::vector<Ticks> rooms_;
};

}  // namespace palpate::data

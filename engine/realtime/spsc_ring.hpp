#pragma once

#include <atomic>
#include <cstddef>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace palpate::engine {

/// Wait-free ring between one producer and one consumer thread. Storage is allocated once.
template <class T>
class SpscRing {
public:
    /// @param capacity  a power of two, > 1
    explicit SpscRing(std::size_t capacity) : slots_(capacity), mask_(capacity - 1) {
        if (capacity < 2 || (capacity & mask_) != 0) {
            throw std::invalid_argument("a ring needs a power of two of slots, not " +
                                        std::to_string(capacity));
        }
    }

    /// Producer: false (and nothing stored) when full.
    bool push(const T& value) noexcept {
        const std::size_t head = head_.load(std::memory_order_relaxed);
        if (head - tail_.load(std::memory_order_acquire) > mask_) {
            return false;
        }
        slots_[head & mask_] = value;
        head_.store(head + 1, std::memory_order_release);
        return true;
    }

    /// Consumer: moves up to out.size() oldest values to `out`, returns how many.
    std::size_t pop(std::span<T> out) noexcept {
        const std::size_t tail = tail_.load(std::memory_order_relaxed);
        const std::size_t ready = head_.load(std::memory_order_acquire) - tail;
        const std::size_t n = ready < out.size() ? ready : out.size();
        for (std::size_t i = 0; i < n; ++i) {
            out[i] = slots_[(tail + i) & mask_];
        }
        tail_.store(tail + n, std::memory_order_release);
        return n;
    }

    /// Consumer: forget everything. Only while no producer runs.
    void clear() noexcept {
        tail_.store(head_.load(std::memory_order_acquire), std::memory_order_release);
    }

    /// Values that it holds when it is full, as they were asked for.
    [[nodiscard]] std::size_t capacity() const noexcept { return mask_ + 1; }
    /// Where the values are kept.
    [[nodiscard]] std::span<const T> slots() const noexcept { return slots_; }

private:
    std::vector<T> slots_;
    std::size_t mask_;
    alignas(64) std::atomic<std::size_t> head_{0};
    alignas(64) std::atomic<std::size_t> tail_{0};
};

}  // namespace palpate::engine

#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

namespace palpate {

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

/// The newest value of one writing thread, for any number of readers; values may be missed, never
/// torn. Wait-free on both sides: a reader that met the writer kTries times gets nothing.
///
/// A sequence lock whose words are atomic (H.-J. Boehm, "Can seqlocks get along with programming
/// language memory models?", 2012): odd while a value is being written. Each word is stored with
/// release and loaded with acquire, so that whoever saw one new word also sees the odd number.
template <class T>
class LatestValue {
    static_assert(std::is_trivially_copyable_v<T>);

public:
    static constexpr int kTries = 64;

    /// The writing thread only.
    void publish(const T& value) noexcept {
        std::array<std::uint64_t, kWords> words{};
        std::memcpy(words.data(), &value, sizeof(T));
        const std::uint64_t number = number_.load(std::memory_order_relaxed);
        number_.store(number + 1, std::memory_order_relaxed);
        for (std::size_t i = 0; i < kWords; ++i) {
            words_[i].store(words[i], std::memory_order_release);
        }
        number_.store(number + 2, std::memory_order_release);
    }

    /// None before the first publish(), and if the writer was in the way all the time.
    [[nodiscard]] std::optional<T> read() const noexcept {
        for (int attempt = 0; attempt < kTries; ++attempt) {
            const std::uint64_t number = number_.load(std::memory_order_acquire);
            if (number == 0) {
                return std::nullopt;
            }
            std::array<std::uint64_t, kWords> words{};
            for (std::size_t i = 0; i < kWords; ++i) {
                words[i] = words_[i].load(std::memory_order_acquire);
            }
            if (number % 2 == 0 && number_.load(std::memory_order_relaxed) == number) {
                T value{};
                std::memcpy(static_cast<void*>(&value), words.data(), sizeof(T));
                return value;
            }
        }
        return std::nullopt;
    }

private:
    static constexpr std::size_t kWords = (sizeof(T) + 7) / 8;

    alignas(64) std::atomic<std::uint64_t> number_{0};
    std::array<std::atomic<std::uint64_t>, kWords> words_{};
};

}  // namespace palpate

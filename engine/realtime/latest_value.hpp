#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <type_traits>

namespace palpate::engine {

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

}  // namespace palpate::engine

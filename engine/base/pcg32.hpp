#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

namespace palpate {

/// PCG32: a 64-bit congruential generator with the output XSH-RR 64/32 (M. O'Neill, "PCG: A Family
/// of Simple Fast Space-Efficient Statistically Good Algorithms for Random Number Generation",
/// 2014).
///
/// Written out here, with its bounded draw and its shuffle, because a seed must mean one order on
/// every machine, and C++ libraries draw and shuffle each in their own way. Period 2^64, 2^63
/// sequences.
class Pcg32 {
public:
    /// @param initstate  where in its sequence the generator starts
    /// @param initseq    which sequence: the top bit is not used
    constexpr Pcg32(std::uint64_t initstate, std::uint64_t initseq) noexcept
        : increment_((initseq << 1U) | 1U) {
        advance();
        state_ += initstate;
        advance();
    }

    /// 32 uniform bits.
    constexpr std::uint32_t next() noexcept {
        const std::uint64_t old = state_;
        advance();
        const auto mixed = static_cast<std::uint32_t>(((old >> 18U) ^ old) >> 27U);
        const auto turn = static_cast<std::uint32_t>(old >> 59U);
        return (mixed >> turn) | (mixed << ((0U - turn) & 31U));
    }

    /// Uniform in 0 ... n - 1 without bias: words below 2^32 mod n are thrown away. @pre n >= 1
    constexpr std::uint32_t bounded(std::uint32_t n) noexcept {
        const std::uint32_t threshold = (0U - n) % n;
        for (;;) {
            const std::uint32_t word = next();
            if (word >= threshold) {
                return word % n;
            }
        }
    }

    friend constexpr bool operator==(const Pcg32&, const Pcg32&) = default;

private:
    constexpr void advance() noexcept { state_ = state_ * 6364136223846793005ULL + increment_; }

    std::uint64_t state_ = 0;
    std::uint64_t increment_;
};

/// Descending Fisher-Yates: every order of `items` is equally likely. @pre fewer than 2^32 items
template <class T>
constexpr void shuffle(std::span<T> items, Pcg32& random) noexcept {
    for (std::size_t left = items.size(); left > 1; --left) {
        const std::size_t chosen = random.bounded(static_cast<std::uint32_t>(left));
        std::swap(items[chosen], items[left - 1]);
    }
}

}  // namespace palpate

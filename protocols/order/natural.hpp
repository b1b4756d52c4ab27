#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/base/pcg32.hpp"

namespace palpate::protocols {

/// A whole number >= 0 of any size. Orders are counted with it, and drawn below what was counted: no
/// rounding anywhere, and the same on every machine.
class Natural {
public:
    Natural(std::uint32_t value = 0);  // NOLINT(google-explicit-constructor): a number is a number

    Natural& operator+=(const Natural& other);
    /// @pre other <= *this
    Natural& operator-=(const Natural& other);
    Natural& operator*=(std::uint32_t factor);
    /// Rounds down. @pre divisor >= 1
    Natural& operator/=(std::uint32_t divisor);
    [[nodiscard]] friend Natural operator*(const Natural& a, const Natural& b) {
        return a.times(b);
    }

    friend bool operator==(const Natural&, const Natural&) = default;
    friend std::strong_ordering operator<=>(const Natural& a, const Natural& b) noexcept;

    [[nodiscard]] bool zero() const noexcept { return words_.empty(); }
    /// Digits in base 2; 0 has none.
    [[nodiscard]] std::size_t bits() const noexcept;

    /// *this / whole to double precision, also where neither fits into a double. @pre whole > 0
    [[nodiscard]] double share_of(const Natural& whole) const;

    /// Uniform in 0 ... n - 1 without bias: as many random bits as n - 1 has, the highest first, until
    /// they stay below n. n = 1 draws nothing. @pre n >= 1
    [[nodiscard]] static Natural below(const Natural& n, Pcg32& random);

private:
    [[nodiscard]] Natural times(const Natural& other) const;
    void trim() noexcept;

    std::vector<std::uint32_t> words_;  ///< the lowest first, the highest is not 0
};

/// (sum of counts)! / product of counts!: the orders of things of which counts[i] are alike.
[[nodiscard]] Natural multinomial(const std::vector<std::size_t>& counts);

}  // namespace palpate::protocols

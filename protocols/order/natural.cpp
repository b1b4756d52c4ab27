#include "protocols/order/natural.hpp"

#include <cmath>
#include <cstdint>

namespace palpate::protocols {
namespace {

constexpr std::size_t kWord = 32;  // bits of a random number

std::size_t words_of(const Natural& n) {
    return (bits_of(n) + kWord - 1) / kWord;
}

/// The highest three words of a number as a double, and the power of 2 to multiply it with.
struct ScaledNumber {
    double leading = 0.0;
    int exponent = 0;
};

ScaledNumber scaled(const Natural& n) {
    const std::size_t words = words_of(n);
    ScaledNumber result;
    std::size_t below = words * kWord;
    for (std::size_t i = 0; i < 3 && below > 0; ++i) {
        below -= kWord;
        const auto word = static_cast<std::uint32_t>((n >> below) & 0xFFFFFFFFU);
        result.leading = result.leading * 0x1p32 + word;
    }
    result.exponent = static_cast<int>(below);
    return result;
}

}  // namespace

std::size_t bits_of(const Natural& n) {
    return n.is_zero() ? 0 : msb(n) + 1;
}

double share_of(const Natural& part, const Natural& whole) {
    const ScaledNumber some = scaled(part);
    const ScaledNumber all = scaled(whole);
    return std::ldexp(some.leading / all.leading, some.exponent - all.exponent);
}

Natural draw_below(const Natural& n, Pcg32& random) {
    const Natural last = n - 1;
    const std::size_t words = words_of(last);
    const std::size_t unused = words * kWord - bits_of(last);
    for (;;) {
        Natural drawn;
        for (std::size_t i = 0; i < words; ++i) {
            drawn <<= kWord;
            drawn |= i == 0 ? random.next() >> unused : random.next();
        }
        if (drawn < n) {
            return drawn;
        }
    }
}

Natural multinomial(const std::vector<std::size_t>& counts) {
    Natural orders = 1;
    std::size_t placed = 0;
    for (const std::size_t count : counts) {
        for (std::size_t i = 1; i <= count; ++i) {
            orders *= ++placed;
            orders /= i;  // C(placed, i) so far: never a rest
        }
    }
    return orders;
}

}  // namespace palpate::protocols

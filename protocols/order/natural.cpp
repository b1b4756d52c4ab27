#include "protocols/order/natural.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace palpate::protocols {
namespace {

constexpr unsigned kWord = 32;

/// The highest words of a number as a double, and the power of 2 to multiply it with.
struct Scaled {
    double leading = 0.0;
    int exponent = 0;
};

Scaled scaled(const std::vector<std::uint32_t>& words) {
    Scaled result;
    const std::size_t used = std::min<std::size_t>(words.size(), 3);
    for (std::size_t i = 0; i < used; ++i) {
        result.leading = result.leading * 0x1p32 + words[words.size() - 1 - i];
    }
    result.exponent = static_cast<int>(kWord) * static_cast<int>(words.size() - used);
    return result;
}

}  // namespace

Natural::Natural(std::uint32_t value) {
    if (value != 0) {
        words_.push_back(value);
    }
}

void Natural::trim() noexcept {
    while (!words_.empty() && words_.back() == 0) {
        words_.pop_back();
    }
}

Natural& Natural::operator+=(const Natural& other) {
    words_.resize(std::max(words_.size(), other.words_.size()));
    std::uint64_t carry = 0;
    for (std::size_t i = 0; i < words_.size(); ++i) {
        carry += words_[i];
        carry += i < other.words_.size() ? other.words_[i] : 0U;
        words_[i] = static_cast<std::uint32_t>(carry);
        carry >>= kWord;
    }
    if (carry != 0) {
        words_.push_back(static_cast<std::uint32_t>(carry));
    }
    return *this;
}

Natural& Natural::operator-=(const Natural& other) {
    std::uint64_t borrow = 0;
    for (std::size_t i = 0; i < words_.size(); ++i) {
        const std::uint64_t taken = borrow + (i < other.words_.size() ? other.words_[i] : 0U);
        borrow = taken > words_[i] ? 1U : 0U;
        words_[i] = static_cast<std::uint32_t>((borrow << kWord) + words_[i] - taken);
    }
    trim();
    return *this;
}

Natural& Natural::operator*=(std::uint32_t factor) {
    std::uint64_t carry = 0;
    for (std::uint32_t& word : words_) {
        carry += std::uint64_t{word} * factor;
        word = static_cast<std::uint32_t>(carry);
        carry >>= kWord;
    }
    if (carry != 0) {
        words_.push_back(static_cast<std::uint32_t>(carry));
    }
    trim();
    return *this;
}

Natural& Natural::operator/=(std::uint32_t divisor) {
    std::uint64_t rest = 0;
    for (std::size_t i = words_.size(); i-- > 0;) {
        rest = (rest << kWord) | words_[i];
        words_[i] = static_cast<std::uint32_t>(rest / divisor);
        rest %= divisor;
    }
    trim();
    return *this;
}

Natural Natural::times(const Natural& other) const {
    Natural product;
    product.words_.assign(words_.size() + other.words_.size(), 0);
    for (std::size_t i = 0; i < words_.size(); ++i) {
        std::uint64_t carry = 0;
        for (std::size_t k = 0; k < other.words_.size(); ++k) {
            carry += std::uint64_t{words_[i]} * other.words_[k] + product.words_[i + k];
            product.words_[i + k] = static_cast<std::uint32_t>(carry);
            carry >>= kWord;
        }
        product.words_[i + other.words_.size()] = static_cast<std::uint32_t>(carry);
    }
    product.trim();
    return product;
}

std::strong_ordering operator<=>(const Natural& a, const Natural& b) noexcept {
    if (a.words_.size() != b.words_.size()) {
        return a.words_.size() <=> b.words_.size();
    }
    for (std::size_t i = a.words_.size(); i-- > 0;) {
        if (a.words_[i] != b.words_[i]) {
            return a.words_[i] <=> b.words_[i];
        }
    }
    return std::strong_ordering::equal;
}

std::size_t Natural::bits() const noexcept {
    return words_.empty()
             ? 0
             : words_.size() * kWord - static_cast<std::size_t>(std::countl_zero(words_.back()));
}

double Natural::share_of(const Natural& whole) const {
    const Scaled part = scaled(words_);
    const Scaled all = scaled(whole.words_);
    return std::ldexp(part.leading / all.leading, part.exponent - all.exponent);
}

Natural Natural::below(const Natural& n, Pcg32& random) {
    Natural most = n;
    most -= 1;
    const std::size_t words = most.words_.size();
    if (words == 0) {
        return {};
    }
    const int unused = std::countl_zero(most.words_.back());
    Natural drawn;
    for (;;) {
        drawn.words_.resize(words);
        for (std::size_t i = words; i-- > 0;) {
            drawn.words_[i] = random.next();
        }
        drawn.words_.back() >>= static_cast<unsigned>(unused);
        drawn.trim();
        if (drawn < n) {
            return drawn;
        }
    }
}

Natural multinomial(const std::vector<std::size_t>& counts) {
    Natural orders = 1;
    std::uint32_t placed = 0;
    for (const std::size_t count : counts) {
        for (std::uint32_t i = 1; i <= count; ++i) {
            orders *= ++placed;
            orders /= i;  // C(placed, i) so far: never a rest
        }
    }
    return orders;
}

}  // namespace palpate::protocols

#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <vector>

/// Whole numbers in as few bits as the largest of their block needs: a stream of blocks of kBlock
/// numbers (the last may have fewer), each a byte that says how many bits, 0 to 64, then the
/// numbers in so many bits each, the lowest bit first, up to a whole byte. Reads faster than any
/// dictionary; of what hands and encoders give it leaves as little.
namespace palpate::data {

static_assert(std::endian::native == std::endian::little, "bits are copied as they lie in memory");

inline constexpr std::size_t kBlock = 32;

/// Adds the stream of `numbers` to `data`.
inline void pack_numbers(std::span<const std::uint64_t> numbers, std::vector<std::byte>& data) {
    for (std::size_t first = 0; first < numbers.size(); first += kBlock) {
        const auto block = numbers.subspan(first, std::min(kBlock, numbers.size() - first));
        std::uint64_t all = 0;
        for (const std::uint64_t number : block) {
            all |= number;
        }
        const auto width = static_cast<std::size_t>(std::bit_width(all));
        data.push_back(static_cast<std::byte>(width));
        if (width == 0) {
            continue;
        }
        std::array<std::uint64_t, kBlock + 1> bits;
        std::size_t whole = 0;
        std::size_t filled = 0;  // bits of the word that is not whole
        std::uint64_t word = 0;
        for (const std::uint64_t number : block) {
            word |= number << filled;
            filled += width;
            if (filled >= 64) {
                bits[whole++] = word;
                filled -= 64;
                word = number >> 1U >> (width - filled - 1);  // a shift by 64 is none in C++
            }
        }
        bits[whole] = word;
        const std::size_t bit = 64 * whole + filled;
        const auto* const bytes = reinterpret_cast<const std::byte*>(bits.data());
        data.insert(data.end(), bytes, bytes + (bit + 7) / 8);
    }
}

/// Reads such a stream block by block. `stream` must outlive this.
class PackedNumbers {
public:
    /// At the first block.
    explicit PackedNumbers(std::span<const std::byte> stream) noexcept : rest_(stream) {}

    /// Gives the next numbers to `use`, one after the other. @param count  kBlock, or what is left
    /// @return false if the stream is too short, or a number does not fit a Word
    template <class Word, class Use>
    [[nodiscard]] bool each(std::size_t count, Use use) noexcept {
        if (rest_.empty()) {
            return false;
        }
        const auto width = std::to_integer<std::size_t>(rest_[0]);
        const std::size_t size = (count * width + 7) / 8;
        if (width > std::numeric_limits<Word>::digits || rest_.size() <= size) {
            return false;
        }
        if (width == 0) {
            for (std::size_t i = 0; i < count; ++i) {
                use(Word{0});
            }
        } else {
            std::memcpy(bits_.data(), rest_.data() + 1, size);
            take<Word>(width, count, use);
        }
        rest_ = rest_.subspan(1 + size);
        return true;
    }

    /// All bytes were read.
    [[nodiscard]] bool at_end() const noexcept { return rest_.empty(); }

private:
    static constexpr std::size_t kMore =
        2 * sizeof(std::uint64_t);  ///< may be read behind the last

    template <class Word, class Use>
    void take(std::size_t width, std::size_t count, Use& use) const noexcept {
        const std::uint64_t mask = ~std::uint64_t{0} >> (64U - width);
        for (std::size_t bit = 0; bit < count * width; bit += width) {
            const std::byte* const at = bits_.data() + bit / 8;
            const std::size_t shift = bit % 8;
            std::uint64_t low = 0;
            std::memcpy(&low, at, sizeof low);
            low >>= shift;
            if constexpr (sizeof(Word) == sizeof low) {  // may lie in nine bytes
                low |= std::to_integer<std::uint64_t>(at[sizeof low]) << 1U << (63U - shift);
            }
            use(static_cast<Word>(low & mask));
        }
    }

    std::span<const std::byte> rest_;
    std::array<std::byte, kBlock * sizeof(std::uint64_t) + kMore> bits_{};
};

}  // namespace palpate::data

#include "data/trace/packed_numbers.hpp"

#include <bit>

namespace palpate::data {

static_assert(std::endian::native == std::endian::little, "bits are copied as they lie in memory");

void pack_numbers(std::span<const std::uint64_t> numbers, std::vector<std::byte>& data) {
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

}  // namespace palpate::data

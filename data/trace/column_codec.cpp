#include "data/trace/column_codec.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <new>
#include <type_traits>
#include <utility>

#include <zlib.h>

#include "engine/base/processor.hpp"
#include "data/trace/columns.hpp"
#include "data/trace/packed_numbers.hpp"

namespace palpate::data {
namespace {

using engine::TickRecord;

/// 0, -1, 1, -2 -> 0, 1, 2, 3, in two's complement of a Word.
template <class Word>
constexpr Word fold(Word value) noexcept {
    return static_cast<Word>(value << 1U) ^
           static_cast<Word>(Word{0} - (value >> (std::numeric_limits<Word>::digits - 1)));
}
template <class Word>
constexpr Word unfold(Word folded) noexcept {
    return (folded >> 1U) ^ (Word{0} - (folded & 1U));
}

/// The lowest `size` bytes at `at`, as a number.
std::uint64_t bits_at(const std::byte* at, std::size_t size) noexcept {
    std::uint64_t bits = 0;
    std::memcpy(&bits, at, size);
    return bits;
}

void shuffle_exact(const StoredColumn& column, std::span<const TickRecord> ticks, std::byte* out) {
    constexpr std::size_t kToForce = offsetof(TickRecord, command) - offsetof(TickRecord, force);
    for (const TickRecord& tick : ticks) {
        const auto* const at = reinterpret_cast<const std::byte*>(&tick) + column.offset;
        std::uint64_t bits = bits_at(at, column.size);
        if (column.part == part_command) {
            bits ^= bits_at(at - kToForce, column.size);
        }
        for (std::size_t byte = 0; byte < column.size; ++byte) {
            out[byte * ticks.size()] = static_cast<std::byte>(bits >> (8U * byte));
        }
        ++out;
    }
}

bool all_zero(std::span<const std::byte> bytes) noexcept {
    return bytes.empty() || (bytes[0] == std::byte{0} &&
                             std::memcmp(bytes.data(), bytes.data() + 1, bytes.size() - 1) == 0);
}

/// Adds the zlib stream of `bytes` to `data`, nothing if all are 0.
void deflate(std::span<const std::byte> bytes, std::vector<std::byte>& data) {
    if (all_zero(bytes)) {
        return;
    }
    const std::size_t at = data.size();
    uLongf size = compressBound(bytes.size());
    data.resize(at + size);
    if (compress2(reinterpret_cast<Bytef*>(data.data() + at), &size,
                  reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(),
                  Z_BEST_SPEED) != Z_OK) {
        throw std::bad_alloc();
    }
    data.resize(at + size);
}

/// @param value_of  of a number as written
template <class Word, class Value, class Read>
bool each_number(std::span<const std::byte> stream,
                 std::span<Value> values,
                 Read value_of) noexcept {
    PackedNumbers numbers(stream);
    for (std::size_t first = 0; first < values.size(); first += kBlock) {
        const auto part = values.subspan(first, std::min(kBlock, values.size() - first));
        const auto put = [&value_of, at = part.data()](Word number) mutable {
            *at++ = value_of(number);
        };
        if (!numbers.each<Word>(part.size(), put)) {
            return false;
        }
    }
    return numbers.at_end();
}

/// Values of a byte are not negative, and each number is what flips in the one before.
template <class Value>
bool read_bytes(std::span<const std::byte> stream, std::span<Value> values) noexcept {
    if (stream.empty()) {
        std::ranges::fill(values, Value{0});
        return true;
    }
    return each_number<std::uint8_t>(stream, values,
                                     [before = std::uint8_t{0}](std::uint8_t number) mutable {
                                         before ^= number;
                                         return before;
                                     });
}

/// What a stream of no bytes says: every number is 0.
template <class Word, class Value>
void foretold(Rule rule, std::int64_t first_tick, std::span<Value> values) noexcept {
    const bool after = rule == Rule::after;
    const Word first = after ? static_cast<Word>(first_tick) : Word{0};
    for (std::size_t i = 0; i < values.size(); ++i) {
        const auto value = static_cast<Word>(after ? first + static_cast<Word>(i) : first);
        values[i] = static_cast<Value>(static_cast<std::make_signed_t<Word>>(value));
    }
}

template <class Word, class Value>
bool read_words(Rule rule,
                std::span<const std::byte> stream,
                std::int64_t first_tick,
                std::span<Value> values) noexcept {
    using Signed = std::make_signed_t<Word>;
    if (stream.empty()) {
        foretold<Word>(rule, first_tick, values);
        return true;
    }
    if (rule == Rule::plain) {
        return each_number<Word>(stream, values,
                                 [](Word number) { return static_cast<Signed>(number); });
    }
    // In two's complement of a Word.
    if (rule == Rule::line) {
        return each_number<Word>(stream, values,
                                 [before = Word{0}, step = Word{0}](Word number) mutable {
                                     step += unfold(number);
                                     return static_cast<Signed>(before += step);
                                 });
    }
    const Word more = rule == Rule::after ? Word{1} : Word{0};
    const Word first = rule == Rule::after ? static_cast<Word>(first_tick) - 1 : Word{0};
    return each_number<Word>(stream, values, [more, before = first](Word number) mutable {
        return static_cast<Signed>(before += unfold(number) + more);
    });
}

template <std::size_t Size>
void unshuffle(std::span<const std::byte> bytes,
               std::size_t offset,
               std::span<TickRecord> ticks) noexcept {
    const std::size_t n = bytes.size() / Size;
    const std::byte* in = bytes.data();
    for (TickRecord& tick : ticks) {
        std::uint64_t bits = 0;
        for (std::size_t byte = 0; byte < Size; ++byte) {
            bits |= std::to_integer<std::uint64_t>(in[byte * n]) << (8U * byte);
        }
        std::memcpy(reinterpret_cast<std::byte*>(&tick) + offset, &bits, Size);
        ++in;
    }
}

/// The stream of a column, block by block; none if all its numbers are 0.
/// @param numbers_of  puts the numbers of values and their ticks
/// @param from_zero   numbers are 0 as long as the values are
template <class Numbers>
void pack_blocks(ColumnId which,
                 std::span<const TickRecord> ticks,
                 bool from_zero,
                 Numbers numbers_of,
                 std::vector<std::byte>& data) {
    const std::size_t at = data.size();
    std::array<std::int64_t, kBlock> values;
    std::array<std::uint64_t, kBlock> numbers;
    std::uint64_t all = 0;
    for (std::size_t first = 0; first < ticks.size(); first += kBlock) {
        const auto part = ticks.subspan(first, std::min(kBlock, ticks.size() - first));
        const auto stored = std::span(values).first(part.size());
        stored_values(which, part, stored);
        if (all == 0 && from_zero && all_zero(std::as_bytes(stored))) {
            data.push_back(std::byte{0});  // of no bits, as pack_numbers() says it
            continue;
        }
        const auto made = std::span(numbers).first(part.size());
        numbers_of(stored, part, made);
        for (const std::uint64_t number : made) {
            all |= number;
        }
        pack_numbers(made, data);
    }
    if (all == 0) {
        data.resize(at);
    }
}

/// What a rule leaves of values, block after block, for vector instructions:
///
///     number = value - a (the one before) + b (the one before that) - c
template <class Word>
class Differences {
public:
    Differences(Rule rule, const ChunkClock& clock) noexcept
        : a_(rule == Rule::line ? Word{2} : Word{1}),
          b_(rule == Rule::line ? Word{1} : Word{0}),
          c_(rule == Rule::after ? Word{1} : Word{0}),
          period_(rule == Rule::clock ? static_cast<Word>(clock.period_ns) : Word{0}) {
        values_[1] = rule == Rule::after ? static_cast<Word>(clock.first_tick) - 1 : Word{0};
    }

    void operator()(std::span<const std::int64_t> stored,
                    std::span<const TickRecord> ticks,
                    std::span<std::uint64_t> numbers) noexcept {
        for (std::size_t i = 0; period_ != 0 && i < stored.size(); ++i) {
            due_[i] = static_cast<Word>(ticks[i].tick) * period_;
        }
        as_this_processor_can([&] {
            // Copies, which no store into an array can change: else nothing becomes a vector.
            const std::size_t n = stored.size();
            const auto [a, b, c] = std::array{a_, b_, c_};
            auto* const to = numbers.data();
            for (std::size_t i = 0; i < n; ++i) {
                values_[i + 2] = static_cast<Word>(stored[i]) - due_[i];
            }
            for (std::size_t i = 0; i < n; ++i) {
                to[i] = fold<Word>(values_[i + 2] - a * values_[i + 1] + b * values_[i] - c);
            }
        });
        values_[0] = values_[stored.size()];
        values_[1] = values_[stored.size() + 1];
    }

private:
    Word a_;
    Word b_;
    Word c_;
    Word period_;
    std::array<Word, kBlock> due_{};
    std::array<Word, kBlock + 2> values_{};  ///< behind the two before them
};

using Values = void(std::span<const TickRecord>, std::span<std::int64_t>);

/// Puts what `Of` says of each tick.
template <class Of>
constexpr Values* values(Of /*of*/) {
    return [](std::span<const TickRecord> ticks, std::span<std::int64_t> stored) {
        std::transform(ticks.begin(), ticks.end(), stored.begin(), Of{});
    };
}

}  // namespace

void stored_values(ColumnId column,
                   std::span<const TickRecord> ticks,
                   std::span<std::int64_t> stored) noexcept {
    static constexpr std::array<Values*, kStoredColumns> kAll{
        values([](const TickRecord& tick) { return tick.tick; }),
        values([](const TickRecord& tick) { return tick.time_ns; }),
        values([](const TickRecord& tick) { return tick.counts[0]; }),
        values([](const TickRecord& tick) { return tick.counts[1]; }),
        values([](const TickRecord& tick) { return tick.codes[0]; }),
        values([](const TickRecord& tick) { return tick.codes[1]; }),
        values([](const TickRecord& tick) {
            return in_steps(static_cast<double>(tick.lateness_us), kLatenessSteps);
        }),
        values([](const TickRecord& tick) { return tick.flags; }),
        values([](const TickRecord& tick) { return in_steps(tick.hip.x, kHipSteps); }),
        values([](const TickRecord& tick) { return in_steps(tick.hip.y, kHipSteps); }),
        values([](const TickRecord& tick) { return in_steps(tick.command.x, kCommandSteps); }),
        values([](const TickRecord& tick) { return in_steps(tick.command.y, kCommandSteps); }),
        values([](const TickRecord& tick) { return tick.counts[2]; }),
        values([](const TickRecord& tick) { return tick.codes[2]; }),
        values([](const TickRecord& tick) { return in_steps(tick.hip.z, kHipSteps); }),
        values([](const TickRecord& tick) { return in_steps(tick.command.z, kCommandSteps); })};
    kAll[static_cast<std::size_t>(column)](ticks, stored);
}

void pack_column(ColumnId which,
                 std::span<const TickRecord> ticks,
                 const ChunkClock& clock,
                 std::vector<std::byte>& data) {
    const StoredColumn& column = stored_columns()[static_cast<std::size_t>(which)];
    const bool flips = column.rule == Rule::flip;
    const bool from_zero = flips || column.rule == Rule::line || column.rule == Rule::plain;
    if (flips || column.rule == Rule::plain) {
        const auto masked = [mask = ~std::uint64_t{0} >> (64U - 8U * column.size), flips,
                             before = std::uint64_t{0}](std::span<const std::int64_t> stored,
                                                        std::span<const TickRecord> /*ticks*/,
                                                        std::span<std::uint64_t> numbers) mutable {
            std::ranges::transform(stored, numbers.begin(), [&](std::int64_t value) {
                const std::uint64_t bits = static_cast<std::uint64_t>(value) & mask;
                return bits ^ std::exchange(before, flips ? bits : 0);
            });
        };
        pack_blocks(which, ticks, from_zero, masked, data);
    } else if (column.size == sizeof(std::uint32_t)) {
        pack_blocks(which, ticks, from_zero, Differences<std::uint32_t>(column.rule, clock), data);
    } else {
        pack_blocks(which, ticks, from_zero, Differences<std::uint64_t>(column.rule, clock), data);
    }
}

void pack_exact(const StoredColumn& column,
                std::span<const TickRecord> ticks,
                std::vector<std::byte>& data) {
    std::vector<std::byte> bytes(ticks.size() * column.size);
    shuffle_exact(column, ticks, bytes.data());
    deflate(bytes, data);
}

bool unpack_column(ColumnId which,
                   std::span<const std::byte> stream,
                   std::int64_t first_tick,
                   std::span<std::int32_t> values) noexcept {
    const StoredColumn& column = stored_columns()[static_cast<std::size_t>(which)];
    return column.size == 1 ? read_bytes(stream, values)
                            : read_words<std::uint32_t>(column.rule, stream, first_tick, values);
}

bool unpack_column(ColumnId which,
                   std::span<const std::byte> stream,
                   std::int64_t first_tick,
                   std::span<std::int64_t> values) noexcept {
    const StoredColumn& column = stored_columns()[static_cast<std::size_t>(which)];
    return column.size == 1 ? read_bytes(stream, values)
         : column.size == sizeof(std::uint32_t)
             ? read_words<std::uint32_t>(column.rule, stream, first_tick, values)
             : read_words<std::uint64_t>(column.rule, stream, first_tick, values);
}

ExactColumn::ExactColumn(const StoredColumn& column,
                         std::span<const std::byte> stream,
                         std::size_t ticks)
    : column_(&column), bytes_(ticks * column.size) {
    uLongf size = bytes_.size();
    uLong used = stream.size();
    holds_ = stream.empty() ||
             (uncompress2(reinterpret_cast<Bytef*>(bytes_.data()), &size,
                          reinterpret_cast<const Bytef*>(stream.data()), &used) == Z_OK &&
              size == bytes_.size() && used == stream.size());
}

void ExactColumn::into(std::span<TickRecord> ticks) const noexcept {
    const auto fill = column_->size == 1 ? unshuffle<1>
                    : column_->size == 2 ? unshuffle<2>
                    : column_->size == 4 ? unshuffle<4>
                                         : unshuffle<8>;
    fill(bytes_, column_->offset, ticks);
}

}  // namespace palpate::data

#include "data/trace/chunk.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

#include <fmt/format.h>
#include <zlib.h>

#include "data/trace/fixed_point.hpp"

namespace palpate::data {
namespace {

using engine::TickRecord;

constexpr std::size_t kWord = sizeof(std::uint32_t);

std::uint32_t crc_of(std::span<const std::byte> bytes) {
    return static_cast<std::uint32_t>(
        ::crc32(0L, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size())));
}

bool is_held(const StoredColumn& column, std::uint8_t parts) noexcept {
    return column.part == 0 || (column.part & parts) != 0;
}

/// 0, -1, 1, -2 -> 0, 1, 2, 3. Wraps round in 64 bits, as does its inverse.
constexpr std::uint64_t fold(std::uint64_t value) noexcept {
    return (value << 1U) ^ (0U - (value >> 63U));
}
template <class Word>
constexpr Word unfold(Word folded) noexcept {
    return (folded >> 1U) ^ (Word{0} - (folded & 1U));
}

/// The value of the column's two's complement that is the same but for multiples of 2^(8 size).
constexpr std::uint64_t in_width(std::size_t size, std::uint64_t value) noexcept {
    return size == 4 ? static_cast<std::uint64_t>(
                           static_cast<std::int64_t>(static_cast<std::int32_t>(value)))
                     : value;
}

}  // namespace

std::int64_t stored_value(Stored column, const TickRecord& tick) noexcept {
    switch (column) {
        case Stored::tick:
            return tick.tick;
        case Stored::time_ns:
            return tick.time_ns;
        case Stored::count_1:
            return tick.counts[0];
        case Stored::count_2:
            return tick.counts[1];
        case Stored::code_1:
            return tick.codes[0];
        case Stored::code_2:
            return tick.codes[1];
        case Stored::lateness_ns:
            return in_steps(static_cast<double>(tick.lateness_us), kLatenessSteps);
        case Stored::flags:
            return tick.flags;
        case Stored::hip_x:
            return in_steps(tick.hip.x, kHipSteps);
        case Stored::hip_y:
            return in_steps(tick.hip.y, kHipSteps);
        case Stored::command_x:
            return in_steps(tick.command.x, kCommandSteps);
        case Stored::command_y:
            break;
    }
    return in_steps(tick.command.y, kCommandSteps);
}

namespace {

/// What is subtracted from the first value, what more at every step.
struct Start {
    std::uint64_t before = 0;
    std::uint64_t step = 0;
};

Start start_of(Rule rule, std::int64_t first_tick) noexcept {
    const auto first = static_cast<std::uint64_t>(first_tick);
    return rule == Rule::after ? Start{.before = first - 1, .step = 1} : Start{};
}

void numbers_of(std::size_t index,
                std::span<const TickRecord> ticks,
                std::int64_t first_tick,
                std::int64_t period_ns,
                std::vector<std::uint64_t>& numbers) {
    const StoredColumn& column = stored_columns()[index];
    auto [before, step] = start_of(column.rule, first_tick);
    for (std::size_t i = 0; i < ticks.size(); ++i) {
        auto value = static_cast<std::uint64_t>(stored_value(static_cast<Stored>(index), ticks[i]));
        if (column.rule == Rule::plain) {
            numbers[i] = value;
            continue;
        }
        if (column.rule == Rule::clock) {
            value -=
                static_cast<std::uint64_t>(ticks[i].tick) * static_cast<std::uint64_t>(period_ns);
        }
        numbers[i] = fold(in_width(column.size, value - before - step));
        before = value;
    }
}

void shuffle(std::span<const std::uint64_t> numbers, std::size_t size, std::byte* out) {
    for (std::size_t byte = 0; byte < size; ++byte) {
        for (const std::uint64_t number : numbers) {
            *out++ = static_cast<std::byte>(number >> (8U * byte));
        }
    }
}

void shuffle_exact(const StoredColumn& column, std::span<const TickRecord> ticks, std::byte* out) {
    for (std::size_t byte = 0; byte < column.size; ++byte) {
        for (const TickRecord& tick : ticks) {
            const auto* at = reinterpret_cast<const std::byte*>(&tick) + byte;
            std::byte value = at[column.offset];
            if (column.part == part_command) {
                value ^=
                    at[column.offset - offsetof(TickRecord, command) + offsetof(TickRecord, force)];
            }
            *out++ = value;
        }
    }
}

bool all_zero(std::span<const std::byte> bytes) noexcept {
    return bytes.empty() || (bytes[0] == std::byte{0} &&
                             std::memcmp(bytes.data(), bytes.data() + 1, bytes.size() - 1) == 0);
}

/// Adds the stream of `bytes` to `data`. @return its size
std::uint32_t pack(std::span<const std::byte> bytes, std::vector<std::byte>& data) {
    if (all_zero(bytes)) {
        return 0;
    }
    const std::size_t at = data.size();
    uLongf size = compressBound(bytes.size());
    data.resize(at + size);
    if (compress2(reinterpret_cast<Bytef*>(data.data() + at), &size,
                  reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(),
                  Z_BEST_SPEED) != Z_OK) {
        throw TraceError("a trace chunk could not be compressed: out of memory");
    }
    data.resize(at + size);
    return static_cast<std::uint32_t>(size);
}

[[noreturn]] void damaged(std::string_view why) {
    throw TraceError(fmt::format("a trace chunk is damaged: {}", why));
}

}  // namespace

EncodedChunk encode_chunk(std::span<const TickRecord> ticks,
                          std::int64_t first_tick,
                          std::int64_t period_ns,
                          std::uint8_t parts) {
    if (ticks.empty() || ticks.size() > kChunkTicks) {
        throw TraceError(
            fmt::format("a trace chunk holds 1 to {} ticks, not {}", kChunkTicks, ticks.size()));
    }
    std::vector<std::uint32_t> sizes;
    EncodedChunk chunk;
    const auto columns = stored_columns();
    const auto held = static_cast<std::size_t>(std::count_if(
        columns.begin(), columns.end(), [parts](const auto& c) { return is_held(c, parts); }));
    chunk.data.resize(held * kWord);
    std::vector<std::uint64_t> numbers(ticks.size());
    std::vector<std::byte> bytes(ticks.size() * sizeof(std::uint64_t));
    for (std::size_t i = 0; i < columns.size(); ++i) {
        if (!is_held(columns[i], parts)) {
            continue;
        }
        if (i < kStoredColumns) {
            numbers_of(i, ticks, first_tick, period_ns, numbers);
            shuffle(numbers, columns[i].size, bytes.data());
        } else {
            shuffle_exact(columns[i], ticks, bytes.data());
        }
        sizes.push_back(pack(std::span(bytes).first(ticks.size() * columns[i].size), chunk.data));
    }
    std::memcpy(chunk.data.data(), sizes.data(), sizes.size() * kWord);
    chunk.crc32 = crc_of(chunk.data);
    return chunk;
}

ChunkReader::ChunkReader(const ChunkView& chunk)
    : chunk_(chunk), streams_(stored_columns().size()) {
    if (chunk.codec != kTraceCodec) {
        throw TraceError(fmt::format("trace codec {} is unknown; update palpate", chunk.codec));
    }
    if (chunk.ticks < 1 || chunk.ticks > kChunkTicks) {
        throw TraceError(
            fmt::format("a trace chunk holds 1 to {} ticks, not {}", kChunkTicks, chunk.ticks));
    }
    if (crc_of(chunk.data) != chunk.crc32) {
        damaged("its checksum differs");
    }
    const auto columns = stored_columns();
    const auto held = static_cast<std::size_t>(
        std::count_if(columns.begin(), columns.end(),
                      [&chunk](const auto& c) { return is_held(c, chunk.parts); }));
    std::size_t at = held * kWord;
    std::size_t word = 0;
    for (std::size_t i = 0; i < columns.size(); ++i) {
        if (!is_held(columns[i], chunk.parts)) {
            continue;
        }
        std::uint32_t size = 0;
        if (chunk.data.size() < at) {
            damaged("it is too short");
        }
        std::memcpy(&size, chunk.data.data() + kWord * word++, kWord);
        if (size > chunk.data.size() - at) {
            damaged("it is too short");
        }
        streams_[i] = chunk.data.subspan(at, size);
        at += size;
    }
    if (at != chunk.data.size()) {
        damaged("it is too long");
    }
    bytes_.resize(chunk.ticks * sizeof(std::uint64_t));
}

std::span<const std::byte> ChunkReader::unpack(std::size_t column) {
    const auto stream = streams_[column];
    if (stream.empty()) {
        return {};
    }
    const auto bytes = std::span(bytes_).first(chunk_.ticks * stored_columns()[column].size);
    uLongf size = bytes.size();
    uLong used = stream.size();
    const int code = uncompress2(reinterpret_cast<Bytef*>(bytes.data()), &size,
                                 reinterpret_cast<const Bytef*>(stream.data()), &used);
    if (code != Z_OK || size != bytes.size() || used != stream.size()) {
        damaged(
            fmt::format("{} does not hold {} ticks", stored_columns()[column].name, chunk_.ticks));
    }
    return bytes;
}

namespace {

/// The numbers of which `bytes` has the lowest bytes first, then the next ones; nothing: all are 0.
template <std::size_t Size>
void unshuffle(std::span<const std::byte> bytes, std::span<std::int64_t> values) noexcept {
    if (bytes.empty()) {
        std::fill(values.begin(), values.end(), 0);
        return;
    }
    const std::size_t n = values.size();
    const std::byte* const in = bytes.data();
    for (std::size_t i = 0; i < n; ++i) {
        std::uint64_t number = 0;
        for (std::size_t byte = 0; byte < Size; ++byte) {
            number |= std::to_integer<std::uint64_t>(in[byte * n + i]) << (8U * byte);
        }
        values[i] = static_cast<std::int64_t>(number);
    }
}

/// The values of folded differences, in two's complement of a Word.
template <class Word>
void undo_delta(const Start& start, std::span<std::int64_t> values) noexcept {
    auto before = static_cast<Word>(start.before);
    const auto step = static_cast<Word>(start.step);
    for (std::int64_t& value : values) {
        before += unfold(static_cast<Word>(value)) + step;
        value = static_cast<std::make_signed_t<Word>>(before);
    }
}

}  // namespace

void ChunkReader::read(Stored which, std::span<std::int64_t> values) {
    const auto index = static_cast<std::size_t>(which);
    const StoredColumn& column = stored_columns()[index];
    switch (column.size) {
        case 1:
            unshuffle<1>(unpack(index), values);
            return;
        case 4:
            unshuffle<4>(unpack(index), values);
            undo_delta<std::uint32_t>(start_of(column.rule, chunk_.first_tick), values);
            return;
        default:
            break;
    }
    std::vector<std::int64_t> ticks;
    if (column.rule == Rule::clock) {
        ticks.resize(chunk_.ticks);
        read(Stored::tick, ticks);
    }
    unshuffle<8>(unpack(index), values);
    undo_delta<std::uint64_t>(start_of(column.rule, chunk_.first_tick), values);
    for (std::size_t i = 0; i < ticks.size(); ++i) {
        const std::uint64_t due =
            static_cast<std::uint64_t>(ticks[i]) * static_cast<std::uint64_t>(chunk_.period_ns);
        values[i] = static_cast<std::int64_t>(static_cast<std::uint64_t>(values[i]) + due);
    }
}

void ChunkReader::read_exact(std::span<TickRecord> ticks) {
    const auto columns = stored_columns();
    for (std::size_t i = kStoredColumns; i < columns.size(); ++i) {
        if (!is_held(columns[i], chunk_.parts)) {
            continue;
        }
        const auto bytes = unpack(i);
        const std::byte* in = bytes.data();
        for (std::size_t byte = 0; byte < columns[i].size; ++byte) {
            for (TickRecord& tick : ticks) {
                reinterpret_cast<std::byte*>(&tick)[columns[i].offset + byte] =
                    bytes.empty() ? std::byte{0} : *in++;
            }
        }
    }
}

std::string parts_text(std::uint8_t parts) {
    std::string text;
    for (const std::uint8_t part : {part_hip, part_contact, part_command, part_lateness}) {
        if ((parts & part) != 0) {
            text += text.empty() ? "" : " ";
            text += part_name(part);
        }
    }
    return text;
}

std::uint8_t parts_of(std::string_view text) {
    for (std::uint8_t parts = 0; parts <= kAllParts; ++parts) {
        if (parts_text(parts) == text) {
            return parts;
        }
    }
    throw TraceError(fmt::format("a trace chunk holds \"{}\"; update palpate", text));
}

}  // namespace palpate::data

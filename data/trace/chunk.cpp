#include "data/trace/chunk.hpp"

#include <algorithm>
#include <cstring>
#include <limits>

#include <fmt/format.h>
#include <zlib.h>

#include "engine/base/refuse.hpp"

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

/// Bytes that say how long the streams are.
std::size_t head_size(std::uint8_t parts) {
    return kWord * static_cast<std::size_t>(std::ranges::count_if(
                       stored_columns(), [parts](const auto& c) { return is_held(c, parts); }));
}

void damaged_if(bool wrong, std::string_view why) {
    refuse_if<TraceError>(wrong, "a trace chunk is damaged: {}", why);
}

void require(bool held, std::string_view column, std::size_t ticks) {
    refuse_if<TraceError>(!held, "a trace chunk is damaged: {} does not hold {} ticks", column,
                          ticks);
}

void check_head(const ChunkView& chunk) {
    refuse_if<TraceError>(chunk.codec != kTraceCodec, "trace codec {} is unknown; update palpate",
                          chunk.codec);
    refuse_if<TraceError>(chunk.ticks < 1 || chunk.ticks > kChunkTicks,
                          "a trace chunk holds 1 to {} ticks, not {}", kChunkTicks, chunk.ticks);
    damaged_if(crc_of(chunk.data) != chunk.crc32, "its checksum differs");
}

}  // namespace

EncodedChunk encode_chunk(std::span<const TickRecord> ticks,
                          std::int64_t first_tick,
                          std::int64_t period_ns,
                          std::uint8_t parts) {
    refuse_if<TraceError>(ticks.empty() || ticks.size() > kChunkTicks,
                          "a trace chunk holds 1 to {} ticks, not {}", kChunkTicks, ticks.size());
    std::vector<std::uint32_t> sizes;
    EncodedChunk chunk;
    const auto columns = stored_columns();
    chunk.data.resize(head_size(parts));
    const ChunkClock clock{.first_tick = first_tick, .period_ns = period_ns};
    for (std::size_t i = 0; i < columns.size(); ++i) {
        if (!is_held(columns[i], parts)) {
            continue;
        }
        const std::size_t before = chunk.data.size();
        if (i < kStoredColumns) {
            pack_column(static_cast<ColumnId>(i), ticks, clock, chunk.data);
        } else {
            pack_exact(columns[i], ticks, chunk.data);
        }
        sizes.push_back(static_cast<std::uint32_t>(chunk.data.size() - before));
    }
    std::memcpy(chunk.data.data(), sizes.data(), sizes.size() * kWord);
    chunk.crc32 = crc_of(chunk.data);
    return chunk;
}

ChunkReader::ChunkReader(const ChunkView& chunk) : chunk_(chunk) {
    check_head(chunk);
    const auto columns = stored_columns();
    std::size_t at = head_size(chunk.parts);
    std::size_t word = 0;
    for (std::size_t i = 0; i < columns.size(); ++i) {
        if (!is_held(columns[i], chunk.parts)) {
            continue;
        }
        std::uint32_t size = 0;
        damaged_if(chunk.data.size() < at, "it is too short");
        std::memcpy(&size, chunk.data.data() + kWord * word++, kWord);
        damaged_if(size > chunk.data.size() - at, "it is too short");
        streams_[i] = chunk.data.subspan(at, size);
        at += size;
    }
    damaged_if(at != chunk.data.size(), "it is too long");
}

void ChunkReader::read(ColumnId column, std::span<std::int32_t> values) const {
    const auto index = static_cast<std::size_t>(column);
    require(unpack_column(column, streams_[index], chunk_.first_tick, values),
            stored_columns()[index].name, chunk_.ticks);
}

void ChunkReader::read(ColumnId column, std::span<std::int64_t> values) const {
    const auto index = static_cast<std::size_t>(column);
    require(unpack_column(column, streams_[index], chunk_.first_tick, values),
            stored_columns()[index].name, chunk_.ticks);
    if (stored_columns()[index].rule == Rule::clock) {
        std::array<std::int64_t, kChunkTicks> all;
        const auto ticks = std::span(all).first(values.size());
        read(ColumnId::tick, ticks);
        for (std::size_t i = 0; i < ticks.size(); ++i) {
            const std::uint64_t due =
                static_cast<std::uint64_t>(ticks[i]) * static_cast<std::uint64_t>(chunk_.period_ns);
            values[i] = static_cast<std::int64_t>(static_cast<std::uint64_t>(values[i]) + due);
        }
    }
}

std::vector<ExactColumn> ChunkReader::exact() const {
    std::vector<ExactColumn> held;
    const auto columns = stored_columns();
    for (std::size_t i = kStoredColumns; i < columns.size(); ++i) {
        if (is_held(columns[i], chunk_.parts)) {
            held.emplace_back(columns[i], streams_[i], chunk_.ticks);
            require(held.back().holds(), columns[i].name, chunk_.ticks);
        }
    }
    return held;
}

void ChunkReader::read_exact(std::span<TickRecord> ticks) const {
    for (const ExactColumn& column : exact()) {
        column.into(ticks);
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

std::uint32_t crc32_of(std::int64_t stored) {
    refuse_if<TraceError>(stored < 0 || stored > std::numeric_limits<std::uint32_t>::max(),
                          "crc32 {} has more than 32 bits", stored);
    return static_cast<std::uint32_t>(stored);
}

}  // namespace palpate::data

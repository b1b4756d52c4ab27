#include "data/trace/codec.hpp"

#include <cstring>

#include <zlib.h>

#include "data/trace/columns.hpp"

namespace palpate::data {
namespace {

std::uint32_t crc_of(std::span<const std::byte> bytes) {
    return static_cast<std::uint32_t>(
        ::crc32(0L, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size())));
}

}  // namespace

std::vector<std::byte> shuffled_columns(std::span<const engine::TickRecord> ticks) {
    std::vector<std::byte> raw(ticks.size() * bytes_per_tick());
    std::byte* out = raw.data();
    for (const TraceColumn& column : trace_columns()) {
        for (std::size_t byte = 0; byte < column.size; ++byte) {
            for (const engine::TickRecord& tick : ticks) {
                *out++ = reinterpret_cast<const std::byte*>(&tick)[column.offset + byte];
            }
        }
    }
    return raw;
}

EncodedChunk encode(std::span<const engine::TickRecord> ticks) {
    if (ticks.empty() || ticks.size() > kChunkTicks) {
        throw TraceError("a trace chunk holds 1 to 256 ticks, not " + std::to_string(ticks.size()));
    }
    const std::vector<std::byte> raw = shuffled_columns(ticks);
    EncodedChunk chunk{.data = std::vector<std::byte>(compressBound(raw.size())),
                       .crc32 = crc_of(raw)};
    uLongf size = chunk.data.size();
    if (compress2(reinterpret_cast<Bytef*>(chunk.data.data()), &size,
                  reinterpret_cast<const Bytef*>(raw.data()), raw.size(), Z_BEST_SPEED) != Z_OK) {
        throw TraceError("a trace chunk could not be compressed: out of memory");
    }
    chunk.data.resize(size);
    return chunk;
}

std::vector<engine::TickRecord> decode(std::span<const std::byte> data,
                                       std::size_t ticks,
                                       std::uint32_t crc32) {
    if (ticks == 0 || ticks > kChunkTicks) {
        throw TraceError("a trace chunk holds 1 to 256 ticks, not " + std::to_string(ticks));
    }
    std::vector<std::byte> raw(ticks * bytes_per_tick());
    uLongf size = raw.size();
    uLong used = data.size();
    const int code = uncompress2(reinterpret_cast<Bytef*>(raw.data()), &size,
                                 reinterpret_cast<const Bytef*>(data.data()), &used);
    if (code != Z_OK || size != raw.size() || used != data.size()) {
        throw TraceError("a trace chunk is damaged: its zlib stream does not hold " +
                         std::to_string(ticks) + " ticks");
    }
    if (crc_of(raw) != crc32) {
        throw TraceError("a trace chunk is damaged: its checksum differs");
    }
    std::vector<engine::TickRecord> records(ticks);
    const std::byte* in = raw.data();
    for (const TraceColumn& column : trace_columns()) {
        for (std::size_t byte = 0; byte < column.size; ++byte) {
            for (engine::TickRecord& tick : records) {
                reinterpret_cast<std::byte*>(&tick)[column.offset + byte] = *in++;
            }
        }
    }
    for (const engine::TickRecord& tick : records) {
        if (static_cast<unsigned>(tick.mode) > static_cast<unsigned>(engine::Mode::transition)) {
            throw TraceError("a trace chunk holds an unknown contact mode");
        }
    }
    return records;
}

}  // namespace palpate::data

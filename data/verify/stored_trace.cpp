#include "data/verify/stored_trace.hpp"

#include <limits>

#include <fmt/format.h>
#include <zlib.h>

#include "data/trace/codec.hpp"
#include "data/trace/columns.hpp"

namespace palpate::data {
namespace {

/// One chunk as it should follow `next` ticks; throws what is wrong with it.
std::vector<engine::TickRecord> checked_chunk(const Statement& row, std::int64_t next) {
    const std::int64_t first = row.integer(0);
    const std::int64_t count = row.integer(1);
    if (row.integer(2) != kTraceCodec) {
        throw TraceError(fmt::format("codec {} is unknown", row.integer(2)));
    }
    if (count < 1 || count > static_cast<std::int64_t>(kChunkTicks)) {
        throw TraceError(fmt::format("{} ticks", count));
    }
    if (row.integer(3) < 0 || row.integer(3) > std::numeric_limits<std::uint32_t>::max()) {
        throw TraceError(fmt::format("crc32 {} has more than 32 bits", row.integer(3)));
    }
    auto ticks = decode(row.blob(4), static_cast<std::size_t>(count),
                        static_cast<std::uint32_t>(row.integer(3)));
    if (!unused_bits_are_zero(row.blob(4), ticks.size() * bytes_per_tick())) {
        throw TraceError("unused bits of its zlib stream are set");
    }
    if (first != next) {
        throw TraceError(first > next ? fmt::format("ticks {} to {} are missing", next, first - 1)
                                      : fmt::format("it begins with tick {} again", first));
    }
    for (const engine::TickRecord& tick : ticks) {
        if (tick.tick != next) {
            throw TraceError(fmt::format("tick {} stands where tick {} belongs", tick.tick, next));
        }
        ++next;
    }
    return ticks;
}

}  // namespace

StoredTrace load_trace(Database& database, std::int64_t trial, Findings& findings) {
    StoredTrace trace;
    Statement row = database.prepare(
        "SELECT first_tick, ticks, codec, crc32, data FROM trace_chunk WHERE trial = ?1"
        " ORDER BY first_tick");
    row.bind(1, trial);
    while (row.step()) {
        const auto next = static_cast<std::int64_t>(trace.ticks.size());
        try {
            if (next % static_cast<std::int64_t>(kChunkTicks) != 0) {
                throw TraceError(
                    fmt::format("the one before it is not full: it ends before {}", next));
            }
            const auto ticks = checked_chunk(row, next);
            trace.ticks.insert(trace.ticks.end(), ticks.begin(), ticks.end());
        } catch (const TraceError& e) {
            trace.whole = false;
            findings.add({.kind = FindingKind::differs,
                          .trial = trial,
                          .tick = row.integer(0),
                          .what = "trace_chunk",
                          .stored = e.what(),
                          .recomputed = fmt::format("nothing is replayed from tick {} on", next)});
            return trace;
        }
    }
    return trace;
}

bool unused_bits_are_zero(std::span<const std::byte> stream, std::size_t raw_bytes) {
    thread_local std::vector<Bytef> raw;
    raw.resize(raw_bytes + 1);
    z_stream zip{};
    if (inflateInit(&zip) != Z_OK) {
        throw TraceError("out of memory");
    }
    // zlib only reads here, but its interface is older than const.
    zip.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(stream.data()));
    zip.avail_in = static_cast<uInt>(stream.size());
    zip.next_out = raw.data();
    zip.avail_out = static_cast<uInt>(raw.size());
    // Z_BLOCK stops at the end of every block: data_type then has the bits left in the last byte
    // taken (0 to 7), + 64 in the last block, + 128 at its end (zlib.h, inflate).
    constexpr int kLastBlockEnds = 64 + 128;
    bool zero = false;
    for (int code = Z_OK; code == Z_OK;) {
        code = inflate(&zip, Z_BLOCK);
        if (code == Z_OK && (zip.data_type & kLastBlockEnds) == kLastBlockEnds) {
            const unsigned left = static_cast<unsigned>(zip.data_type) & 7U;
            const auto last = static_cast<unsigned>(*(zip.next_in - 1));
            zero = last >> (8U - left) == 0U || left == 0U;
            break;
        }
    }
    inflateEnd(&zip);
    return zero;
}

}  // namespace palpate::data

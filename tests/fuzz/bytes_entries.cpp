#include <zlib.h>

#include "engine/device/drivers/haply_wire.hpp"
#include "engine/device/open/open_wire.hpp"
#include "data/trace/chunk.hpp"
#include "tests/fuzz/entries.hpp"

namespace palpate::fuzz {

void chunk(Bytes bytes) {
    // Row: parts, ticks (two bytes), first tick and period (two each); the checksum is right, or
    // nothing is read.
    constexpr std::size_t kRow = 7;
    if (bytes.size() < kRow) {
        return;
    }
    const auto pair = [&](std::size_t at) {
        return bytes[at] + 256U * bytes[at + 1];
    };
    const Bytes rest = bytes.subspan(kRow);
    data::ChunkView row;
    row.parts = bytes[0];
    row.ticks = pair(1);
    row.first_tick = pair(3);
    row.period_ns = 1000 * static_cast<std::int64_t>(pair(5));
    row.data = std::as_bytes(rest);
    row.crc32 =
        static_cast<std::uint32_t>(crc32(0, rest.data(), static_cast<unsigned int>(rest.size())));
    try {
        const data::ChunkReader reader(row);
        std::vector<engine::TickRecord> ticks(row.ticks);
        std::vector<std::int64_t> wide(row.ticks);
        for (std::size_t column = 0; column < data::kStoredColumns; ++column) {
            reader.read(static_cast<data::ColumnId>(column), wide);
        }
        reader.read_exact(ticks);
    } catch (const data::TraceError& refusal) {
        demand(*refusal.what() != '\0', "a refusal says why");
    }
}

void wire(Bytes bytes) {
    for (const bool sensor : {false, true}) {
        const std::size_t size = std::min(bytes.size(), engine::reply_size(sensor));
        const auto reply = engine::read_reply(bytes.first(size), 5, sensor);
        demand(!reply || (std::isfinite(reply->angle_deg[0]) && std::isfinite(reply->angle_deg[1])),
               "an answer holds finite angles");
    }
    engine::OpenReader reader;
    for (const std::uint8_t byte : bytes) {
        const auto body = reader.take(byte);
        demand(body.size() <= engine::kOpenBody, "a body is no longer than a body");
        static_cast<void>(engine::read_open(body));
    }
    static_cast<void>(engine::read_open(bytes));
    // With a right checksum every payload is looked at.
    std::vector<std::uint8_t> body(bytes.begin(), bytes.end());
    const std::uint16_t crc = engine::open_crc(body);
    body.push_back(static_cast<std::uint8_t>(crc & 0xFFU));
    body.push_back(static_cast<std::uint8_t>(crc >> 8U));
    static_cast<void>(engine::read_open(body));
}

}  // namespace palpate::fuzz

#include <algorithm>

#include "data/trace/codec.hpp"
#include "data/trace/columns.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/studies.hpp"

using namespace palpate;
using tests::random_ticks;
using tests::same_bits;

TEST_CASE("a chunk comes back to the bit, every field and every NaN", "[trace][law]") {
    const auto seed = GENERATE(range(std::uint64_t{0}, std::uint64_t{50}));
    CAPTURE(seed);
    const std::size_t count = 1 + seed * 5;
    const auto ticks = random_ticks(seed, count);
    const data::EncodedChunk chunk = data::encode(ticks);
    const auto back = data::decode(chunk.data, count, chunk.crc32);
    REQUIRE(back.size() == count);
    for (std::size_t i = 0; i < count; ++i) {
        REQUIRE(same_bits(ticks[i], back[i]));
    }
}

TEST_CASE("every byte of a tick belongs to exactly one column", "[trace][law]") {
    std::vector<int> owners(sizeof(engine::TickRecord), 0);
    for (const data::TraceColumn& column : data::trace_columns()) {
        for (std::size_t byte = 0; byte < column.size; ++byte) {
            ++owners.at(column.offset + byte);
        }
    }
    CHECK(std::count(owners.begin(), owners.end(), 1) ==
          static_cast<std::ptrdiff_t>(owners.size()));
}

TEST_CASE("no flipped bit, cut or extra byte is decoded as if nothing had happened",
          "[trace][law]") {
    const auto ticks = random_ticks(3, 20);
    const data::EncodedChunk chunk = data::encode(ticks);
    int silent = 0;
    for (std::size_t bit = 0; bit < chunk.data.size() * 8; ++bit) {
        std::vector<std::byte> damaged = chunk.data;
        damaged[bit / 8] ^= static_cast<std::byte>(1U << (bit % 8));
        try {
            const auto back = data::decode(damaged, ticks.size(), chunk.crc32);
            for (std::size_t i = 0; i < ticks.size();
                 ++i) {  // a flip that changes nothing is harmless
                silent += same_bits(back[i], ticks[i]) ? 0 : 1;
            }
        } catch (const data::TraceError&) {
        }
    }
    CHECK(silent == 0);
    for (std::size_t cut = 0; cut < chunk.data.size(); ++cut) {
        REQUIRE_THROWS_AS(data::decode(std::span(chunk.data).first(cut), ticks.size(), chunk.crc32),
                          data::TraceError);
    }
    std::vector<std::byte> longer = chunk.data;
    longer.push_back(std::byte{0});
    CHECK_THROWS_AS(data::decode(longer, ticks.size(), chunk.crc32), data::TraceError);
    CHECK_THROWS_AS(data::decode(chunk.data, ticks.size() + 1, chunk.crc32), data::TraceError);
    CHECK_THROWS_AS(data::decode(chunk.data, ticks.size() - 1, chunk.crc32), data::TraceError);
    CHECK_THROWS_AS(data::decode(chunk.data, ticks.size(), chunk.crc32 ^ 1U), data::TraceError);
    CHECK_THROWS_AS(data::decode(chunk.data, 0, chunk.crc32), data::TraceError);
    CHECK_THROWS_AS(data::encode({}), data::TraceError);
}

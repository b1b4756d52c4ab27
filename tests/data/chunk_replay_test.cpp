#include "engine/realtime/felt_scene.hpp"
#include "data/trace/chunk.hpp"
#include "data/trace/chunk_replay.hpp"
#include "data/verify/trial_check.hpp"
#include "tests/support/emulated_machine.hpp"
#include "tests/support/random.hpp"
#include "tests/support/sample_rows.hpp"

using engine::TickRecord;

namespace {

/// What a trial's chunks are replayed with.
struct Recorded {
    Recorded(data::Database& database, std::int64_t trial)
        : chunks(data::stored_chunks(database, trial)),
          traces(data::session_traces(database, 1)),
          scene(traces.scene_of(data::trial_context(database, trial).trial)),
          machine(traces.machine()) {}

    data::StoredChunks chunks;
    data::SessionTraces traces;
    std::shared_ptr<const engine::FeltScene> scene;
    std::optional<engine::PantographSpec> machine;
};

/// One tick after the other, as the servo had them: a reading, its HIP, its contact.
std::vector<TickRecord> by_scalar_ticks(const Recorded& recorded) {
    const engine::Pantograph machine(*recorded.machine);
    engine::ContactState state;
    engine::Vec2 hip{};
    std::vector<TickRecord> ticks;
    for (const data::ChunkView& view : recorded.chunks.views) {
        std::vector<std::int64_t> one(view.ticks);
        std::vector<std::int64_t> two(view.ticks);
        data::ChunkReader(view).read(data::ColumnId::count_1, one);
        data::ChunkReader(view).read(data::ColumnId::count_2, two);
        for (std::size_t i = 0; i < view.ticks; ++i) {
            TickRecord& tick = ticks.emplace_back();
            tick.counts = {static_cast<std::int32_t>(one[i]), static_cast<std::int32_t>(two[i])};
            const auto fix = machine.locate(machine.angles(tick.counts));
            hip = fix ? fix->hip : hip;
            tick.hip = engine::Vec3(hip, 0.0);
            const engine::Scene& scene = *recorded.scene->plane();
            engine::set_contact(tick, scene.tick(state, hip), scene.outline());
        }
    }
    return ticks;
}

template <class T>
bool same(const T& a, const T& b) {
    return std::memcmp(&a, &b, sizeof a) == 0;
}

bool same_contact(const TickRecord& a, const TickRecord& b) {
    return same(a.hip, b.hip) && same(a.go, b.go) && same(a.force, b.force) &&
           same(a.normal_force, b.normal_force) && same(a.tangential_force, b.tangential_force) &&
           same(a.mu, b.mu) && same(a.u, b.u) && a.segment == b.segment && a.mode == b.mode &&
           (a.flags & engine::kSceneFlags) == (b.flags & engine::kSceneFlags);
}

/// The same ticks again in chunks of other sizes, 1 to `max` ticks each.
struct Cut {
    Cut(std::span<const TickRecord> ticks, std::size_t max, Random& random) {
        for (std::size_t first = 0; first < ticks.size();) {
            const std::size_t count = std::min(ticks.size() - first, 1 + random.index(max));
            const auto part = std::span(ticks).subspan(first, count);
            const std::uint8_t parts = data::part_command;  // after a safety chain
            bytes.push_back(data::encode_chunk(part, part.front().tick, 1'000'000, parts));
            views.push_back({.first_tick = part.front().tick,
                             .ticks = count,
                             .period_ns = 1'000'000,
                             .parts = parts,
                             .crc32 = bytes.back().crc32,
                             .derived = data::derived_hash(part)});
            first += count;
        }
        for (std::size_t i = 0; i < views.size(); ++i) {
            views[i].data = bytes[i].data;
        }
    }
    std::vector<data::EncodedChunk> bytes;
    std::vector<data::ChunkView> views;
};

}  // namespace

TEST_CASE("a replay gives the scalar tick's bits on every chunk of a recorded study") {
    data::Database database(demo_file(), data::Access::read);
    Random random(5);
    std::size_t checked = 0;
    for (std::int64_t trial = 1; trial <= 10; ++trial) {
        const Recorded recorded(database, trial);
        const std::vector<TickRecord> scalar = by_scalar_ticks(recorded);
        data::ChunkReplay replay(recorded.machine, recorded.scene.get(), recorded.chunks.views);
        std::vector<std::size_t> order(replay.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        for (std::size_t i = order.size(); i > 1; --i) {
            std::swap(order[i - 1], order[random.index(i)]);
        }
        for (const std::size_t i : order) {
            const auto again = replay.chunk(i);
            CAPTURE(trial, i);
            REQUIRE(again.as_recorded);
            const auto first = static_cast<std::size_t>(recorded.chunks.views[i].first_tick);
            for (std::size_t k = 0; k < again.ticks.size(); ++k) {
                REQUIRE(same_contact(again.ticks[k], scalar[first + k]));
            }
            checked += again.ticks.size();
        }
    }
    CHECK(checked > 40'000);
}

TEST_CASE(
    "the sizes of chunks, the order in which they are asked for and an early end change no bit") {
    data::Database database(demo_file(), data::Access::read);
    SEEDED(random, std::uint64_t{12});
    const Recorded recorded(database, 1 + random.below(10));
    const data::Ticks ticks =
        data::replay(recorded.scene.get(), recorded.machine, recorded.chunks.views).ticks;
    const Cut cut(ticks, random.coin() ? 40 : 900, random);
    data::ChunkReplay replay(recorded.machine, recorded.scene.get(), cut.views);
    const int questions = 1 + random.below(static_cast<int>(2 * cut.views.size()));
    for (int k = 0; k < questions; ++k) {  // then it ends, whatever is under way
        const auto i = random.index(cut.views.size());
        const auto again = replay.chunk(i);
        REQUIRE(again.as_recorded);
        REQUIRE(again.ticks.size() == cut.views[i].ticks);
        REQUIRE(std::memcmp(again.ticks.data(), ticks.data() + cut.views[i].first_tick,
                            again.ticks.size_bytes()) == 0);
    }
}

TEST_CASE("nothing is replayed over a damaged chunk, and what lies before it is given") {
    data::Database database(demo_file(), data::Access::read);
    SEEDED(random, std::uint64_t{6});
    const Recorded recorded(database, 2);
    const data::Ticks ticks =
        data::replay(recorded.scene.get(), recorded.machine, recorded.chunks.views).ticks;
    Cut cut(ticks, 600, random);
    const auto damaged = random.index(cut.views.size());
    cut.views[damaged].crc32 ^= 1U;
    data::ChunkReplay replay(recorded.machine, recorded.scene.get(), cut.views);
    for (std::size_t i = 0; i < cut.views.size(); ++i) {
        if (i < damaged) {
            CHECK(replay.chunk(i).as_recorded);
        } else {
            CHECK_THROWS_AS(replay.chunk(i), data::TraceError);
        }
    }
    CHECK_THROWS_AS(data::replay(recorded.scene.get(), recorded.machine, cut.views),
                    data::TraceError);
}

TEST_CASE("HIP that is not where three counts say is found, unless the device gave no place") {
    const engine::Gantry gantry(*gantry_machine().gantry);
    SEED(40U);
    Random random(seed);
    data::StoredTrace trace;
    std::int64_t wrong = 0;
    std::int64_t first = -1;
    engine::Vec3 hip = gantry.spec().home();
    for (int i = 0; i < 200; ++i) {
        engine::TickRecord tick;
        tick.tick = i;
        tick.counts = {random.below(4000) - 2000, random.below(4000) - 2000,
                       random.below(1800) - 2400};
        const bool lost = i > 0 && random.below(10) == 0;
        if (lost) {
            tick.counts = {0, 0, random.coin() ? 0 : 2400};  // 63 mm above home, beyond the end
        } else {                                             // r q from home, in steps of 100 nm
            const double way = 0.010 * 2.0 * 3.141592653589793 / 2400.0;
            const engine::Vec3 at =
                engine::Vec3(0.0, 0.0, 0.040) +
                way * engine::Vec3(tick.counts[0], tick.counts[1], tick.counts[2]);
            hip = glm::floor(at * 1e7 + 0.5) / 1e7;
        }
        engine::Vec3 written = hip;
        if (random.below(20) == 0) {
            written[random.below(3)] += 1e-6;
            first = wrong++ == 0 ? i : first;
        }
        tick.hip = written;
        trace.ticks.push_back(tick);
        hip = written;  // which a device that gives no place keeps
    }
    std::vector<data::Finding> all;
    data::Findings findings(all);
    data::check_counts(gantry, trace, findings);
    REQUIRE(all.size() == (wrong > 0 ? 1U : 0U));
    if (wrong > 0) {
        CHECK(all[0].what == "trace.hip");
        CHECK(all[0].tick == first);
        CHECK(all[0].count == wrong);
    }
}

#include "data/store/async_recorder.hpp"
#include "data/store/reader.hpp"
#include "data/store/sqlite_recorder.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/process.hpp"
#include "tests/support/studies.hpp"

using namespace palpate;
using namespace palpate::data;
using tests::TemporaryFolder;

namespace {

/// A database with an open session.
struct Rig {
    explicit Rig(const TemporaryFolder& folder)
        : database(folder.file("a.sqlite"), Access::write),
          spec(tests::session_spec(tests::small_protocol())),
          session(data::open_session(database, spec).id),
          recorder(database, spec.protocol, session) {}
    Database database;
    data::SessionSpec spec;
    std::int64_t session;
    data::SqliteRecorder recorder;
};

void append_in_bits(protocols::Recorder& recorder,
                    protocols::TrialId id,
                    std::span<const engine::TickRecord> ticks,
                    std::uint64_t seed) {
    tests::Random random(seed);
    while (!ticks.empty()) {
        const std::size_t n =
            std::min(ticks.size(), static_cast<std::size_t>(1 + random.below(400)));
        recorder.append(id, ticks.first(n));
        ticks = ticks.subspan(n);
    }
}

void check_same(std::span<const engine::TickRecord> stored,
                std::span<const engine::TickRecord> ticks) {
    REQUIRE(stored.size() == ticks.size());
    for (std::size_t i = 0; i < ticks.size(); ++i) {
        REQUIRE(tests::same_bits(stored[i], ticks[i]));
    }
}

class FullDisk : public protocols::Recorder {
public:
    protocols::TrialId begin_trial(const protocols::PlannedTrial& /*p*/) override { return 1; }
    void begin_interval(protocols::TrialId /*trial*/,
                        const protocols::Presentation& /*felt*/,
                        const protocols::SceneConstants& /*scene*/) override {}
    void append(protocols::TrialId /*t*/, std::span<const engine::TickRecord> /*ticks*/) override {
        throw data::StoreError("the disk is full");
    }
    void end_trial(protocols::TrialId /*t*/, const protocols::TrialResult& /*r*/) override {
        ++ended;
    }
    void event(const protocols::Event& /*event*/) override {}
    void finish_session() override {}
    int ended = 0;
};

}  // namespace

TEST_CASE("ticks come back to the bit, in chunks of 2048 whatever the pace", "[store][law]") {
    const auto seed = GENERATE(palpate::tests::seeds(std::uint64_t{8}));
    const bool async = GENERATE(false, true);
    CAPTURE(seed, async);
    const TemporaryFolder folder;
    Rig rig(folder);
    const auto ticks = tests::random_ticks(seed, 1 + 1433 * seed);
    protocols::TrialId id = 0;
    {
        data::AsyncRecorder thread(rig.recorder);
        protocols::Recorder& recorder =
            async ? static_cast<protocols::Recorder&>(thread) : rig.recorder;
        id = tests::begin_trial(recorder, rig.spec.protocol, rig.spec.plan.trials[0]);
        append_in_bits(recorder, id, ticks, seed);
        recorder.end_trial(id, tests::answered(0, true, static_cast<std::int64_t>(ticks.size())));
    }
    check_same(data::read_trace(rig.database, id), ticks);
    auto row = rig.database.first("SELECT count(*), (max(first_tick) % 2048) FROM trace_chunk");
    CHECK(row.integer(0) == static_cast<std::int64_t>((ticks.size() + 2047) / 2048));
    CHECK(row.integer(1) == 0);
}

TEST_CASE("after a trial the database file alone is whole", "[store][law]") {
    const TemporaryFolder folder;
    Rig rig(folder);
    const auto ticks = tests::random_ticks(1, 700);
    const auto id = tests::begin_trial(rig.recorder, rig.spec.protocol, rig.spec.plan.trials[0]);
    rig.recorder.append(id, ticks);
    rig.recorder.end_trial(id, tests::answered(0, true));
    std::filesystem::copy(folder.file("a.sqlite"), folder.file("copy.sqlite"));  // without the log
    Database copy(folder.file("copy.sqlite"), Access::write);
    check_same(data::read_trace(copy, id), ticks);
}

TEST_CASE("an analyst who reads does not stop the rig", "[store][law]") {
    const TemporaryFolder folder;
    Rig rig(folder);
    Database analyst(folder.file("a.sqlite"), Access::read);
    auto looking = analyst.prepare("SELECT * FROM plan");
    REQUIRE(looking.step());  // holds a read transaction open
    const auto ticks = tests::random_ticks(2, 1000);
    const auto id = tests::begin_trial(rig.recorder, rig.spec.protocol, rig.spec.plan.trials[0]);
    rig.recorder.append(id, ticks);
    CHECK_NOTHROW(rig.recorder.end_trial(id, tests::answered(0, true)));
    check_same(data::read_trace(rig.database, id), ticks);
}

TEST_CASE("a full disk is said, and everything acknowledged before it is there", "[store][law]") {
    const TemporaryFolder folder;
    Rig rig(folder);
    const auto first = tests::begin_trial(rig.recorder, rig.spec.protocol, rig.spec.plan.trials[0]);
    const auto ticks = tests::random_ticks(3, 512);
    rig.recorder.append(first, ticks);
    rig.recorder.end_trial(first, tests::answered(0, true));
    auto pages = rig.database.first("PRAGMA page_count");
    rig.database.execute(
        ("PRAGMA max_page_count = " + std::to_string(pages.integer(0) + 60)).c_str());
    pages.reset();
    const auto second =
        tests::begin_trial(rig.recorder, rig.spec.protocol, rig.spec.plan.trials[1]);
    std::size_t stored = 0;
    std::string said;
    try {
        for (std::size_t i = 0; i < 100; ++i) {
            rig.recorder.append(second,
                                tests::random_ticks(i, 256, static_cast<std::int64_t>(256 * i)));
            const bool saved = rig.recorder.save();
            stored += saved ? 256 : 0;
        }
    } catch (const data::StoreError& e) {
        said = e.what();
    }
    CHECK_THAT(said, Has("a.sqlite", "free some space"));
    CHECK(stored > 0);
    Database again(folder.file("a.sqlite"), Access::read);
    check_same(data::read_trace(again, first), ticks);
    CHECK(data::read_trace(again, second).size() == stored);
}

TEST_CASE(
    "a file that is moved or deleted under the rig is missed at the end of the trial, and a moved "
    "one has all",
    "[store][law]") {
    const bool moved = GENERATE(false, true);
    const TemporaryFolder folder;
    Rig rig(folder);
    const auto ticks = tests::random_ticks(3, 5000);
    const auto id = tests::begin_trial(rig.recorder, rig.spec.protocol, rig.spec.plan.trials[0]);
    rig.recorder.append(id, std::span(ticks).first(4500));
    if (moved) {
        std::filesystem::rename(folder.file("a.sqlite"), folder.file("b.sqlite"));
    } else {
        std::filesystem::remove(folder.file("a.sqlite"));
    }
    rig.recorder.append(id, std::span(ticks).subspan(4500));
    CHECK_THROWS_WITH(rig.recorder.end_trial(id, tests::answered(0, true, 5000)),
                      Has("a.sqlite: it was moved or deleted"));
    CHECK_THROWS_WITH(tests::begin_trial(rig.recorder, rig.spec.protocol, rig.spec.plan.trials[1]),
                      Has("put it back"));
    if (moved) {
        Database there(folder.file("b.sqlite"), Access::read);
        check_same(data::read_trace(there, id), ticks);
    }
}

TEST_CASE("what fails on the writing thread is heard of, and nothing is stored after it",
          "[store][law]") {
    FullDisk disk;
    data::AsyncRecorder recorder(disk);
    const auto id = recorder.begin_trial({});
    const auto ticks = tests::random_ticks(1, 10);
    recorder.append(id, ticks);
    CHECK_THROWS_WITH(recorder.end_trial(id, tests::answered(0, true)), Has("disk is full"));
    CHECK(disk.ended == 0);
}

TEST_CASE("a damaged or missing chunk is reported, never averaged", "[store][law]") {
    const TemporaryFolder folder;
    Rig rig(folder);
    const auto id = tests::begin_trial(rig.recorder, rig.spec.protocol, rig.spec.plan.trials[0]);
    rig.recorder.append(id, tests::random_ticks(1, 9000));
    rig.recorder.end_trial(id, tests::answered(0, true));
    CHECK_THROWS_WITH(data::read_trace(rig.database, 99), Has("no trial 99"));
    rig.database.execute("UPDATE trace_chunk SET crc32 = crc32 + 1 WHERE first_tick = 4096");
    CHECK_THROWS_WITH(data::read_trace(rig.database, id), Has("checksum"));
    rig.database.execute("DELETE FROM trace_chunk WHERE first_tick = 4096");
    CHECK_THROWS_WITH(data::read_trace(rig.database, id), Has("ticks 4096 to 6143 are missing"));
}

#include "data/store/async_recorder.hpp"
#include "data/store/reader.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/faulty.hpp"

using namespace palpate::data;
using namespace palpate::protocols;

namespace {

void append_in_bits(protocols::Recorder& recorder,
                    protocols::TrialId id,
                    std::span<const engine::TickRecord> ticks,
                    std::uint64_t seed) {
    Random random(seed);
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
        REQUIRE(same_bits(stored[i], ticks[i]));
    }
}

}  // namespace

TEST_CASE("ticks come back to the bit, in chunks of 2048 whatever the pace") {
    SEED(std::uint64_t{8});
    EACH(async, false, true);
    SmallSession rig;
    const auto ticks = random_ticks(seed, 1 + 1433 * seed);
    protocols::TrialId id = 0;
    {
        data::AsyncRecorder thread(rig.recorder);
        protocols::Recorder& recorder =
            async ? static_cast<protocols::Recorder&>(thread) : rig.recorder;
        id = begin_trial(recorder, rig.spec.protocol, rig.spec.plan.trials[0]);
        append_in_bits(recorder, id, ticks, seed);
        recorder.end_trial(id, answered(0, true, static_cast<std::int64_t>(ticks.size())));
    }
    check_same(data::TraceReader(rig.database).read(id), ticks);
    auto row = rig.database.first("SELECT count(*), (max(first_tick) % 2048) FROM trace_chunk");
    CHECK(row.integer(0) == static_cast<std::int64_t>((ticks.size() + 2047) / 2048));
    CHECK(row.integer(1) == 0);
}

TEST_CASE("after a trial the database file alone is whole") {
    SmallSession rig;
    const auto ticks = random_ticks(1, 700);
    const auto id = rig.record(0, answered(0, true), ticks);
    std::filesystem::copy(rig.folder.file("a.sqlite"),
                          rig.folder.file("copy.sqlite"));  // without the log
    Database copy(rig.folder.file("copy.sqlite"), Access::write);
    check_same(data::TraceReader(copy).read(id), ticks);
}

TEST_CASE("an analyst who reads does not stop the rig") {
    SmallSession rig;
    Database analyst(rig.folder.file("a.sqlite"), Access::read);
    auto looking = analyst.prepare("SELECT * FROM plan");
    REQUIRE(looking.step());  // holds a read transaction open
    const auto ticks = random_ticks(2, 1000);
    check_same(data::TraceReader(rig.database).read(rig.record(0, answered(0, true), ticks)),
               ticks);
}

TEST_CASE("a full disk is said, and everything acknowledged before it is there") {
    SmallSession rig;
    const auto ticks = random_ticks(3, 512);
    const auto first = rig.record(0, answered(0, true), ticks);
    auto pages = rig.database.first("PRAGMA page_count");
    rig.database.execute(
        ("PRAGMA max_page_count = " + std::to_string(pages.integer(0) + 60)).c_str());
    pages.reset();
    const auto second = rig.begin(1);
    std::size_t stored = 0;
    std::string said;
    try {
        for (std::size_t i = 0; i < 100; ++i) {
            rig.recorder.append(second, random_ticks(i, 256, static_cast<std::int64_t>(256 * i)));
            const bool saved = rig.recorder.save();
            stored += saved ? 256 : 0;
        }
    } catch (const data::StoreError& e) {
        said = e.what();
    }
    CHECK_THAT(said, Has("a.sqlite", "free some space"));
    CHECK(stored > 0);
    Database again(rig.folder.file("a.sqlite"), Access::read);
    check_same(data::TraceReader(again).read(first), ticks);
    CHECK(data::TraceReader(again).read(second).size() == stored);
}

TEST_CASE(
    "a file that is moved, or deleted with or without its log, under the rig is missed at the end "
    "of the trial, and what was recorded is there") {
    EACH(what, as<std::string>{}, "moved", "deleted", "log deleted");
    SmallSession rig;
    const auto ticks = random_ticks(3, 5000);
    const auto id = rig.begin(0);
    rig.recorder.append(id, std::span(ticks).first(4500));
    const bool moved = what == "moved";
    if (moved) {
        std::filesystem::rename(rig.folder.file("a.sqlite"), rig.folder.file("b.sqlite"));
    } else if (what == "deleted") {
        std::filesystem::remove(rig.folder.file("a.sqlite"));
    } else {
        std::filesystem::remove(rig.folder.file("a.sqlite-wal"));
        std::filesystem::remove(rig.folder.file("a.sqlite-shm"));
        // Another program on a log of its own: what both wrote would be neither's.
        CHECK(Process({"sqlite3", rig.folder.file("a.sqlite"), "CREATE TABLE other (x)"})
                  .wait()
                  .code == 0);
    }
    rig.recorder.append(id, std::span(ticks).subspan(4500));
    const char* said = moved             ? "a.sqlite: it was moved"
                     : what == "deleted" ? "a.sqlite: it was deleted"
                                         : "a.sqlite: it, or its log, was deleted";
    const char* remedy = moved             ? "put it back"
                       : what == "deleted" ? "is in it again"
                                           : "a.sqlite.rescued: put that in the place of";
    CHECK_THROWS_WITH(rig.recorder.end_trial(id, answered(0, true, 5000)), Has(said));
    CHECK_THROWS_WITH(rig.begin(1), Has(remedy));
    Database there(rig.folder.file(moved               ? "b.sqlite"
                                   : what == "deleted" ? "a.sqlite"
                                                       : "a.sqlite.rescued"),
                   Access::read);
    check_same(data::TraceReader(there).read(id), ticks);
    if (what == "log deleted") {
        CHECK(Process({"sqlite3", rig.folder.file("a.sqlite"),
                       "PRAGMA integrity_check; SELECT count(*) FROM other"})
                  .wait()
                  .out == "ok\n0\n");
    }
}

TEST_CASE(
    "the last ticks before a fault are there in plain SQL, also when the trace lost its chunks") {
    SEED(std::uint64_t{10});
    SmallSession session;
    Database& database = session.database;
    const auto ticks = random_ticks(seed, 1 + 11 * seed, 12345);
    TrialResult result;
    result.outcome = Outcome::faulted;
    result.summary.slewed_ticks = 3;
    result.summary.stale_ticks = 2;
    result.fault = Fault{.cause = engine::Trip::device_lost, .text = "gone", .last = ticks};
    const auto id = session.record(0, result);  // no tick came through the ring

    auto row = database.prepare("SELECT * FROM fault_tick ORDER BY tick");
    for (const engine::TickRecord& tick : ticks) {
        REQUIRE(row.step());
        CHECK(row.integer(0) == id);
        int column = 1;
        for (const data::TraceColumn& c : data::trace_columns()) {
            REQUIRE(row.name(column) == c.name);
            ++column;
        }
        REQUIRE(column == row.columns());
        const auto same = [&row](int at, double value) {
            return std::isnan(value) ? row.null(at) : row.real(at) == value;
        };
        CHECK(row.integer(1) == tick.tick);
        CHECK(row.integer(3) == tick.counts[0]);
        CHECK(row.integer(6) == tick.codes[1]);
        CHECK(same(7, double{tick.lateness_us}));
        CHECK(row.integer(8) == tick.flags);
        CHECK(row.text(9) == to_string(tick.mode));
        CHECK(row.integer(10) == tick.segment);
        CHECK(same(12, tick.hip.x));
        CHECK(same(13, tick.hip.y));
        CHECK(same(18, tick.force.x));
        CHECK(same(21, tick.command.y));
        CHECK(same(24, tick.mu));
    }
    CHECK_FALSE(row.step());
    CHECK(lines(database,
                "SELECT trial_id, plan_position, attempt, fault_cause, ticks_kept FROM fault") ==
          "1 0 1 device_lost " + std::to_string(ticks.size()) + " \n");
    CHECK(lines(database, "SELECT force_slew_ticks, stale_ticks FROM trial") == "3 2 \n");
}

TEST_CASE("a fault belongs to a faulted trial, and a refused result leaves nothing") {
    SmallSession session;
    Database& database = session.database;
    const auto id = session.begin(0);
    TrialResult result = answered(0, true);
    result.fault = Fault{.cause = engine::Trip::late, .text = {}, .last = random_ticks(1, 5)};
    CHECK_THROWS_WITH(session.recorder.end_trial(id, result), Has("with a fault"));
    CHECK(lines(database, "SELECT count(*) FROM fault_tick") == "0 \n");
    CHECK_NOTHROW(session.recorder.end_trial(id, answered(0, true)));
    CHECK(lines(database, "SELECT count(*) FROM fault") == "0 \n");
}

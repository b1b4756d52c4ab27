#include "data/trace/columns.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/faulty.hpp"

using namespace palpate::data;
using namespace palpate::protocols;

TEST_CASE(
    "the last ticks before a fault are there in plain SQL, also when the trace lost its chunks",
    "[store][fault][law]") {
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

TEST_CASE("a fault belongs to a faulted trial, and a refused result leaves nothing",
          "[store][fault]") {
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

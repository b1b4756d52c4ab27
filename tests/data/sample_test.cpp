#include "tests/support/sample_rows.hpp"
#include "tests/support/studies.hpp"

namespace {
/// A study with trials of arbitrary bits, `sizes` ticks each.
struct Wild : SmallSession {
    explicit Wild(const std::vector<std::size_t>& sizes) {
        REQUIRE(data::add_extension(database.handle()) == 0);
        for (std::size_t i = 0; i < sizes.size(); ++i) {
            record(i, answered(0, true, static_cast<std::int64_t>(sizes[i])),
                   random_ticks(11 + i, sizes[i]));
        }
    }
};

}  // namespace

TEST_CASE("every value of sample is the reader's tick to the bit, arbitrary bits too") {
    Wild wild({1, 255, 256, 257, 5000});
    Opened demo(demo_file());
    std::size_t checked = 0;
    for (data::Database* database :
         {static_cast<data::Database*>(&wild.database), static_cast<data::Database*>(&demo)}) {
        for (const std::int64_t trial : {1, 2, 3, 4, 5}) {
            CAPTURE(trial);
            const auto rows =
                sql_rows(*database, fmt::format("SELECT * FROM sample WHERE trial_id = {}", trial));
            require_same(rows, expected_rows(*database, trial));
            checked += rows.size();
        }
    }
    CHECK(checked > 30000);
}

TEST_CASE("a column says the same whichever others are asked for with it") {
    const bool is_wild = GENERATE(false, true);
    static Wild wild({700, 5000});
    Opened demo(demo_file());
    data::Database& database = is_wild ? wild.database : demo;
    const auto all = sql_rows(database, "SELECT * FROM sample WHERE trial_id = 2");
    for (std::size_t c = 0; c < sample_columns().size(); ++c) {
        CAPTURE(sample_columns()[c]);
        const auto alone = sql_rows(
            database, fmt::format("SELECT {} FROM sample WHERE trial_id = 2", sample_columns()[c]));
        REQUIRE(alone.size() == all.size());
        bool same = true;
        for (std::size_t i = 0; i < all.size(); ++i) {
            same = same && alone[i][0] == all[i][c];
        }
        CHECK(same);
    }
    const auto first = [](const auto& row) {
        return row.front();
    };
    const auto numbered = sql_rows(database, "SELECT rowid, tick FROM sample WHERE trial_id = 2");
    const auto alone = sql_rows(database, "SELECT rowid FROM sample WHERE trial_id = 2");
    CHECK(std::ranges::equal(alone, numbered, {}, first, first));
}

TEST_CASE("no row is lost where a range begins or ends beside a chunk's border") {
    Opened database(demo_file());
    const auto all = sql_rows(
        database,
        "SELECT tick, hip_vx_m_per_s, commanded_x_n, time_s FROM sample WHERE trial_id = 1");
    const auto count = static_cast<std::int64_t>(all.size());
    for (const std::int64_t border :
         {0, 256, 1900, 2046, 2047, 2048, 2049, 2050, 4095, 4096, 4097, 8193}) {
        CAPTURE(border);
        const auto from = sql_rows(
            database, fmt::format("SELECT tick, hip_vx_m_per_s, commanded_x_n, time_s FROM "
                                  "sample WHERE trial_id = 1 AND tick >= {}",
                                  border));
        REQUIRE(static_cast<std::int64_t>(from.size()) ==
                std::max<std::int64_t>(0, count - border));
        CHECK((from.empty() || from[0] == all[static_cast<std::size_t>(border)]));
        const auto by_time = sql_rows(
            database, fmt::format("SELECT tick, hip_vx_m_per_s, commanded_x_n, time_s FROM sample "
                                  "WHERE trial_id = 1 AND time_s >= {} * 1e-3 - 1e-6",
                                  border));
        CHECK((by_time == from));
        CHECK(static_cast<std::int64_t>(
                  sql_rows(database,
                           fmt::format(
                               "SELECT commanded_x_n FROM sample WHERE trial_id = 1 AND tick < {}",
                               border))
                      .size()) == std::min(count, border));
    }
}

TEST_CASE("a damaged chunk is an error of SQL with a sentence, never a number") {
    DemoCopy database;
    const auto seed = GENERATE(seeds(12U));
    Random random(seed);
    const auto chunk =
        sql_rows(database, "SELECT rowid, length(data) FROM trace_chunk WHERE trial_id = 4");
    const auto& one = chunk[random.index(chunk.size())];
    data::Statement read = database.first("SELECT data FROM trace_chunk WHERE rowid = " + one[0]);
    std::vector<std::byte> bytes(read.blob(0).begin(), read.blob(0).end());
    read.reset();
    bytes[random.index(bytes.size())] ^= std::byte(1U << static_cast<unsigned>(random.below(8)));
    database.run("UPDATE trace_chunk SET data = ?1 WHERE rowid = " + one[0],
                 std::span<const std::byte>(bytes));
    const std::string what = GENERATE("rendered_normal_n", "hip_x_m", "count_1");
    CAPTURE(seed, what);
    CHECK_THAT(
        error_of(database, fmt::format("SELECT sum({}) FROM sample WHERE trial_id = 4", what)),
        Has("trial 4", "damaged", "palpate verify"));
    CHECK_FALSE(error_of(database, fmt::format("SELECT sum({}) FROM sample", what)).empty());
    CHECK(error_of(database, fmt::format("SELECT sum({}) FROM sample WHERE trial_id = 5", what))
              .empty());
}

TEST_CASE(
    "what a replay does not give as it was recorded is refused, and what is stored stays "
    "readable") {
    DemoCopy database;
    const auto before = sql_rows(
        database,
        "SELECT sum(count_1), sum(commanded_x_n), sum(hip_x_m) FROM sample WHERE trial_id = 6");
    const std::string edit = GENERATE(
        "UPDATE trace_chunk SET derived = derived + 1 WHERE trial_id = 6 AND first_tick > 0",
        "UPDATE presentation SET slip_decay = 0.5, heal_decay = 0.5",
        "UPDATE presentation SET curvature_per_m = curvature_per_m + 1");
    database.execute("PRAGMA foreign_keys = OFF");
    database.execute(edit.c_str());
    CAPTURE(edit);
    const auto friction = sql_rows(database,
                                   "SELECT friction FROM plan JOIN trial USING (session_id, "
                                   "plan_position) WHERE trial.trial_id = 6");
    if (edit.find("decay") == std::string::npos || friction[0][0] != "off") {
        CHECK_THAT(
            error_of(database, "SELECT sum(rendered_normal_n) FROM sample WHERE trial_id = 6"),
            Has("trial 6", "replay", "the palpate that recorded it"));
    }
    CHECK((sql_rows(database,
                    "SELECT sum(count_1), sum(commanded_x_n), sum(hip_x_m) FROM sample WHERE "
                    "trial_id = 6") == before));
}

TEST_CASE("a calibration that is not the recorded one is noticed in HIP alone") {
    DemoCopy database;
    database.execute("DELETE FROM session_provenance WHERE key = 'calibration'");
    CHECK_THAT(error_of(database, "SELECT sum(hip_x_m) FROM sample WHERE trial_id = 6"),
               Has("calibration"));
}

TEST_CASE("two intervals of a trial come one after the other, or merged by time") {
    DemoCopy database;
    const std::string what = GENERATE("trial_id, interval, tick, hip_vx_m_per_s, rendered_normal_n",
                                      "trial_id, interval, time_s, hip_vy_m_per_s, commanded_x_n");
    const auto once =
        sql_rows(database, fmt::format("SELECT {} FROM sample WHERE trial_id = 3", what));
    add_interval(database);
    const auto both =
        sql_rows(database, fmt::format("SELECT {} FROM sample WHERE trial_id = 3", what));
    REQUIRE(both.size() == 2 * once.size());
    for (std::size_t i = 0; i < once.size(); ++i) {
        REQUIRE((both[i] == once[i]));
        SampleRow second = once[i];
        second[1] = "2";
        REQUIRE((both[once.size() + i] == second));
    }
    const auto ordered = [&](const std::string& source, const std::string& by) {
        return sql_rows(database, fmt::format("SELECT {} FROM {} ORDER BY {}", what, source, by));
    };
    for (const std::string by :
         {"trial_id, time_s", "trial_id, tick", "trial_id, interval, time_s"}) {
        CAPTURE(by, plan_of(database, "SELECT * FROM sample ORDER BY " + by));
        CHECK_THAT(plan_of(database, "SELECT * FROM sample ORDER BY " + by), !Has("TEMP B-TREE"));
        // SQLite's own sort keeps equal rows in the order they come in.
        const bool same =
            ordered("sample WHERE trial_id = 3", by) ==
            ordered("(SELECT * FROM sample WHERE trial_id = 3 LIMIT -1)", "+" + by + ", +interval");
        CHECK(same);
    }
    CHECK(sql_rows(database, "SELECT * FROM sample WHERE trial_id = 3 AND interval = 2").size() ==
          once.size());
}

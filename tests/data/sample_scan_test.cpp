#include "tests/support/sample_rows.hpp"
#include "tests/support/short_text.hpp"
#include "tests/support/studies.hpp"

namespace {

std::string random_condition(Random& random, const std::string& trial) {
    const auto number = [&](double scale) {
        return fmt::format("{}", random.in(-0.1, 1.2) * scale);
    };
    const char* const compare[] = {"<", "<=", ">", ">=", "="};
    const auto op = [&] {
        return std::string(compare[random.below(5)]);
    };
    std::string where("1");
    switch (random.below(6)) {
        case 0:
            where += fmt::format(" AND {} IN (1, 3, {})", trial, random.below(12));
            break;
        case 1:
            where +=
                fmt::format(" AND {} BETWEEN {} AND {}", trial, random.below(12), number(10.0));
            break;
        case 2:
            where += fmt::format(" AND {} {} {}", trial, op(), number(10.0));
            break;
        case 3:
            where += fmt::format(" AND {} = {}", trial,
                                 random.below(8) == 0 ? "2.5" : std::to_string(random.below(12)));
            break;
        default:
            break;
    }
    for (int i = random.below(3); i > 0; --i) {
        switch (random.below(4)) {
            case 0:
                where += fmt::format(" AND tick {} {}", op(), random.below(10000));
                break;
            case 1:
                where +=
                    fmt::format(" AND time_s {} {}", op(), random.coin() ? number(10.0) : "2.048");
                break;
            case 2:
                where += fmt::format(" AND tick {} {}", op(), number(9000.0));
                break;
            default:
                where += fmt::format(" AND interval {} {}", op(), random.below(3));
        }
    }
    return where;
}

/// With every interval short, too.
std::string brief_text(std::string_view name,
                       std::vector<std::pair<std::string, std::string>> edits) {
    edits.emplace_back("[timing]\nexplore_min_s = 2\n",
                       "[invalid]\ncontact_min_s = 0\npath_min_mm = 0\n\n"
                       "[timing]\nexplore_min_s = 0.5\n");
    edits.emplace_back("explore_prompt_s = 10", "explore_prompt_s = 0.8");
    edits.emplace_back("explore_timeout_s = 15", "explore_timeout_s = 1");
    return short_text(name, edits);
}

}  // namespace

TEST_CASE("a query gives the same rows with and without the index") {
    Opened database(demo_file());
    const auto seed = GENERATE(seeds(24U));
    Random with(seed);
    Random without(seed);
    const std::string columns[] = {
        "tick, time_s, hip_x_m", "time_s, hip_vx_m_per_s, hip_vy_m_per_s",
        "commanded_x_n, flags",  "tick, rendered_normal_n, mode, hip_vx_m_per_s",
        "count_1, lateness_us",  "trial_id, interval"};
    const std::string indexed = random_condition(with, "trial_id");
    // A + keeps SQLite from giving a condition to the table.
    std::string plain = random_condition(without, "+trial_id");
    for (const std::string name : {" tick ", " time_s ", " interval "}) {
        for (std::size_t at = plain.find(name); at != std::string::npos;
             at = plain.find(name, at + 2)) {
            plain.insert(at + 1, 1, '+');
        }
    }
    CAPTURE(seed, indexed, plain);
    const auto sql = [&](const std::string& where) {
        return fmt::format("SELECT {} FROM sample WHERE {} ORDER BY trial_id, time_s",
                           columns[seed % 6], where);
    };
    const auto a = sql_rows(database, sql(indexed));
    const auto b = sql_rows(database, sql(plain));
    REQUIRE(a.size() == b.size());
    CHECK((a == b));
}

TEST_CASE("trial_id is an index, and the rows come in order without a sort") {
    Opened database(demo_file());
    for (const char* sql :
         {"SELECT * FROM sample ORDER BY trial_id, time_s",
          "SELECT time_s FROM sample WHERE trial_id = 3 ORDER BY time_s",
          "SELECT time_s FROM sample WHERE trial_id = 3 ORDER BY trial_id, time_s",
          "SELECT * FROM sample ORDER BY trial_id, interval, tick",
          "SELECT trial_id, avg(commanded_x_n) FROM sample GROUP BY trial_id",
          "SELECT trial.trial_id, avg(rendered_normal_n) FROM trial JOIN sample USING (trial_id) "
          "GROUP BY trial.trial_id"}) {
        CAPTURE(sql, plan_of(database, sql));
        CHECK_THAT(plan_of(database, sql), !Has("TEMP B-TREE"));
    }
    for (const char* sql :
         {"SELECT * FROM sample ORDER BY trial_id DESC", "SELECT * FROM sample ORDER BY time_s",
          "SELECT * FROM sample ORDER BY trial_id, hip_x_m"}) {
        CAPTURE(sql);
        CHECK_THAT(plan_of(database, sql), Has("TEMP B-TREE"));
    }
    // A join asks for one trial after the other, whichever is named first.
    for (const char* sql :
         {"SELECT count(*) FROM sample JOIN trial USING (trial_id) WHERE outcome = "
          "'complete'",
          "SELECT count(*) FROM trial JOIN sample USING (trial_id) WHERE ticks > 8000",
          "SELECT count(*) FROM analysis_trial JOIN sample USING (trial_id) WHERE counts AND "
          "friction = 'on'",
          "SELECT planned_object, avg(rendered_normal_n) FROM analysis_trial JOIN sample USING "
          "(trial_id) WHERE counts AND mode <> 'free' GROUP BY 1",
          "SELECT planned_object, avg(rendered_normal_n) FROM analysis_trial, sample WHERE "
          "sample.trial_id = analysis_trial.trial_id GROUP BY 1",
          "SELECT count(*) FROM sample JOIN event ON event.trial_id = sample.trial_id WHERE time_s "
          "> 1"}) {
        CAPTURE(sql, plan_of(database, sql));
        const std::string plan = plan_of(database, sql);
        CHECK(plan.find("sample VIRTUAL TABLE") > plan.find('\n'));
        CHECK_THAT(plan, Has("sample VIRTUAL TABLE"));
    }
    CHECK(sql_rows(database, "SELECT DISTINCT trial_id FROM sample ORDER BY 1").size() == 10);
}

TEST_CASE("a range of trials reads these alone, whatever the bounds are") {
    Opened database(demo_file());
    // The damaged trial is an error as soon as it is read.
    DemoCopy damaged;
    damaged.execute("UPDATE trace_chunk SET data = zeroblob(9) WHERE trial_id = 6");
    const auto says = [](data::Database& of, const std::string& where) {
        return sql_rows(
            of, "SELECT count(*), sum(rendered_normal_n), sum(hip_x_m) FROM sample WHERE " + where);
    };
    for (const std::string where :
         {"trial_id < 6", "trial_id <= 5", "trial_id < 5.5", "trial_id BETWEEN 2 AND 5.999",
          "trial_id > 6", "trial_id >= 6.001", "trial_id >= 7 AND trial_id < 1e300",
          "trial_id > 6 AND trial_id <= 9223372036854775807", "trial_id < 3 AND trial_id > -1e300",
          "trial_id > NULL", "trial_id IS 4", "+trial_id IS 4 AND trial_id < 6",
          "trial_id < 6 AND trial_id = 4", "trial_id < 'a' AND trial_id > 6",
          "trial_id > 3 AND trial_id < 3"}) {
        CAPTURE(where);
        CHECK((says(damaged, where) == says(database, where)));
    }
    for (const std::string where : {"trial_id < 6.5", "trial_id <= 6", "trial_id > 5",
                                    "trial_id BETWEEN 6 AND 6", "trial_id < 'a'"}) {
        CAPTURE(where);
        CHECK_THAT(error_of(damaged, "SELECT sum(rendered_normal_n) FROM sample WHERE " + where),
                   Has("trial 6"));
    }
}

TEST_CASE("a tick joined with the tick before gives what lag() gives, also of two intervals") {
    DemoCopy database;
    add_interval(database);
    const std::string what = GENERATE("hip_x_m", "rendered_normal_n", "count_1");
    const std::string range = "BETWEEN 4000 AND 4200";  // across the border of two chunks
    const auto joined = sql_rows(
        database,
        fmt::format("SELECT a.interval, a.tick, a.{0}, b.{0} FROM sample AS a JOIN sample "
                    "AS b ON b.trial_id = a.trial_id AND b.interval = a.interval AND "
                    "b.tick = a.tick - 1 WHERE a.trial_id = 3 AND a.tick {1} ORDER BY 1, 2",
                    what, range));
    const auto lagged = sql_rows(
        database,
        fmt::format(
            "SELECT * FROM (SELECT interval, tick, {0}, lag({0}) OVER (PARTITION BY interval "
            "ORDER BY tick) FROM sample WHERE trial_id = 3) WHERE tick {1} ORDER BY 1, 2",
            what, range));
    REQUIRE(joined.size() == 2 * 201);
    CHECK((joined == lagged));
}

TEST_CASE(
    "a chunk that is gone, or stands in another place, trial, interval or period, is an error") {
    DemoCopy database;
    database.execute("PRAGMA foreign_keys = OFF");
    const std::string what = GENERATE("count_1", "hip_x_m", "time_s", "rendered_normal_n");
    const std::string query = "SELECT sum(" + what + ") FROM sample WHERE trial_id ";
    for (const std::string edit :
         {"DELETE FROM trace_chunk WHERE trial_id = 4 AND first_tick = 0",
          "DELETE FROM trace_chunk WHERE trial_id = 4 AND first_tick = 4096",
          "DELETE FROM trace_chunk WHERE trial_id = 4",
          "UPDATE trace_chunk SET first_tick = 4097 WHERE trial_id = 4 AND first_tick = 4096",
          "UPDATE trace_chunk SET first_tick = first_tick + 1 WHERE trial_id = 4",
          "UPDATE trace_chunk SET trial_id = 44 WHERE trial_id = 4",
          "UPDATE trace_chunk SET interval = 2 WHERE trial_id = 4",
          "UPDATE trace_chunk SET period_ns = period_ns + 1 WHERE trial_id = 4",
          "DELETE FROM trial WHERE trial_id = 4", "DELETE FROM presentation WHERE trial_id = 4"}) {
        CAPTURE(what, edit);
        database.execute("BEGIN");
        database.execute(edit.c_str());
        CHECK_THAT(error_of(database, query + "< 6"), Has("trial 4, interval 1: "));
        CHECK(error_of(database, query + "<> 4 AND trial_id IN (1, 5)").empty());
        database.execute("ROLLBACK");
    }
    // Where the session says that ticks were lost, what is left can be had.
    database.execute(
        "DELETE FROM trace_chunk WHERE trial_id = 4 AND first_tick = 4096;INSERT INTO event "
        "(session_id, event_kind, text, at_utc, trials_begun, count) VALUES (1, 'ticks lost', "
        "'4096', '', 4, 4096)");
    CHECK(error_of(database, "SELECT sum(count_1) FROM sample WHERE trial_id = 4").empty());
}

TEST_CASE("sample is never of another database than the one that was named") {
    const TemporaryFolder folder;
    const std::string other = copied(demo_file(), folder.file("other.sqlite"));
    Opened database(copied(demo_file(), folder.file("d.sqlite")), data::Access::write);
    const auto count = [&] {
        return error_of(database, "SELECT count(*) FROM sample WHERE trial_id = 1");
    };
    database.execute("ATTACH ':memory:' AS mine; CREATE TABLE mine.means (x)");
    CHECK(count().empty());
    database.execute(("ATTACH '" + other + "' AS b").c_str());
    CHECK_THAT(count(), Has("DETACH b"));
    CHECK_THAT(error_of(database, "SELECT count(*) FROM b.sample"), Has("DETACH b"));
    database.execute("DETACH b");
    CHECK(count().empty());
    database.execute(("ATTACH '" + other + "' AS \"b\"\"c\"").c_str());
    CHECK_THAT(count(), Has("DETACH b\"c"));
}

TEST_CASE("in a study of two intervals every value of both is the reader's tick to the bit") {
    const std::string study = GENERATE("curvature_2afc", "friction_threshold", "softness_2afc");
    std::vector<std::pair<std::string, std::string>> edits{
        {"practice_trials = 4", "practice_trials = 1"}};
    if (study == "friction_threshold") {
        edits.insert(edits.end(), 2, {"trials = 40", "trials = 4"});
    } else {
        edits.emplace_back("trials = 60", study == "softness_2afc" ? "trials = 8" : "trials = 4");
    }
    const std::string text = brief_text(study, edits);
    const TemporaryFolder folder;
    std::ofstream(folder.file("p.toml")) << text;
    const std::string file = folder.file("a.sqlite");
    ran(run_words(folder.file("p.toml"), "P1", file, {"--headless"}));
    data::Database database(file, data::Access::read);
    REQUIRE(data::add_extension(database.handle()) == 0);
    // What the rule chose is what the intervals differ by, and nothing that the protocol has.
    CHECK(sql_rows(database,
                   study == "curvature_2afc"  ? "SELECT DISTINCT curvature_per_m FROM presentation"
                   : study == "softness_2afc" ? "SELECT DISTINCT stimulus FROM presentation"
                                              : "SELECT DISTINCT mu_s FROM presentation")
              .size() > 3);
    std::size_t ticks = 0;
    const auto trials = sql_rows(database, "SELECT trial_id FROM trial ORDER BY trial_id");
    REQUIRE(trials.size() == 9);
    for (const SampleRow& one : trials) {
        const std::int64_t trial = std::stoll(one[0]);
        std::vector<SampleRow> both;
        for (const std::int64_t interval : {1, 2}) {
            CAPTURE(trial, interval);
            const auto expected = expected_rows(database, trial, interval);
            REQUIRE(expected.size() > 100);
            require_same(
                sql_rows(database,
                         fmt::format("SELECT * FROM sample WHERE trial_id = {} AND interval = {}",
                                     trial, interval)),
                expected);
            both.insert(both.end(), expected.begin(), expected.end());
        }
        CAPTURE(trial);
        require_same(
            sql_rows(database, fmt::format("SELECT * FROM sample WHERE trial_id = {}", trial)),
            both);
        ticks += both.size();
    }
    CHECK(sql_rows(database, "SELECT count(*) FROM sample")[0][0] == std::to_string(ticks));
}

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "data/extension/sample_module.hpp"
#include "data/store/sqlite_recorder.hpp"
#include "data/trace/codec.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/process.hpp"
#include "tests/support/sample_rows.hpp"
#include "tests/support/studies.hpp"

using namespace palpate;
using Catch::Matchers::ContainsSubstring;
using tests::rows_of;
using tests::SampleRow;
using tests::TemporaryFolder;

namespace {
/// Ten trials of the demo, recorded by the program.
const std::string& demo_file() {
    static const TemporaryFolder folder;
    static const std::string file = [] {
        REQUIRE(
            tests::palpate_command({"demo", "--headless", "--db", folder.file("a.sqlite")}).code ==
            0);
        return folder.file("a.sqlite");
    }();
    return file;
}

struct Opened : data::Database {
    explicit Opened(const std::string& file, data::Access access = data::Access::read)
        : data::Database(file, access) {
        REQUIRE(data::add_extension(handle()) == 0);
    }
};

/// A study with trials of arbitrary bits, `sizes` ticks each.
struct Wild {
    explicit Wild(const std::vector<std::size_t>& sizes)
        : database(folder.file("w.sqlite"), data::Access::write) {
        const auto spec = tests::session_spec(tests::small_protocol());
        const auto opened = data::open_session(database, spec);
        data::SqliteRecorder recorder(database, spec.protocol, opened.id);
        for (std::size_t i = 0; i < sizes.size(); ++i) {
            const auto id =
                recorder.begin_trial(spec.plan.trials[i], {.slip_decay = 0.9, .heal_decay = 0.9});
            recorder.append(id, tests::random_ticks(11 + i, sizes[i]));
            recorder.end_trial(id, tests::answered(0, true, static_cast<std::int64_t>(sizes[i])));
            ids.push_back(id);
        }
    }
    TemporaryFolder folder;
    Opened database;
    std::vector<std::int64_t> ids;
};

std::string plan_of(data::Database& database, const std::string& sql) {
    std::string text;
    for (const SampleRow& row : rows_of(database, "EXPLAIN QUERY PLAN " + sql)) {
        text += row.back() + '\n';
    }
    return text;
}

std::string error_of(data::Database& database, const std::string& sql) {
    try {
        rows_of(database, sql);
    } catch (const data::StoreError& e) {
        return e.what();
    }
    return {};
}

std::string random_condition(tests::Random& random, const std::string& trial) {
    const auto number = [&](double scale) {
        return fmt::format("{}", random.in(-0.1, 1.2) * scale);
    };
    const char* const compare[] = {"<", "<=", ">", ">=", "="};
    const auto op = [&] {
        return std::string(compare[random.below(5)]);
    };
    std::string where("1");
    if (random.coin()) {
        where += random.below(4) == 0
                   ? fmt::format(" AND {} IN (1, 3, {})", trial, random.below(12))
                   : fmt::format(" AND {} = {}", trial,
                                 random.below(8) == 0 ? "2.5" : std::to_string(random.below(12)));
    }
    for (int i = random.below(3); i > 0; --i) {
        switch (random.below(4)) {
            case 0:
                where += fmt::format(" AND tick {} {}", op(), random.below(10000));
                break;
            case 1:
                where +=
                    fmt::format(" AND t_s {} {}", op(), random.coin() ? number(10.0) : "2.048");
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

}  // namespace

TEST_CASE("every value of sample is the reader's tick to the bit", "[sample][law]") {
    Opened database(demo_file());
    std::size_t checked = 0;
    for (std::int64_t trial = 1; trial <= 10; ++trial) {
        const auto expected = tests::expected_rows(database, trial);
        const auto rows =
            rows_of(database, fmt::format("SELECT * FROM sample WHERE trial_id = {}", trial));
        REQUIRE(rows.size() == expected.size());
        for (std::size_t i = 0; i < rows.size(); ++i) {
            if (rows[i] != expected[i]) {
                CAPTURE(trial, i);
                REQUIRE(rows[i] == expected[i]);
            }
        }
        checked += rows.size();
    }
    CHECK(checked > 50000);
}

TEST_CASE("so it is where every bit was arbitrary", "[sample][law]") {
    Wild wild({1, 255, 256, 257, 5000});
    for (const std::int64_t id : wild.ids) {
        const auto expected = tests::expected_rows(wild.database, id);
        const auto rows =
            rows_of(wild.database, fmt::format("SELECT * FROM sample WHERE trial_id = {}", id));
        REQUIRE(rows.size() == expected.size());
        for (std::size_t i = 0; i < rows.size(); ++i) {
            if (rows[i] != expected[i]) {
                CAPTURE(id, i);
                REQUIRE(rows[i] == expected[i]);
            }
        }
    }
}

TEST_CASE("a column says the same whichever others are asked for with it", "[sample][law]") {
    const bool is_wild = GENERATE(false, true);
    static Wild wild({700, 5000});
    Opened demo(demo_file());
    data::Database& database = is_wild ? static_cast<data::Database&>(wild.database) : demo;
    const auto all = rows_of(database, "SELECT * FROM sample WHERE trial_id = 2");
    for (std::size_t c = 0; c < tests::sample_columns().size(); ++c) {
        CAPTURE(tests::sample_columns()[c]);
        const auto alone = rows_of(database, fmt::format("SELECT {} FROM sample WHERE trial_id = 2",
                                                         tests::sample_columns()[c]));
        REQUIRE(alone.size() == all.size());
        bool same = true;
        for (std::size_t i = 0; i < all.size(); ++i) {
            same = same && alone[i][0] == all[i][c];
        }
        CHECK(same);
    }
}

TEST_CASE("a query gives the same rows with and without the index", "[sample][law]") {
    Opened database(demo_file());
    const auto seed = GENERATE(range(0U, 60U));
    tests::Random with(seed);
    tests::Random without(seed);
    const std::string columns[] = {"tick, t_s, x_m",       "t_s, vx_m_per_s, vy_m_per_s",
                                   "fx_n, flags",          "tick, fn_n, mode, vx_m_per_s",
                                   "count_1, lateness_us", "trial_id, interval"};
    const std::string indexed = random_condition(with, "trial_id");
    // A + keeps SQLite from giving a condition to the table.
    std::string plain = random_condition(without, "+trial_id");
    for (const std::string name : {" tick ", " t_s ", " interval "}) {
        for (std::size_t at = plain.find(name); at != std::string::npos;
             at = plain.find(name, at + 2)) {
            plain.insert(at + 1, 1, '+');
        }
    }
    CAPTURE(seed, indexed, plain);
    const auto sql = [&](const std::string& where) {
        return fmt::format("SELECT {} FROM sample WHERE {} ORDER BY trial_id, t_s",
                           columns[seed % 6], where);
    };
    const auto a = rows_of(database, sql(indexed));
    const auto b = rows_of(database, sql(plain));
    REQUIRE(a.size() == b.size());
    CHECK((a == b));
}

TEST_CASE("no row is lost where a range begins or ends beside a chunk's border", "[sample][law]") {
    Opened database(demo_file());
    const auto all =
        rows_of(database, "SELECT tick, vx_m_per_s, fx_n, t_s FROM sample WHERE trial_id = 1");
    const auto count = static_cast<std::int64_t>(all.size());
    for (const std::int64_t border :
         {0, 256, 3800, 4094, 4095, 4096, 4097, 4098, 8190, 8192, 8193}) {
        CAPTURE(border);
        const auto from =
            rows_of(database,
                    fmt::format("SELECT tick, vx_m_per_s, fx_n, t_s FROM sample WHERE trial_id = 1"
                                " AND tick >= {}",
                                border));
        REQUIRE(static_cast<std::int64_t>(from.size()) ==
                std::max<std::int64_t>(0, count - border));
        CHECK((from.empty() || from[0] == all[static_cast<std::size_t>(border)]));
        const auto by_time =
            rows_of(database,
                    fmt::format("SELECT tick, vx_m_per_s, fx_n, t_s FROM sample WHERE trial_id = 1"
                                " AND t_s >= {} * 1e-3 - 1e-6",
                                border));
        CHECK((by_time == from));
        CHECK(static_cast<std::int64_t>(
                  rows_of(database,
                          fmt::format("SELECT fx_n FROM sample WHERE trial_id = 1 AND tick < {}",
                                      border))
                      .size()) == std::min(count, border));
    }
}

TEST_CASE("trial_id is an index, and the rows come in order without a sort", "[sample]") {
    Opened database(demo_file());
    for (const char* sql : {"SELECT * FROM sample ORDER BY trial_id, t_s",
                            "SELECT t_s FROM sample WHERE trial_id = 3 ORDER BY t_s",
                            "SELECT t_s FROM sample WHERE trial_id = 3 ORDER BY trial_id, t_s",
                            "SELECT * FROM sample ORDER BY trial_id, interval, tick",
                            "SELECT trial_id, avg(fx_n) FROM sample GROUP BY trial_id",
                            "SELECT trial.id, avg(fn_n) FROM trial JOIN sample ON trial_id = "
                            "trial.id GROUP BY trial.id"}) {
        CAPTURE(sql, plan_of(database, sql));
        CHECK_THAT(plan_of(database, sql), !ContainsSubstring("TEMP B-TREE"));
    }
    for (const char* sql :
         {"SELECT * FROM sample ORDER BY trial_id DESC", "SELECT * FROM sample ORDER BY t_s",
          "SELECT * FROM sample ORDER BY trial_id, x_m"}) {
        CAPTURE(sql);
        CHECK_THAT(plan_of(database, sql), ContainsSubstring("TEMP B-TREE"));
    }
    // A join asks for one trial after the other, whichever is named first.
    for (const char* sql :
         {"SELECT count(*) FROM sample JOIN trial ON trial_id = trial.id WHERE outcome = "
          "'complete'",
          "SELECT count(*) FROM trial JOIN sample ON trial_id = trial.id WHERE ticks > 8000",
          "SELECT count(*) FROM trial_result JOIN sample ON trial_id = trial WHERE friction = "
          "'on'"}) {
        CAPTURE(sql, plan_of(database, sql));
        const std::string plan = plan_of(database, sql);
        CHECK(plan.find("trial") < plan.find("sample VIRTUAL TABLE"));
    }
    CHECK(rows_of(database, "SELECT DISTINCT trial_id FROM sample ORDER BY 1").size() == 10);
}

TEST_CASE("a damaged chunk is an error of SQL with a sentence, never a number", "[sample][law]") {
    const TemporaryFolder folder;
    const std::string file = folder.file("d.sqlite");
    std::filesystem::copy_file(demo_file(), file);
    Opened database(file, data::Access::write);
    const auto seed = GENERATE(range(0U, 40U));
    tests::Random random(seed);
    const auto chunk =
        rows_of(database, "SELECT rowid, length(data) FROM trace_chunk WHERE trial = 4");
    const auto& one = chunk[static_cast<std::size_t>(random.below(static_cast<int>(chunk.size())))];
    data::Statement read = database.prepare("SELECT data FROM trace_chunk WHERE rowid = " + one[0]);
    REQUIRE(read.step());
    std::vector<std::byte> bytes(read.blob(0).begin(), read.blob(0).end());
    read.reset();
    bytes[static_cast<std::size_t>(random.below(static_cast<int>(bytes.size())))] ^=
        std::byte(1U << static_cast<unsigned>(random.below(8)));
    database.prepare("UPDATE trace_chunk SET data = ?1 WHERE rowid = " + one[0])
        .bind(1, std::span<const std::byte>(bytes))
        .run();
    const std::string what = GENERATE("fn_n", "x_m", "count_1");
    CAPTURE(seed, what);
    CHECK_THAT(
        error_of(database, fmt::format("SELECT sum({}) FROM sample WHERE trial_id = 4", what)),
        ContainsSubstring("trial 4") && ContainsSubstring("damaged") &&
            ContainsSubstring("palpate verify"));
    CHECK_FALSE(error_of(database, fmt::format("SELECT sum({}) FROM sample", what)).empty());
    CHECK(error_of(database, fmt::format("SELECT sum({}) FROM sample WHERE trial_id = 5", what))
              .empty());
}

TEST_CASE(
    "what a replay does not give as it was recorded is refused, and what is stored stays readable",
    "[sample][law]") {
    const TemporaryFolder folder;
    const std::string file = folder.file("d.sqlite");
    std::filesystem::copy_file(demo_file(), file);
    Opened database(file, data::Access::write);
    const auto before = rows_of(
        database, "SELECT sum(count_1), sum(fx_n), sum(x_m) FROM sample WHERE trial_id = 6");
    const std::string edit =
        GENERATE("UPDATE trace_chunk SET derived = derived + 1 WHERE trial = 6 AND first_tick > 0",
                 "UPDATE presentation SET slip_decay = 0.5, heal_decay = 0.5",
                 "UPDATE presentation SET curvature_per_m = curvature_per_m + 1");
    database.execute("PRAGMA foreign_keys = OFF");
    database.execute(edit.c_str());
    CAPTURE(edit);
    const auto friction = rows_of(
        database,
        "SELECT friction FROM plan JOIN trial USING (session, position) WHERE trial.id = 6");
    if (edit.find("decay") == std::string::npos || friction[0][0] != "off") {
        CHECK_THAT(error_of(database, "SELECT sum(fn_n) FROM sample WHERE trial_id = 6"),
                   ContainsSubstring("trial 6") && ContainsSubstring("replay") &&
                       ContainsSubstring("the palpate that recorded it"));
    }
    CHECK((rows_of(database,
                   "SELECT sum(count_1), sum(fx_n), sum(x_m) FROM sample WHERE trial_id = 6") ==
           before));
}

TEST_CASE("a calibration that is not the recorded one is noticed in HIP alone", "[sample][law]") {
    const TemporaryFolder folder;
    const std::string file = folder.file("d.sqlite");
    std::filesystem::copy_file(demo_file(), file);
    Opened database(file, data::Access::write);
    database.execute("DELETE FROM session_provenance WHERE key = 'calibration'");
    CHECK_THAT(error_of(database, "SELECT sum(x_m) FROM sample WHERE trial_id = 6"),
               ContainsSubstring("calibration"));
}

TEST_CASE("two intervals of a trial come one after the other, or merged by time", "[sample][law]") {
    const TemporaryFolder folder;
    const std::string file = folder.file("d.sqlite");
    std::filesystem::copy_file(demo_file(), file);
    Opened database(file, data::Access::write);
    const std::string what = GENERATE("trial_id, interval, tick, vx_m_per_s, fn_n",
                                      "trial_id, interval, t_s, vy_m_per_s, fx_n");
    const auto once =
        rows_of(database, fmt::format("SELECT {} FROM sample WHERE trial_id = 3", what));
    database.execute(
        "INSERT INTO trace_chunk SELECT trial, 2, first_tick, ticks, codec, period_ns, holds, "
        "crc32, derived, data"
        " FROM trace_chunk WHERE trial = 3");
    const auto both =
        rows_of(database, fmt::format("SELECT {} FROM sample WHERE trial_id = 3", what));
    REQUIRE(both.size() == 2 * once.size());
    for (std::size_t i = 0; i < once.size(); ++i) {
        REQUIRE((both[i] == once[i]));
        SampleRow second = once[i];
        second[1] = "2";
        REQUIRE((both[once.size() + i] == second));
    }
    const auto ordered = [&](const std::string& source, const std::string& by) {
        return rows_of(database, fmt::format("SELECT {} FROM {} ORDER BY {}", what, source, by));
    };
    for (const std::string by : {"trial_id, t_s", "trial_id, tick", "trial_id, interval, t_s"}) {
        CAPTURE(by, plan_of(database, "SELECT * FROM sample ORDER BY " + by));
        CHECK_THAT(plan_of(database, "SELECT * FROM sample ORDER BY " + by),
                   !ContainsSubstring("TEMP B-TREE"));
        // SQLite's own sort keeps equal rows in the order they come in.
        const bool same =
            ordered("sample WHERE trial_id = 3", by) ==
            ordered("(SELECT * FROM sample WHERE trial_id = 3 LIMIT -1)", "+" + by + ", +interval");
        CHECK(same);
    }
    CHECK(rows_of(database, "SELECT * FROM sample WHERE trial_id = 3 AND interval = 2").size() ==
          once.size());
}

TEST_CASE("files of older schemas have the same table", "[sample][law]") {
    const TemporaryFolder folder;
    const std::string file = folder.file("old.sqlite");
    std::ifstream in(PALPATE_SOURCE_DIR "/tests/golden/schema_4.sql");
    std::string sql = "\n";
    sql.append(std::istreambuf_iterator<char>(in), {});
    REQUIRE(tests::Process({"sqlite3", file, sql + "PRAGMA foreign_keys = OFF;"}).wait().code == 0);
    const auto ticks = tests::random_ticks(3, 600);
    for (std::size_t first = 0; first < ticks.size(); first += 256) {
        const auto part =
            std::span(ticks).subspan(first, std::min<std::size_t>(256, ticks.size() - first));
        const data::EncodedChunk chunk = data::encode(part);
        std::string hex;
        for (const std::byte byte : chunk.data) {
            hex += fmt::format("{:02x}", static_cast<unsigned>(byte));
        }
        const std::string row =
            fmt::format("INSERT INTO trace_chunk VALUES (1, {}, {}, 1, {}, x'{}');", first,
                        part.size(), chunk.crc32, hex);
        REQUIRE(tests::Process({"sqlite3", file, row}).wait().code == 0);
    }
    Opened database(file);
    const auto rows =
        rows_of(database, "SELECT tick, x_m, fn_n, mode, interval FROM sample WHERE trial_id = 1");
    REQUIRE(rows.size() == ticks.size());
    const auto alone =
        rows_of(database, "SELECT x_m FROM sample WHERE tick >= 300 ORDER BY trial_id, t_s");
    REQUIRE(alone.size() == 300);
    for (std::size_t i = 0; i < ticks.size(); ++i) {
        REQUIRE(rows[i][0] == std::to_string(ticks[i].tick));
        REQUIRE(rows[i][1] == tests::exactly(ticks[i].hip.x));
        REQUIRE(rows[i][2] == tests::exactly(ticks[i].normal_force));
        REQUIRE((i < 300 || alone[i - 300][0] == rows[i][1]));
        REQUIRE(rows[i][4] == "1");
    }
}

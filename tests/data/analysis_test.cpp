#include <nlohmann/json.hpp>

#include "data/analysis/summary.hpp"
#include "data/tables/table.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/studies.hpp"

using namespace palpate::data;

namespace {

/// The lines of the first confusion matrix, word by word: the head, then a line for each object.
std::vector<Words> matrix_of(const std::string& summary) {
    std::istringstream lines(summary.substr(summary.find("  felt")));
    std::vector<Words> matrix;
    std::string line;
    while (std::getline(lines, line) && !line.empty()) {
        std::istringstream words(line);
        matrix.emplace_back(std::istream_iterator<std::string>(words),
                            std::istream_iterator<std::string>());
    }
    return matrix;
}

int sum_of(const std::vector<Words>& matrix) {
    int sum = 0;
    for (std::size_t row = 1; row < matrix.size(); ++row) {
        for (std::size_t column = 1; column < matrix[row].size(); ++column) {
            sum += matrix[row][column] == "." ? 0 : std::stoi(matrix[row][column]);
        }
    }
    return sum;
}

Table people() {
    return {.place = "people/*/by/*",
            .title = "  Who",
            .columns = {{.key = "person", .words = "person"},
                        {.key = "friction", .words = "friction"},
                        {.key = "n", .words = "n"},
                        {.key = "mean", .words = "mean", .digits = 2},
                        {.key = "bits/p", .words = "p", .says = Column::Says::p},
                        {.key = "interval_95", .words = "interval", .digits = 1},
                        {.key = "wilson_95"},
                        {.key = "gone", .words = "gone"}},
            .index = 2,
            .rows = {{"A/1", Named{"on", "on - off"}, std::int64_t{3}, -0.004, 0.0002,
                      Interval{0.25, 1.0}, Interval{0.1, 0.2}, Nothing{}},
                     {"A/1", Named{"off", "off - off"}, std::int64_t{12},
                      cell_of(std::numeric_limits<double>::infinity(), "no end"), 0.25,
                      cell_of(std::optional<Interval>()), Nothing{}, Nothing{}}},
            .notes = {"Nobody else."}};
}

}  // namespace

TEST_CASE("a Wilson interval holds its share, lies in 0 to 1, and mirrors") {
    for (std::int64_t n = 0; n <= 60; ++n) {
        for (std::int64_t k = 0; k <= n; ++k) {
            const data::Interval ci = data::wilson(k, n);
            const data::Interval mirror = data::wilson(n - k, n);
            const double share = n == 0 ? 0.5 : static_cast<double>(k) / static_cast<double>(n);
            REQUIRE((ci.low >= 0.0 && ci.high <= 1.0 && ci.low <= share && share <= ci.high));
            REQUIRE(std::fabs(ci.low - (1.0 - mirror.high)) < 1e-12);
        }
    }
}

TEST_CASE("the summary counts main trials of each kind apart, and says what is simulated") {
    const TemporaryFile file("it's.sqlite");
    Database database(file, Access::write);
    CHECK_THAT(data::summary_text(database), Has("No main trial"));
    for (const data::RunKind kind : {data::RunKind::simulated, data::RunKind::real}) {
        auto spec = session_spec(small_protocol(), kind == data::RunKind::real ? "R1" : "S1");
        spec.kind = kind;
        const auto opened = data::open_session(database, spec);
        data::SqliteRecorder recorder(database, spec.protocol, opened.id);
        for (const auto& planned : spec.plan.trials) {  // the real one always says "convex"
            const std::size_t object = kind == data::RunKind::real ? 2 : planned.condition.object;
            const auto id = begin_trial(recorder, spec.protocol, planned);
            recorder.end_trial(id, answered(object, object == planned.condition.object));
        }
    }
    const std::string text = data::summary_text(database);
    CHECK_THAT(text, Has("simulated data: participant and device are SIMULATED",
                         "S1      off       3     3  1.000  0.439 to 1.000",
                         "R1      off       1     3  0.333  0.061 to 0.792",
                         "one person: how people differ is not known"));
    CHECK(text.find("real data") < text.find("simulated data"));
    CHECK_THAT(text, Has("straight         .         .         2"));
}

TEST_CASE(
    "the matrix has every object of the plan, and no choice drops out of it, from the first trial "
    "on") {
    SEEDED(random, std::uint64_t{3});
    SmallSession session(small_protocol(2));
    int answers = 0;
    for (const auto& planned : session.spec.plan.trials) {
        const auto object = random.index(3);
        session.record(planned.position, answered(object, object == planned.condition.object));
        ++answers;
        const auto matrix = matrix_of(data::summary_text(session.database));
        CAPTURE(answers);
        REQUIRE(matrix.size() == 4);
        CHECK(matrix[0] == Words{"felt", "concave", "straight", "convex"});
        for (std::size_t row = 1; row < matrix.size(); ++row) {
            CHECK(matrix[row].size() == 4);
            CHECK(matrix[row][0] == matrix[0][row]);
        }
        CHECK(sum_of(matrix) == answers);
    }
}

TEST_CASE("the two queries of the summary run as printed, also for a name with a quote in it") {
    const TemporaryFile file("it's.sqlite");
    Database database(file, Access::write);
    const auto spec = session_spec(small_protocol());
    const auto opened = data::open_session(database, spec);
    data::SqliteRecorder recorder(database, spec.protocol, opened.id);
    recorder.end_trial(begin_trial(recorder, spec.protocol, spec.plan.trials[0]),
                       answered(1, false));
    const std::string text = data::example_queries(file);
    const Words queries = between(text, "  sqlite3", "\n");
    CHECK(queries.size() == 2);
    for (const std::string& words : queries) {
        const Finished query = Process({"sh", "-c", "sqlite3" + words}).wait();
        CAPTURE(query.error);
        CHECK(query.code == 0);
        CHECK_THAT(query.out, Has("friction"));
    }
}

TEST_CASE("a table says the same as text, JSON and fields, and why there is nothing") {
    const Table table = people();
    // Written by hand from the rows above.
    CHECK(table_text(table) ==
          "\n  Who\n"
          "  person  friction    n    mean       p    interval\n"
          "  A/1     on - off    3    0.00  <0.001  0.2 to 1.0\n"
          "          off - off  12  no end   0.250           -\n"
          "  Nobody else.\n");
    Json all;
    put_table(all, table);
    CHECK(all == Json::parse(R"({"people": {"A/1": {"by": {
        "on": {"n": 3, "mean": -0.004, "bits": {"p": 0.0002}, "interval_95": [0.25, 1.0],
               "wilson_95": [0.1, 0.2], "gone": null},
        "off": {"n": 12, "mean": null, "bits": {"p": 0.25}, "interval_95": null,
                "wilson_95": null, "gone": null, "why": "no end"}}}}})"));
    CHECK(table_csv(fields_of(table)) ==
          "person,friction,n,mean,p,low,high,wilson_low,wilson_high,gone\n"
          "A/1,on - off,3,-0.004,0.0002,0.25,1,0.1,0.2,\n"
          "A/1,off - off,12,,0.25,,,,,\n");
    // An end that nothing bounds is another thing than no interval.
    const double endless = std::numeric_limits<double>::infinity();
    CHECK(table_csv(fields_of(
              {.columns = {{.key = "interval_95"}},
               .rows = {{Interval{-endless, 2.0}}, {Interval{1.0, endless}}, {Nothing{}}}})) ==
          "low,high\n-inf,2\n1,inf\n,\n");
}

TEST_CASE("a table without rows says nothing, one across stands on its side, one may be a list") {
    Table table = people();
    table.across = true;
    table.title.clear();
    CHECK_THAT(table_text(table), StartsWith("\n"
                                             "  person           A/1        A/1"
                                             "\n"
                                             "  friction    on - off  off - off"
                                             "\n"));
    table.place = "list/-";
    Json all;
    put_table(all, table);
    CHECK(all["list"].size() == 2);
    CHECK(all["list"][1]["friction"] == "off");
    CHECK(all["list"][1]["n"] == 12);
    table.rows.clear();
    CHECK(table_text(table) == "\n  Nobody else.\n");
    table.notes.clear();
    CHECK(table_text(table).empty());
    Json none;
    put_table(none, table);
    CHECK(none.is_null());
}

TEST_CASE("what names a row is said again where anything to its left is another") {
    Table table{.columns = {{.key = "person", .words = "person"},
                            {.key = "session", .words = "session"},
                            {.key = "run", .words = "run"},
                            {.key = "remark", .words = " "}},
                .index = 3};
    for (const char* person : {"A", "B"}) {
        table.rows.push_back({person, std::int64_t{1}, "equal", Nothing{}});
        table.rows.push_back({person, std::int64_t{1}, "other", "far"});
    }
    CHECK(table_text(table) ==
          "\n  person  session  run\n"
          "  A             1  equal\n"
          "                   other  far\n"
          "  B             1  equal\n"
          "                   other  far\n");
}

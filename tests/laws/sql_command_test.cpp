#include "tests/support/program.hpp"

namespace {

const std::string& demo_file() {
    static const TemporaryFolder folder;
    static const std::string file = [] {
        ran({"demo", "--headless", "--db", folder.file("it's a demo.sqlite")});
        return folder.file("it's a demo.sqlite");
    }();
    return file;
}

Finished sql(const std::string& query, const Words& words = {}) {
    return palpate_command(joined({"sql", demo_file(), "-c", query}, words));
}

std::string extension() {
    const Finished found = ran({"extension"});
    return found.out.substr(0, found.out.find('\n'));
}

/// Columns of every kind, of one trial and of all: a query a line.
const Words kQueries = lines_in(test_text("sql_queries.sql"));

/// Lines of comma-separated values are the same: numbers to the last of 15 digits, texts to the
/// letter.
void check_same(const std::string& ours, const std::string& theirs) {
    const auto a = csv_body(ours);
    const auto b = csv_rows(theirs);
    REQUIRE(a.size() == b.size());
    for (std::size_t row = 0; row < a.size(); ++row) {
        REQUIRE(a[row].size() == b[row].size());
        for (std::size_t i = 0; i < a[row].size(); ++i) {
            const std::string& x = a[row][i];
            const std::string& y = b[row][i];
            CAPTURE(row, i, x, y);
            char* end = nullptr;
            const double value = std::strtod(x.c_str(), &end);
            if (!x.empty() && *end == '\0') {
                REQUIRE(std::strtod(y.c_str(), nullptr) == Approx(value).epsilon(1e-14));
            } else {
                REQUIRE(x == y);
            }
        }
    }
}

}  // namespace

TEST_CASE("palpate sql prints tables, CSV and JSON") {
    const Finished table = sql("SELECT 'a, \"b\"' AS text, 1.5 AS x, NULL AS n, '' AS e");
    CHECK(table.code == 0);
    CHECK(table.out == "text    x    n  e\n------  ---  -  -\na, \"b\"  1.5\n");
    CHECK(sql("SELECT 'a, \"b\"' AS text, 1.5 AS x, NULL AS n, '' AS e", {"--csv"}).out ==
          "text,x,n,e\n\"a, \"\"b\"\"\",1.5,,\"\"\n");
    CHECK(sql("SELECT 'a\"' AS t, 0.1 AS x, NULL AS n, x'0aff' AS b UNION ALL SELECT 'c', 1, 2, 3",
              {"--json"})
              .out ==
          "[{\"t\": \"a\\\"\", \"x\": 0.1, \"n\": null, \"b\": \"0AFF\"},\n"
          "{\"t\": \"c\", \"x\": 1, \"n\": 2, \"b\": 3}]\n");
    CHECK(sql("SELECT 1 AS a WHERE 0", {"--json"}).out == "[]\n");
    // An object's keys differ; a table's heads and those of CSV are as they were asked for.
    CHECK(sql("SELECT 1 AS a, 2 AS a, 3 AS a_2, 4 AS a", {"--json"}).out ==
          "[{\"a\": 1, \"a_3\": 2, \"a_2\": 3, \"a_4\": 4}]\n");
    CHECK(sql("SELECT 1 AS a, 2 AS a", {"--csv"}).out == "a,a\n1,2\n");
    // JSON has no infinity: a number that is too large is read as one.
    CHECK(sql("SELECT 9e999 AS x, -9e999 AS y, 9e999 - 9e999 AS z", {"--json"}).out ==
          "[{\"x\": 1e999, \"y\": -1e999, \"z\": null}]\n");
    // A table shows the beginning of what is long, in whole characters.
    const std::string wide = "SELECT replace(hex(zeroblob(1000)), '0', 'ö') AS t";
    CHECK_THAT(sql(wide + ", zeroblob(501) AS b").out,
               Has(fmt::format("\n{0:ö>1000}…  {0:0>1000}…\n", "")));
    CHECK(sql(wide, {"--csv"}).out == fmt::format("t\n{:ö>2000}\n", ""));
    CHECK(sql("SELECT 1; SELECT 2 AS b -- and\n;", {"--csv"}).out == "1\n1\nb\n2\n");
}

TEST_CASE("a sentence of .tables is wrapped, and not a character of it is lost") {
    std::string sentence;  // of trace_column
    for (const std::string& line : lines_in(sql(".tables").out)) {
        CHECK(line.size() <= 110);
        const bool first = line.starts_with("trace_column ");
        if (first || (!sentence.empty() && line.starts_with("    "))) {
            const std::size_t from = first ? line.find("Number") : line.find_first_not_of(' ');
            sentence += (first ? "" : " ") + line.substr(from);
        } else if (!sentence.empty()) {
            break;
        }
    }
    CHECK_THAT(sentence, Has(" -2147483648 in a column"));
    CHECK_THAT(sql(".tables", {"--csv"}).out, Has("\"" + sentence + "\""));
    CHECK_THAT(sql(".help").out, Has("n of n hits count as n - 1/2"));
}

TEST_CASE("the queries that .help recommends run, and find something") {
    const Words queries = between(sql(".help").out, "SELECT", ";");
    REQUIRE(queries.size() == 1);
    const Finished found = ended(sql("SELECT" + queries.front(), {"--csv"}));
    CHECK(found.out.find('\n') + 1 < found.out.size());
}

TEST_CASE("what SQLite refuses comes with its place, and exit code 1") {
    const Finished wrong = sql("SELECT count(*)\nFROM trial\nWHERE fnord = 1");
    CHECK(wrong.code == 1);
    CHECK(wrong.error == "palpate: 3:7: no such column: fnord\n  WHERE fnord = 1\n        ^\n");
    CHECK_THAT(sql("SELEC 1").error, Has("palpate: 1:1: near \"SELEC\": syntax error"));
    check_end(sql("SELECT wilson_low(3, 2)"), 1, Has("0 <= k <= n"));
    CHECK(sql(".nothing").code == 1);
    for (const char* nothing : {"", ";", " ;; ", "-- x", "/* x */;"}) {
        check_end(sql(nothing), 2, Has("there is no statement in it: give SQL"));
    }
    CHECK(palpate_command({"sql", "/nowhere/a.sqlite", "-c", "SELECT 1"}).code != 0);
}

TEST_CASE("palpate sql changes nothing, whatever it is asked") {
    const std::string before = sql("SELECT count(*), sum(length(data)) FROM trace_chunk").out;
    const TemporaryFolder folder;
    for (const std::string& query :
         {std::string("DELETE FROM trial"), std::string("DROP TABLE trace_chunk"),
          std::string("PRAGMA user_version = 99"), std::string("CREATE TABLE t (a)"),
          std::string("INSERT INTO sample (trial_id) VALUES (1)"),
          std::string("UPDATE session SET seed = 1"), std::string("VACUUM"),
          "VACUUM INTO '" + folder.file("x.sqlite") + "'",
          "ATTACH '" + folder.file("y.sqlite") + "' AS y; CREATE TABLE y.t (a)",
          std::string("SELECT load_extension('x')"), std::string("SELECT writefile('x', 1)")}) {
        const Finished refused = sql(query);
        CAPTURE(query, refused.out, refused.error);
        CHECK(refused.code == 1);
        CHECK_FALSE(refused.error.empty());
    }
    CHECK_THAT(sql("DELETE FROM trial").error, Has("only reads"));
    CHECK(folder.names().empty());
    CHECK(sql("SELECT count(*), sum(length(data)) FROM trace_chunk").out == before);
}

TEST_CASE("the shell reads statements of many lines from a pipe, and words") {
    const TemporaryFile file("in.sql");
    std::ofstream(file)
        << ".tables\nSELECT count(*) AS n\nFROM trial\n;\nSELECT fnord;\nSELECT 2 AS "
           "two;\n.columns analysis_trial\nSELECT 3 AS last";
    const Finished done = shell("exec \"$0\" sql \"$1\" <\"$2\"", "/", {demo_file(), file});
    CHECK(done.code == 1);  // one of them failed
    CHECK_THAT(done.error, Has("palpate: 5:8: no such column: fnord"));
    CHECK_THAT(done.out, Has("analysis_trial", "virtual table", "n\n--\n10\n", "two\n---\n  2\n",
                             "mean_speed_m_per_s ", " m/s ", "last\n----\n   3\n"));
    CHECK_THAT(sql(".schema trial").out, Has("CREATE TABLE trial"));
    CHECK_THAT(sql(".help").out, Has(".columns"));
    CHECK(sql(".quit\nSELECT 1").out.empty());
}

TEST_CASE("a byte of value 0 ends the shell with a sentence") {
    const Finished done = shell(
        "printf 'SELECT 3 AS last;\\0SELECT 4;' | timeout 9 \"$0\" sql \"$1\"", "/", {demo_file()});
    CHECK(done.code == 1);
    CHECK(done.out == "last\n----\n   3\n");
    CHECK(done.error == "palpate: a byte of value 0 is no SQL: take it away\n");
}

TEST_CASE("sqlite3 with the extension says what palpate sql says") {
    if (!others_load_extension() || !installed("sqlite3", {"sqlite3", "--version"})) {
        return;
    }
    for (const std::string& query : kQueries) {
        CAPTURE(query);
        const Finished theirs = ended(Process({"sqlite3", "-readonly", "-csv", "-cmd",
                                               ".load " + extension(), demo_file(), query})
                                          .wait());
        check_same(sql(query, {"--csv"}).out, theirs.out);
    }
}

TEST_CASE("Python with the extension says what palpate sql says") {
    if (!others_load_extension()) {
        return;
    }
    // Some Pythons are built without extensions.
    const Words pythons{"/usr/bin/python3", "python3"};
    const auto python = std::ranges::find_if(pythons, [](const std::string& one) {
        const std::string loads = "import sqlite3; sqlite3.Connection.enable_load_extension";
        return Process({one, "-c", loads}).wait().code == 0;
    });
    if (python == pythons.end()) {
        WARN("no python3 whose sqlite3 loads extensions: not checked");
        return;
    }
    for (const std::string& query : kQueries) {
        CAPTURE(query);
        const Finished theirs = ended(
            Process({*python, script("sql_rows.py"), demo_file(), extension(), query}).wait());
        check_same(sql(query, {"--csv"}).out, theirs.out);
    }
}

TEST_CASE("R with the extension says what palpate sql says, and R's own statistics agree") {
    if (!others_load_extension() ||
        !installed("R with RSQLite", {"Rscript", "-e", "library(RSQLite)"})) {
        return;
    }
    const Words words{"Rscript", script("sql_rows.R"), demo_file(), extension()};
    const Finished all = ended(Process(joined(words, kQueries)).wait());
    std::size_t from = 0;
    for (const std::string& query : kQueries) {  // R starts once for all
        CAPTURE(query);
        const std::string end = "end of query\n";
        const std::size_t to = all.out.find(end, from);
        REQUIRE(to != std::string::npos);
        check_same(sql(query, {"--csv"}).out, all.out.substr(from, to - from));
        from = to + end.size();
    }
    // binom.test, qnorm, and the integral of d' by R's own quadrature.
    const Finished r = ended(Process({"Rscript", script("statistics.R")}).wait());
    std::vector<double> theirs;
    for (const std::string& one : split(r.out.substr(2))) {
        theirs.push_back(std::stod(one));
    }
    const char* const ours[] = {
        "SELECT clopper_pearson_low(13, 47)",
        "SELECT clopper_pearson_high(13, 47)",
        "SELECT probit(0.123)",
        "SELECT d_prime(31, 50, 5)",
        "SELECT quantile(column1, 0.3) FROM (VALUES (3), (1), (4), (1), (5), (9), (2.5))",
        "SELECT stddev_samp(column1) FROM (VALUES (3), (1), (4), (1), (5))"};
    REQUIRE(theirs.size() == std::size(ours));
    for (std::size_t i = 0; i < theirs.size(); ++i) {
        const std::string out = sql(ours[i], {"--csv"}).out;
        CAPTURE(ours[i], out);
        CHECK(std::stod(out.substr(out.find('\n') + 1)) == Approx(theirs[i]).epsilon(1e-9));
    }
}

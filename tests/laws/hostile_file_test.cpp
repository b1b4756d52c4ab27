#include "data/store/database.hpp"
#include "data/store/secret.hpp"
#include "tests/support/lab_files.hpp"
#include "tests/support/page_reader.hpp"

namespace {

const std::string kEndless =
    "PRAGMA writable_schema = ON; DELETE FROM sqlite_schema WHERE tbl_name = 'trial'; INSERT INTO "
    "sqlite_schema VALUES ('view', 'trial', 'trial', 0, 'CREATE VIEW trial AS WITH RECURSIVE r(n) "
    "AS (SELECT 1 UNION ALL SELECT n + 1 FROM r) SELECT n AS trial_id FROM r')";
const std::string kAllRight =
    "PRAGMA writable_schema = ON; UPDATE sqlite_schema SET sql = replace(sql, 'response.correct AS "
    "correct', '1 AS correct') WHERE name = 'analysis_trial'";

}  // namespace

TEST_CASE("nothing is written beside what a file's schema would do") {
    const LabFiles files;
    auto edits = test_rows("edits/foreign_schemas.tsv");
    edits.push_back({kAllRight, "view analysis_trial"});
    edits.push_back({kEndless, "table trial"});
    for (const Words& edit : edits) {
        const std::string& sql = edit.at(0);
        const std::string file = files.with(sql);
        const std::string before = lab_sqlite(file, ".dump");
        for (const Words& words : {files.run(file, "P02"),
                                   Words{"note", file, "hot", "--participant", "demo"},
                                   {"mark", file, "2", "--invalid", "bell"},
                                   {"participant", file, "demo", "--consent", "no"},
                                   {"participant", file, "P09", "--new"},
                                   {"merge", file, files.clean}}) {
            CAPTURE(sql, words.front());
            CHECK_THAT(ran(words, 2).error, Has(edit.at(1), "nothing is written into it"));
        }
        CHECK(lab_sqlite(file, ".dump") == before);
    }
}

TEST_CASE("no view of a file is believed, and none keeps a command for ever") {
    const LabFiles files;
    const auto asked = [](const std::string& file) {
        return std::vector<Words>{{"summary", file},
                                  {"stats", file, "--kind", "simulated", "--json"},
                                  {"sql", file, "-c", "SELECT sum(correct) FROM analysis_trial"}};
    };
    const std::string edited = files.with(kAllRight);
    for (std::size_t i = 0; i < asked(edited).size(); ++i) {
        const Finished right = palpate_command(asked(files.clean)[i]);
        CAPTURE(asked(edited)[i].front());
        const Finished done = ran(asked(edited)[i]);
        CHECK(all_replaced(done.out, edited, files.clean) == right.out);
        CHECK(right.error.empty());
        CHECK_THAT(done.error, StartsWith("palpate: ") && Has("view analysis_trial"));
    }
    const Finished shared =
        ran({"export", edited, "--kind", "all", "-o", files.folder.file("of_edited")});
    CHECK(count_of(shared.error, "view analysis_trial") == 1);  // said once
    // What no table takes is no merge, which leaves nothing behind.
    const std::string odd = files.with(
        "PRAGMA ignore_check_constraints = 1;UPDATE participant SET participant_code = 'a b'");
    const std::string merged = files.folder.file("odd_merged.sqlite");
    CHECK_THAT(palpate_command({"merge", merged, odd}).error,
               Has("none that its table takes, and no palpate made it"));
    CHECK(!std::filesystem::exists(merged));
    const std::string loop = files.folder.file("loop.sqlite");
    std::filesystem::create_symlink("loop.sqlite", loop);
    CHECK_THAT(palpate_command({"summary", loop}).error,
               Has("it is a link that leads back to itself"));
    // Of a file whose tables are others palpate's own views are asked, and no other.
    const std::string added = files.with("ALTER TABLE response ADD COLUMN fake REAL DEFAULT 5");
    CHECK(palpate_command({"sql", added, "-c", "SELECT sum(correct) FROM main_trial"}).out ==
          palpate_command({"sql", files.clean, "-c", "SELECT sum(correct) FROM main_trial"}).out);
    CHECK_THAT(ran({"sql", added, "-c", "SELECT 1 FROM main.confusion"}, 1).error,
               Has("palpate's own go by their names without main"));
    const std::string endless = files.with(kEndless);
    for (const char* line : {"summary {db}", "verify {db}", "stats {db}", "fit {db}", "audit {db}",
                             "trace {db} 1", "report {db} -o {out}", "export {db} -o {out}",
                             "merge {out} {db}", "sql {db} -c {query}"}) {
        const Words words = words_of(palpate_program(), line,
                                     {{"{db}", endless},
                                      {"{out}", files.folder.file("new")},
                                      {"{query}", "SELECT count(*) FROM trial"}});
        const Finished done = Process(words).wait(std::chrono::seconds(60));
        CAPTURE(line, done.out, done.error);
        CHECK((done.code == 1 || done.code == 2));
        CHECK_THAT(done.out + done.error, Has("table trial"));
    }
    // One that is planted while palpate is at work, on a table of the lab that follows ours.
    const std::string file = files.with(
        "CREATE TABLE mine (trial_id INTEGER REFERENCES response ON DELETE SET NULL, x)");
    data::Database open(file, data::Access::write);
    lab_sqlite(
        file,
        "INSERT INTO mine VALUES (1, 0);CREATE TRIGGER a AFTER DELETE ON response BEGIN UPDATE "
        "trial SET outcome = 'aborted'; END;CREATE TRIGGER b AFTER UPDATE ON mine BEGIN UPDATE "
        "trial SET outcome = 'aborted'; END");
    open.execute("DELETE FROM response WHERE trial_id = 1");
    auto row = open.first("SELECT count(*) FROM trial WHERE outcome = 'aborted'");
    CHECK(row.integer(0) == 0);
}

TEST_CASE("of a file with a damaged page nothing is said but that it is damaged") {
    const LabFiles files;
    const std::string file = files.with("SELECT 1");
    const std::string page = GENERATE("participant", "response", "study", "session");
    const long long at =
        std::stoll(lab_sqlite(file,
                              "SELECT 4096 * (rootpage - 1) FROM sqlite_schema WHERE "
                              "name = '" +
                                  page + "'"));
    {  // its cells are there, and none is counted
        std::fstream edited(file, std::ios::binary | std::ios::in | std::ios::out);
        edited.seekp(at + 3).write("\0\0", 2);
    }
    for (const char* line :
         {"summary {db}", "participant {db}", "status {db}", "stats {db} --kind simulated",
          "export {db} --kind all -o {out}", "merge {out} {db}"}) {
        CAPTURE(page, line);
        const Finished done =
            ran(words_of("", line, {{"{db}", file}, {"{out}", files.folder.file("new")}}), 1);
        CHECK(done.out.empty());
        CHECK_THAT(done.error, Has("the file is damaged", "restore a copy"));
    }
    ran({"verify", file}, 1);
}

TEST_CASE("what a lab added to a file is theirs, and never in the way") {
    const LabFiles files;
    const std::string file = files.with(
        "CREATE TABLE my_notes (trial_id INTEGER, remark TEXT);"
        "CREATE TABLE \"my \"\"words\" (trial_id INTEGER PRIMARY KEY, a, b, c REFERENCES my_notes);"
        "INSERT INTO my_notes VALUES (1, 'hm');INSERT INTO \"my \"\"words\" VALUES (1, 2, 3, NULL);"
        "CREATE TABLE coder (session_id INTEGER, name TEXT);INSERT INTO coder VALUES (1, 'Jane');"
        "CREATE INDEX by_outcome ON trial (outcome) ;CREATE INDEX \"by-o\" ON response (trial_id);"
        "CREATE VIEW theirs AS SELECT * FROM my_notes;"
        "CREATE TRIGGER u AFTER INSERT ON my_notes BEGIN SELECT 1; END");
    CHECK_THAT(ran(files.run(file, "P02")).error, !Has("schema"));
    ran({"mark", file, "2", "--invalid", "bell"});
    const auto verified = [](const std::string& at) {
        const Finished done = ran({"verify", at});
        return done.out.substr(done.out.find('\n'));
    };
    const std::string seals = verified(file);
    const std::string merged = files.folder.file("merged.sqlite");
    ran({"merge", merged, file});
    CHECK(lab_sqlite(merged,
                     "SELECT count(*) FROM sqlite_schema WHERE name IN ('my_notes', 'coder')") ==
          "0\n");
    verified(merged);
    const std::string shared = files.folder.file("shared");
    ran({"export", file, "--kind", "all", "-o", shared});
    CHECK(!std::filesystem::exists(shared + "/my_notes.csv"));
    const Finished theirs = palpate_command({"sql", file, "--csv", "-c", "SELECT * FROM theirs"});
    CHECK(theirs.out == "trial_id,remark\n1,hm\n");
    lab_sqlite(file,
               "DROP VIEW theirs;DROP TABLE my_notes;DROP TABLE \"my \"\"words\";DROP TABLE coder");
    CHECK(verified(file) == seals);
}

TEST_CASE("nobody gives a file a second secret") {
    const LabFiles files;
    const std::string file =
        files.with("INSERT INTO secret VALUES ('00000000000000000000000000000000')");
    CHECK_THAT(ran({"verify", file}, 1).out,
               Has("differs  secret: stored 2 rows with which nothing"));
    for (const Words& words :
         {files.run(file, "P02"), Words{"participant", file, "P02", "--new"}}) {
        CAPTURE(words.front());
        CHECK_THAT(ran(words, 1).error, Has("a second secret"));
    }
    const std::string cured =
        files.folder.file("cured.sqlite");  // a merge takes those that were used
    ran({"merge", cured, file});
    ran({"verify", cured});
    CHECK(lab_sqlite(cured, "SELECT count(*) FROM secret WHERE hex LIKE '000%'") == "0\n");
    // Those of merged files were all used, and new people are drawn with the first.
    const std::string other = files.folder.file("other.sqlite");
    for (const std::string& at : {files.clean, other}) {
        ran(files.run(at, at == other ? "P01" : "P02"));
    }
    const std::string merged = files.folder.file("merged.sqlite");
    ran({"merge", merged, other, files.clean});
    ran({"participant", merged, "P03", "--new"});
    CHECK_THAT(ran({"verify", merged}).out,
               Has("Not checked, since nothing else in the file says it:",
                   "when handedness or consent was noted"));
}

TEST_CASE("a secret that somebody brings along is nobody else's") {
    const LabFiles files;
    const std::string zeros(32, '0');
    const std::string file = files.folder.file("mine.sqlite");
    const auto secret_of = [&](const std::string& code) {
        return lab_sqlite(
            file,
            "SELECT secret FROM session JOIN participant USING (participant_id) WHERE "
            "participant_code = '" +
                code + "'");
    };
    ran(files.run(file, "P01"));
    const std::string own = secret_of("P01");
    bool whole = true;
    SECTION("planted, with a person who was drawn with it") {
        lab_sqlite(file, "INSERT INTO secret VALUES ('" + zeros + "')");
        lab_sqlite(file, "INSERT INTO participant (participant_code, subject) VALUES ('EVE', " +
                             std::to_string(data::subject_of("EVE", zeros, 0)) + ")");
    }
    SECTION("merged, with a session of theirs") {
        const std::string eve = files.folder.file("eve.sqlite");
        ran(joined(files.run(eve, "EVE"), {"--secret", zeros}));
        ran({"merge", file, eve});
        CHECK(secret_of("EVE") == zeros + "\n");
    }
    SECTION("in the place of the file's own") {
        lab_sqlite(file, "UPDATE secret SET hex = '" + zeros + "'");
        whole = false;
    }
    const Finished ran = palpate_command(files.run(file, "P02"));
    CAPTURE(ran.error);
    CHECK(ran.code == (whole ? 0 : 1));
    CHECK(secret_of("P02") == (whole ? own : ""));
    CHECK((whole || ran.error.find("was removed or changed") != std::string::npos));
}

TEST_CASE("a query that somebody pasted reads this file, and ends") {
    const LabFiles files;
    const std::string other = files.with("SELECT 1");
    for (const auto& row : test_rows("pasted_queries.tsv")) {  // it, how many steps, what is said
        CAPTURE(row);
        const Words words{"sql", files.clean, "-c", all_replaced(row.at(0), "{other}", other)};
        CHECK_THAT(
            ran(joined(words, row.at(1).empty() ? Words{} : Words{"--steps", row.at(1)}), 1).error,
            Has(row.at(2)));
    }
    CHECK(palpate_command({"sql", files.clean, "--attach", "--csv", "-c",
                           "ATTACH '" + other + "' AS b; SELECT count(*) FROM b.trial"})
              .out == "count(*)\n10\n");
    CHECK(sql_csv(files.clean, "SELECT char(9) || '=1+1' AS t") == "t\n'\t=1+1\n");
    CHECK(sql_csv(files.clean,
                  "SELECT printf('%s-%d-%q', 'a', 7, 'o''k') AS a, format('%d %d', 1) AS "
                  "b, typeof(printf('')) AS c, typeof(printf('%s', NULL)) AS d") ==
          "a,b,c,d\na-7-o''k,1 0,null,text\n");
    ran({"sql", files.clean, "-c", "SELECT count(*) FROM sample"});
    Process endless({palpate_program(), "sql", files.clean, "-c",
                     "WITH RECURSIVE r(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM r) SELECT "
                     "max(x) FROM r",
                     "--steps", "1000000000000"});
    pause(0.5);
    endless.signal(SIGINT);
    CHECK(endless.wait(std::chrono::seconds(60)).code == 128 + SIGINT);
}

TEST_CASE("what an export left half-made goes, and no code is taken for an option") {
    const LabFiles files;
    const std::string shared = files.folder.file("shared");
    const std::string left = shared + ".palpate-part-aBcD12";
    std::filesystem::create_directory(left);
    write(left + "/trials.csv", "subject");
    const std::string near = shared + ".palpate-part-another";
    write(near, "");
    CHECK_THAT(ran({"export", files.clean, "--kind", "all", "-o", shared}).error,
               Has("aBcD12", "it is removed"));
    CHECK(!std::filesystem::exists(left));
    CHECK(std::filesystem::exists(near));
    for (const char* code : {"--help", "-rf", "_a"}) {
        const Finished refused =
            ran({"run", "shape_friction_demo", std::string("--participant=") + code, "--db",
                 files.folder.file("new.sqlite"), "--headless", "--speed", "0"},
                2);
        CHECK_THAT(refused.error, Has("the first a letter or digit"));
    }
}

#include "data/store/database.hpp"
#include "tests/support/lab_files.hpp"

TEST_CASE("no table, order or reference of a lab's is in the way of a command") {
    const LabFiles files;
    const std::string page = files.folder.file("r.html");
    const std::string shared = files.folder.file("shared");
    for (const std::string& sql : {
             std::string("CREATE TABLE json_each (value)"),
             std::string("CREATE TABLE pragma_table_info (name);"
                         "CREATE TABLE pragma_database_list (name)"),
             std::string("CREATE TABLE mine (n TEXT COLLATE uint UNIQUE);"
                         "INSERT INTO mine VALUES ('a9'), ('a10')"),
             std::string("CREATE TABLE mine (trial_id INTEGER REFERENCES trial, remark);"
                         "INSERT INTO mine SELECT trial_id, 'hm' FROM trial"),
         }) {
        const std::string file = files.with(sql);
        const std::string merged = files.folder.file("merged.sqlite");
        for (const std::string& made : {merged, page, shared}) {
            std::filesystem::remove_all(made);
        }
        for (const Words& words :
             std::vector<Words>{files.run(file, "P02"),
                                {"summary", file},
                                {"stats", file, "--kind", "simulated", "--permutations", "0",
                                 "--simulations", "0"},
                                {"export", file, "--kind", "all", "-o", shared},
                                {"report", file, "--kind", "simulated", "-o", page, "--simulations",
                                 "0", "--bootstrap", "0"},
                                {"sql", file, "-c", "SELECT count(*) FROM sample"},
                                {"merge", merged, file},
                                {"verify", file}}) {
            CAPTURE(sql, words.front());
            CHECK(ran(words).error.empty());
        }
    }
    // What cannot be done is said by name, and nothing is half done.
    for (const auto& [sql, said] : std::vector<std::pair<std::string, std::string>>{
             {"CREATE TABLE mine (n TEXT COLLATE uint UNIQUE)",
              "table mine is ordered by a rule of another program"},
             {"CREATE TABLE mine (trial_id INTEGER REFERENCES trial);"
              "INSERT INTO mine SELECT trial_id FROM trial",
              "a table that was added refers to rows that would change (mine)"}}) {
        const std::string file = files.with(sql);
        const std::string before = lab_sqlite(file, ".dump");
        const Finished done =
            palpate_command({"participant", file, "demo", "--destroy", "everything", "--yes"});
        CAPTURE(sql, done.out, done.error);
        CHECK(done.code != 0);
        CHECK_THAT(done.error, Has(said));
        CHECK(lab_sqlite(file, ".dump") == before);
    }
}

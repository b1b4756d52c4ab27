#include "tests/support/lab_files.hpp"
#include "tests/support/sql_first.hpp"

// What a file says of its studies and of how ticks are written, which is of no session, is believed
// for no order of files: it follows from the protocol's hash, and from the program.

namespace {

const Words kOtherStudies{
    "UPDATE study SET protocol_toml = replace(protocol_toml, 'stiffness_n_per_m = 1000', "
    "'stiffness_n_per_m = 900')",
    "UPDATE study SET study_title = 'Another'", "UPDATE study SET study_name = 'another'"};

std::string studies(const std::string& file) {
    return sql_csv(file, "SELECT study_name, study_title, protocol_toml FROM study");
}

}  // namespace

TEST_CASE("a study that is not what its text says comes into no file, in any order") {
    const LabFiles lab;
    const std::string all = lab.folder.file("all.sqlite");
    for (const std::string& edit : kOtherStudies) {
        const std::string wrong = lab.with(edit);
        CAPTURE(edit);
        for (const Words& files : {Words{lab.clean, wrong}, Words{wrong, lab.clean}}) {
            check_end(palpate_command(joined({"merge", all}, files)), 1,
                      Has("what was recorded differs", "--prefer"));
            CHECK(lines_in(studies(all)).size() == 1);  // the names of columns
            ran(joined({"merge", all, "--prefer", lab.clean}, files));
            CHECK(studies(all) == studies(lab.clean));
            ran({"verify", all});
            std::filesystem::remove(all);
        }
        check_end(palpate_command({"merge", all, wrong}), 1, Has("was changed since"));
        CHECK_THAT(ran({"verify", wrong}, 1).out, Has("study."));
        // One that has it already.
        check_end(palpate_command({"merge", wrong, lab.clean}), 1,
                  Has("what was recorded differs"));
        ran({"merge", wrong, lab.clean, "--prefer", lab.clean});
        CHECK(studies(wrong) == studies(lab.clean));
        ran({"verify", wrong});
        std::filesystem::remove(all);
    }
}

TEST_CASE("no session begins, and none goes on, in a study that is not what its text says") {
    const LabFiles lab;
    for (const std::string& edit : kOtherStudies) {
        CAPTURE(edit);
        const std::string wrong =
            lab.with("UPDATE session SET finished = 0, finished_utc = NULL;" + edit);
        const std::string before = sql_csv(wrong, "SELECT count(*) FROM session");
        for (const std::string who : {"demo", "P2"}) {
            check_end(palpate_command(lab.run(wrong, who)), 1,
                      Has("is not what it was: study.", "go on in a copy from before that"));
        }
        CHECK(sql_csv(wrong, "SELECT count(*) FROM session") == before);
    }
}

TEST_CASE("a file that says otherwise how ticks are written is not merged") {
    const LabFiles lab;
    const std::string wrong = lab.with("UPDATE trace_column SET scale = 2 * scale WHERE codec = 1");
    const std::string all = lab.folder.file("all.sqlite");
    for (const Words& words : {Words{"merge", all, lab.clean, wrong},
                               {"merge", all, wrong},
                               {"merge", wrong, lab.clean}}) {
        check_end(palpate_command(words), 1,
                  Has(wrong + ": its trace_column is not how ticks are written", "from before"));
        CHECK_FALSE(std::filesystem::exists(all));
    }
}

TEST_CASE("no table, order or reference of a lab's is in the way of a command") {
    const LabFiles files;
    const std::string page = files.folder.file("r.html");
    const std::string shared = files.folder.file("shared");
    for (const auto& row : test_rows("edits/lab_tables.tsv")) {
        const std::string& sql = row.at(0);
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
        if (row.at(1).empty()) {
            continue;
        }
        // What cannot be done is said by name, and nothing is half done.
        const std::string before = lab_sqlite(file, ".dump");
        const Finished done =
            palpate_command({"participant", file, "demo", "--destroy", "everything", "--yes"});
        CAPTURE(sql, done.out, done.error);
        CHECK(done.code != 0);
        CHECK_THAT(done.error, Has(row.at(1)));
        CHECK(lab_sqlite(file, ".dump") == before);
    }
}

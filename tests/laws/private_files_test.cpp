#include "tests/support/program.hpp"

// What the program leaves behind for others to read, and how it is built.

TEST_CASE("whatever is written with participants' codes is its owner's alone") {
    const TemporaryFolder folder;
    const std::string file = run_by({"P1"}, kFourTrials, folder.file("d.sqlite"));
    const auto others_read = [&](const Words& words, const std::string& made) {
        CAPTURE(words, made);
        ran(words);
        using std::filesystem::perms;
        return (std::filesystem::status(folder.file(made)).permissions() &
                (perms::group_all | perms::others_all)) != perms::none;
    };
    const std::string page = folder.file("codes.html");
    const std::string script = folder.file("codes.R");
    const std::string out = folder.file("codes");
    CHECK_FALSE(others_read({"report", file, "--kind", "simulated", "--keep-codes", "-o", page},
                            "codes.html"));
    CHECK_FALSE(others_read(
        {"stats", file, "--kind", "simulated", "--keep-codes", "--emit-r", script}, "codes.R"));
    CHECK_FALSE(
        others_read({"export", file, "--kind", "simulated", "--keep-codes", "-o", out}, "codes"));
    for (const auto& entry : std::filesystem::recursive_directory_iterator(out)) {
        CAPTURE(entry.path());
        CHECK((entry.is_directory() ||
               (entry.status().permissions() & std::filesystem::perms::others_all) ==
                   std::filesystem::perms::none));
    }
    CHECK_THAT(slurp(page), Has("P1"));
    CHECK_FALSE(
        others_read({"report", file, "--trial", "1", "--keep-codes", "-o", page}, "codes.html"));
    CHECK(
        others_read({"export", file, "--kind", "all", "-o", folder.file("out")}, "out/trials.csv"));
}

TEST_CASE("a link that somebody laid leads to no file of theirs") {
    const TemporaryFolder folder;
    const std::string victim = folder.file("victim");
    std::ofstream(victim) << "theirs";
    const auto finished = [&](const std::string& command) {
        ended(shell("export SDL_VIDEODRIVER=dummy; " + command, folder.path()));
        CHECK(slurp(victim) == "theirs");
    };
    // A name that can be foretold: the process's number is the shell's.
    finished("ln -s victim d.sqlite.$$.part; exec \"$0\" run '" + kFourTrials +
             "' --participant P1 --headless --db d.sqlite");
    finished("ln -s victim r.html.$$.part; exec \"$0\" report d.sqlite --trial 1 -o r.html");
    std::filesystem::create_directory(folder.file("screens"));
    finished(
        "ln -s ../nobody screens/end.png; exec \"$0\" screenshots --protocol pilot -o screens");
    CHECK_FALSE(std::filesystem::exists(folder.file("nobody")));
    CHECK_FALSE(std::filesystem::is_symlink(folder.file("screens/end.png")));
}

TEST_CASE("an export says of what was noted afterwards no time since the first trial") {
    const TemporaryFolder folder;
    const std::string file = run_by({"P1"}, kFourTrials, folder.file("d.sqlite"));
    ran({"mark", file, "2", "--invalid", "slept"});
    ran({"note", file, "slept", "--participant", "P1"});
    ran({"export", file, "--kind", "simulated", "-o", folder.file("out")});
    auto rows = lines_in(slurp(folder.file("out/events.csv")));
    REQUIRE_THAT(rows.at(0), Has(",event_kind,mark_undone,text,since_first_ns,"));
    rows.erase(rows.begin());
    int late = 0;
    for (const std::string& row : rows) {
        CAPTURE(row);
        if (row.find(",mark,0,,,") != std::string::npos ||
            row.find(",note,,,,") != std::string::npos) {
            ++late;
        } else {
            CHECK((row.find(",mark,") == std::string::npos &&
                   row.find(",note,") == std::string::npos));
        }
    }
    CHECK(late == 2);
}

#if defined(NDEBUG) && !defined(PALPATE_SANITIZED)
TEST_CASE("the program is built for files of strangers: canaries, checked copies, bound at once") {
    const Finished dynamic = Process({"readelf", "-d", palpate_program()}).wait();
    CHECK(dynamic.code == 0);
    CHECK_THAT(dynamic.out, Has("BIND_NOW", "PIE"));
    const Finished symbols = Process({"readelf", "--dyn-syms", "-W", palpate_program()}).wait();
    CHECK_THAT(symbols.out, Has("__stack_chk_fail", "_chk@GLIBC"));
}
#endif

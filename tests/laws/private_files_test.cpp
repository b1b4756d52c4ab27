#include "tests/support/program.hpp"

// What the program leaves behind for others to read, what it writes over, and how it is built.

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

TEST_CASE("a command writes over nothing but what it wrote itself, whatever has that name") {
    const TemporaryFolder folder;
    const auto f = [&](const char* name) {
        return folder.file(name);
    };
    const std::string database = f("d.sqlite");
    ran({"simulate", kFourTrials, "--participants", "2", "--no-traces", "--db", database});
    write(f("p.toml"), slurp(kFourTrials));
    write(f("nm.csv"), "stimulus,n,k\n1,10,2\n2,10,5\n3,10,9\n");
    write(f("notes.txt"), "t_s, and what else I saw\n<svgs> are drawings\n");
    write(f("drawn.svg"), "<?xml version=\"1.0\"?>\n<svg><title>by hand</title></svg>\n");
    write(f("t.csv"), "t_s,x_m,y_m\n0,0.05,0\n0.001,0.02,0\n");
    write(f("xy.csv"), "x_m,y_m\n0.05,0\n");
    write(f("s.toml"), test_text("scenes/line.toml"));
    write(f("proc.toml"), test_text("procedures/quest_of_ten.toml"));
    write(f("r.csv"), "response\n1\n1\n0\n");

    const std::vector<Words> commands{
        {"fit", f("nm.csv"), "--bootstrap", "0", "--svg"},
        {"power", f("p.toml"), "--effect", "-1", "--participants", "3", "--studies", "20",
         "--hands", "1", "--svg"},
        {"check", f("p.toml"), "--svg"},
        {"report", database, "--kind", "simulated", "--simulations", "0", "-o"},
        {"render", f("s.toml"), f("t.csv"), "-o"},
        {"closest", f("s.toml"), f("xy.csv"), "-o"},
        {"procedure", f("proc.toml"), f("r.csv"), "-o"},
        {"calibrate", "--device", "sim", "--mark", "0,0", "-o"},
    };
    const auto names = folder.names();
    for (const auto& command : commands) {
        for (const std::string& name : names) {
            CAPTURE(command.front(), name);
            const std::string before = slurp(f(name.c_str()));
            refused(joined(command, {f(name.c_str())}), name + " is there already and is not what");
            CHECK(slurp(f(name.c_str())) == before);
        }
        CHECK(folder.names() == names);
    }
    for (const auto& command : commands) {
        if (command.front() == "calibrate") {
            continue;  // asks at the keyboard
        }
        const TemporaryFolder made;
        // an empty file is nobody's
        const Words words = joined(command, {write(made.file("out"), "")});
        ran(words);
        const std::string text = slurp(made.file("out"));
        CHECK(!text.empty());
        ran(words);
        CHECK(slurp(made.file("out")) == text);
    }
}

TEST_CASE("a file that cannot be made is refused with what the system says of it") {
    const TemporaryFolder folder;
    write(folder.file("file"), "");
    for (const auto& [place, why] :
         {std::pair{folder.file("none/o.svg"), "No such file or directory"},
          std::pair{folder.file("file/o.svg"), "Not a directory"},
          std::pair{std::string("/proc/o.svg"), "No such file or directory"}}) {
        check_end(palpate_command({"check", "shape_friction_demo", "--svg", place}), 1,
                  Has(place + ": cannot be written: " + why));
    }
    CHECK(folder.names() == Words{"file"});
}

TEST_CASE("figures write all of their files or none where somebody's table has the name of one") {
    const TemporaryFolder folder;
    write(folder.file("fig_3_2_2.svg"), "mine\n");
    CHECK_THAT(ran({"figures", "-o", folder.path().string()}, 2).error,
               Has("fig_3_2_2.svg is there already"));
    CHECK(folder.names() == Words{"fig_3_2_2.svg"});
}

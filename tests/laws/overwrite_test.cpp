#include "tests/support/program.hpp"

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

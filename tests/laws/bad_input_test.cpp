#include "tests/support/program.hpp"
#include "tests/support/short_text.hpp"

TEST_CASE("a wrong protocol file gets place, value and remedy, exit code 2, nothing is created") {
    for (const auto& row : test_rows("wrong_demo.tsv")) {
        CAPTURE(row);
        const TemporaryFolder folder;
        write(folder.file("p.toml"), short_text("shape_friction_demo", {{row.at(0), row.at(1)}}));
        CHECK_THAT(
            ran(run_words(folder.file("p.toml"), "P1", folder.file("d.sqlite"), {"--headless"}), 2)
                .error,
            Catch::Matchers::Matches("(?:[^:\n]*p\\.toml:[0-9]+:[0-9]+: .+\n)+",
                                     Catch::CaseSensitive::Yes) &&
                Has(row.at(2)));
        CHECK(folder.names() == Words{"p.toml"});
    }
}

TEST_CASE("wrong words on the command line get a sentence and exit code 2, and create nothing") {
    const TemporaryFolder folder;
    const std::map<std::string, std::string> meant{
        {"{db}", folder.file("d.sqlite")},
        {"{out}", folder.file("out")},
        {"{study}", kFourTrials},
        {"{gantry}", PALPATE_SOURCE_DIR "/examples/gantry.toml"},
        {"{name}", "Jane Doe"}};
    for (const auto& row : test_rows("wrong_words.tsv")) {
        CAPTURE(row);
        const Finished run = ran(words_of("", row.at(0), meant), 2);
        CHECK_THAT(run.error + run.out, Has(row.at(1)));
        CHECK(folder.names().empty());
    }
}

TEST_CASE("a font that does not open is refused before anything is made") {
    const TemporaryFolder folder;
    const std::string text = folder.file("text");
    write(text, "no font\n");
    for (const std::string& font : {folder.file("absent.ttf"), text}) {
        for (const Words& words : {run_words("pilot", "P1", folder.file("d.sqlite")),
                                   Words{"demo", "--db", folder.file("d.sqlite")},
                                   Words{"screenshots", "-o", folder.file("o")}}) {
            CHECK_THAT(ran(joined(words, {"--font", font}), 2).error,
                       Has("--font " + font + ": ",
                           font == text ? "give a TrueType file" : "no such file") &&
                           !Has("headless"));
            CHECK(folder.names() == Words{"text"});
        }
    }
}

TEST_CASE("what is no finite number is refused by every word that takes one") {
    const TemporaryFolder folder;
    const std::vector<Words> commands{
        {"commission", "-o", folder.file("r.toml"), "--handle-g"},
        run_words("pilot", "P1", folder.file("d.sqlite"), {"--headless", "--spin"}),
        run_words("pilot", "P1", folder.file("d.sqlite"), {"--headless", "--speed"}),
        {"haply-emulator", "--delay-ms"},
        {"doctor", "--seconds"}};
    for (Words words : commands) {
        for (const char* number : {"nan", "inf", "-nan", "1e999"}) {
            words.push_back(number);
            ran(words, 2);
            words.pop_back();
        }
    }
    for (const char* command : {"run", "demo", "power", "sequence", "simulate", "fit", "stats"}) {
        CHECK_THAT(ran({command, "--help"}).out,
                   Has("--seed UINT:UINT in [0 - 9223372036854775807]"));
        for (const std::string seed : {"-1", "", "9223372036854775808", "1.5"}) {
            CAPTURE(command);
            CHECK_THAT(ran({command, "--seed", seed}, 2).error,
                       Has(fmt::format("--seed: \"{}\" is no whole number from 0 to "
                                       "9223372036854775807",
                                       seed)));
        }
    }
    for (const std::string trial : {"", "9223372036854775808", "1.5"}) {
        for (const Words& command : {Words{"trace", "study.sqlite", trial},
                                     {"mark", "study.sqlite", trial, "--invalid", "why"}}) {
            CHECK_THAT(ran(command, 2).error,
                       Has(fmt::format("TRIAL: \"{}\" is no whole number", trial)));
        }
    }
    CHECK(std::filesystem::is_empty(folder.path()));
}

TEST_CASE("a replay of a file that is not there is said before anything is created") {
    const TemporaryFolder folder;
    const Finished run = palpate_command(
        run_words("shape_friction_demo", "P1", folder.file("d.sqlite"),
                  {"--headless", "--device", "replay:" + folder.file("absent.sqlite")}));
    CHECK(run.code != 0);
    CHECK_THAT(run.error, Has("absent.sqlite"));
    CHECK(folder.names().empty());
}

TEST_CASE("help and version go to standard output with exit code 0") {
    ran({"--help"});
    CHECK_THAT(palpate_command({"--help"}).out, Has("run", "demo", "summary"));
    CHECK_THAT(palpate_command({"--version"}).out, Has("palpate "));
}

TEST_CASE("a finished session is not run again by mistake") {
    const TemporaryFile file("d.sqlite");
    const Words words = run_words("shape_friction_demo", "P1", file, {"--headless"});
    ran(words);
    CHECK_THAT(ran(words, 2).error, Has("--session 2"));
    ran(joined(words, {"--session", "2"}));
}

TEST_CASE("a session number that leaves a gap is refused, unless the others are in another file") {
    const TemporaryFolder folder;
    const auto run = [&](Words more) {
        Words words =
            run_words("shape_friction_demo", "P1", folder.file("d.sqlite"), {"--headless"});
        words.insert(words.end(), more.begin(), more.end());
        return palpate_command(words);
    };
    const Finished first = run({"--session", "2"});
    check_end(first, 2, Has("no session of shape_friction_demo so far", "give --session 1"));
    CHECK(folder.names().empty());
    CHECK(run({"--session", "1"}).code == 0);
    const Finished far = run({"--session", "5"});
    check_end(far, 2, Has("sessions up to 1", "give --session 2, or --elsewhere"));
    CHECK(run({"--session", "2"}).code == 0);
    CHECK(run({"--session", "5", "--elsewhere"}).code == 0);
}

TEST_CASE("a trial or an interval that is not there is a wrong word: exit code 2") {
    const TemporaryFolder folder;
    const std::string file = run_by({"P1"}, "shape_friction_demo", folder.file("d.sqlite"));
    for (const Words& words : {Words{"trace", file, "999"},
                               {"trace", file, "1", "--interval", "2"},
                               {"mark", file, "999", "--invalid", "x"},
                               {"note", file, "x", "--participant", "P1", "--session", "7"},
                               {"participant", file, "P7"},
                               run_words("shape_friction_demo", "P2", folder.file("e.sqlite"),
                                         {"--headless", "--device", "replay:" + file + ":999"})}) {
        CAPTURE(words);
        const Finished wrong = ran(words, 2);
        CHECK(wrong.out.empty());
        CHECK_THAT(wrong.error, Has("7") || Has("999") || Has("no interval 2: give 1") ||
                                    Has("no such session"));
    }
    CHECK_FALSE(std::filesystem::exists(folder.file("e.sqlite")));
}

TEST_CASE("a session goes on to its end when nobody reads what it prints") {
    const TemporaryFolder folder;
    const std::string file = folder.file("d.sqlite");
    // A pipe whose reader is gone from the start, for both kinds of output.
    const std::string kind = GENERATE("real", "pilot");
    CHECK_THAT(palpate_command(run_words("shape_friction_demo", "P1", folder.file("said.sqlite"),
                                         {"--headless", "--kind", kind}))
                   .error,
               Has("recorded as simulated, not " + kind));
    const Finished alone =
        Process({"sh", "-c", R"(mkfifo "$1"; exec 4<>"$1" 5>"$1" 4<&-; shift; exec "$@" >&5 2>&5)",
                 "sh", folder.file("pipe"), palpate_program(), "run", "shape_friction_demo",
                 "--participant", "P1", "--db", file, "--headless", "--kind", kind},
                {"DISPLAY", "WAYLAND_DISPLAY", "SDL_VIDEODRIVER"})
            .wait();
    CHECK(alone.code == 0);
    const Finished answers =
        Process({"sqlite3", file,
                 "SELECT count(*), min(outcome), max(outcome), (SELECT finished FROM session)"
                 " FROM trial"})
            .wait();
    CHECK(answers.out == "10|complete|complete|1\n");
    ran({"verify", file});
}

TEST_CASE(
    "a database that is somebody else's, or has no name, is a wrong word: exit code 2, untouched") {
    const TemporaryFolder folder;
    const std::string file = folder.file("letters.txt");
    std::ofstream(file) << "Dear participant, thank you for coming.\n";
    for (const std::string& name : {file, std::string()}) {
        CAPTURE(name);
        CHECK_THAT(ran(run_words("shape_friction_demo", "P1", name, {"--headless"}), 2).error,
                   Has(name.empty() ? "empty" : "not a palpate database"));
        CHECK(folder.names() == Words{"letters.txt"});
    }
    std::ifstream in(file);
    std::string line;
    std::getline(in, line);
    CHECK(line == "Dear participant, thank you for coming.");
}

TEST_CASE("a word that nobody knows is named, with the one that is meant, and nothing is made") {
    const TemporaryFolder folder;
    const std::string db = folder.file("d.sqlite");
    for (const auto& row : test_rows("mistyped.tsv")) {  // words, what is said, and what is meant
        CAPTURE(row);
        const Finished run =
            ran(words_of("", row.at(0), {{"{db}", db}, {"{new}", folder.file("x.toml")}}), 2);
        CHECK_THAT(run.error, Has(row.at(1)));
        if (!row.at(2).empty()) {
            CHECK_THAT(run.error, Has("did you mean " + row.at(2) + "?"));
        }
        CHECK_THAT(run.error, !Has("is required"));
        CHECK(folder.names().empty());
    }
    std::ofstream(folder.file("mine.toml")) << "format = 1\n";
    CHECK_THAT(palpate_command({"check", folder.file("mien.toml")}).error,
               Has("did you mean mine.toml?"));
    ran({"demo", "--headless", "--db", db});
    CHECK_THAT(palpate_command({"sql", db, "-c", ".tabels"}).error,
               Has("no word .tabels: did you mean .tables?"));
    CHECK_THAT(palpate_command({"sql", db, "-c", ".columns trail"}).error,
               Has("no table or view trail: did you mean trial?"));
}

TEST_CASE("a code much like one that is there is asked about, and nobody is made of a slip") {
    const TemporaryFile db("d.sqlite");
    const auto run = [&](Words words) {
        words.insert(words.begin(),
                     {"run", "shape_friction_demo", "--headless", "--db", db, "--participant"});
        return palpate_command(words);
    };
    const auto people = [&] {
        return sql_csv(db, "SELECT group_concat(participant_code) FROM participant");
    };
    REQUIRE(run({"P03"}).code == 0);
    for (const char* code : {"p03", "P3", "P-03", "P_3", "p0-03"}) {
        CAPTURE(code);
        check_end(run({code}), 2,
                  Has(std::string("nobody is called ") + code + ", and P03 is there", "--another"));
        CHECK_THAT(ran({"participant", db, code, "--new"}, 2).error, Has("P03 is there"));
        CHECK_THAT(palpate_command({"participant", db, code}).error, Has("P03 is there"));
        CHECK_THAT(palpate_command({"note", db, "seen", "--participant", code}).error,
                   Has("did you mean P03?"));
        CHECK_THAT(
            palpate_command({"sequence", "shape_friction_demo", "--db", db, "--participant", code})
                .error,
            Has("P03 is there"));
    }
    CHECK_THAT(people(), Has("\nP03\n"));
    for (const char* other : {"P04", "P30", "P031", "P13"}) {  // plainly somebody else
        CAPTURE(other);
        ran({"participant", db, other, "--new"});
    }
    CHECK(run({"p03", "--another"}).code == 0);
    ran({"participant", db, "P3", "--new", "--another"});
    CHECK(run({"p03", "--session", "2"}).code == 0);  // known by now
    CHECK_THAT(people(), Has("p03", "P3"));
}

TEST_CASE(
    "what a full disk keeps from standard output is no success, and a pipe that was closed is") {
    const TemporaryFile data("fit.csv");
    std::ofstream(data) << "stimulus,n,k\n-1,40,9\n0,40,21\n1,40,30\n";
    for (const std::string& words : {std::string("sequence shape_friction_demo --participant P1"),
                                     std::string("check shape_friction_demo"), "fit '" + data + "'",
                                     "fit --json '" + data + "'", std::string("--version")}) {
        CAPTURE(words);
        const auto run = [&](const std::string& where) {
            return Process({"bash", "-o", "pipefail", "-c",
                            "'" + palpate_program() + "' " + words + where})
                .wait();
        };
        check_end(run(" >/dev/full"), 1, Has("standard output: cannot be written"));
        CHECK(run(" | true").error.find("cannot be written") == std::string::npos);
    }
}

TEST_CASE("a file that may not grow is as a full disk: a sentence, and nothing half-made") {
    const TemporaryFolder folder;
    const std::string file = run_by({"P1"}, "shape_friction_demo", folder.file("a.sqlite"));
    const std::string simulate = "simulate shape_friction_demo --db s.sqlite --participants ";
    const std::string run = "run shape_friction_demo --participant P2 --headless --db r.sqlite";
    const auto limited = [](const TemporaryFolder& made, int kilobytes, const std::string& words) {
        return shell(fmt::format("ulimit -f {} && \"$0\" {}", kilobytes, words), made.path());
    };
    const TemporaryFolder made;
    for (const std::string& words : {"export '" + file + "' --kind all --traces -o out",
                                     "merge all.sqlite '" + file + "'", simulate + "9", run}) {
        CAPTURE(words);
        const Finished end = ended(limited(made, 200, words), 1);
        CHECK(lines_in(end.error).back().starts_with("palpate: "));
        for (const std::string& name : made.names()) {
            CAPTURE(name);
            CHECK((name.starts_with("r.sqlite") || name.starts_with("s.sqlite")));
        }
    }
    // Where not even the tables of a new file find room there is no file.
    for (const std::string& words : {std::string("participant p.sqlite P1 --new"),
                                     "merge m.sqlite '" + file + "'", simulate + "1", run}) {
        CAPTURE(words);
        const TemporaryFolder empty;
        check_end(limited(empty, 8, words), 1, Has("the disk"));
        CHECK(empty.names().empty());
    }
}

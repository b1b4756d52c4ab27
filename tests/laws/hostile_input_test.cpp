#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include "protocols/library/shipped.hpp"
#include "data/store/database.hpp"
#include "tests/support/program.hpp"
#include "tests/support/scene_text.hpp"

using Catch::Matchers::Matches;

namespace {

std::string times(std::size_t n, const std::string& text) {
    return fmt::format("{}", fmt::join(Words(n, text), ""));
}

/// A TOML text of `levels` in one another, in one of the ways that TOML has.
std::string deep(int way, std::size_t levels) {
    switch (way) {
        case 0:
            return "a" + times(levels, ".a") + " = 1\n";
        case 1:
            return "[a" + times(levels, ".a") + "]\n";
        case 2:
            return "[[a" + times(levels, ".'a'") + "]]\n";
        case 3:
            return "a = " + times(levels, "[") + times(levels, "]") + "\n";
        case 4:
            return "a = " + times(levels, "{a = ") + "1" + times(levels, "}") + "\n";
        default:  // after strings that look as if they did not end
            return "a = \"\\\"\" # \"\nb = '''\n'\"\"\"'''\n\"c\\\"\" = \"\"\"\n\"\\\"\"\"\"\n" +
                   deep(0, levels);
    }
}

/// Every command that reads TOML of its user.
std::vector<Words> readers(const std::string& toml, const std::string& csv) {
    return {{"check", toml},
            {"render", toml, csv},
            {"closest", toml, csv},
            {"deform", toml, "--times", "0.1"},
            {"procedure", toml, csv},
            {"calibrate", "--preset", toml, "-o", toml + ".out"},
            {"haply-emulator", "--preset", toml},
            {"screenshots", "--protocol", toml, "-o", toml + ".out"},
            {"sequence", toml, "--participant", "P1"}};
}

}  // namespace

TEST_CASE("TOML of any depth is refused at its place by every command that reads some") {
    EACH(way, range(0, 6));
    const TemporaryFolder folder;
    const std::string file = folder.file("p.toml");
    write(folder.file("p.csv"), "t_s,x_m,y_m\n0,0,0\n");
    write(file, deep(way, 15'000));
    const std::string place = way == 5 ? "6" : "1";
    for (const Words& words : readers(file, folder.file("p.csv"))) {
        CAPTURE(words);
        CHECK_THAT(ran(words, 2).error,
                   Matches(".*p\\.toml:" + place + ":[0-9]+: more than 16 levels.*\n",
                           Catch::CaseSensitive::Yes));
    }
    CHECK(folder.names() == Words{"p.csv", "p.toml"});
    write(file, deep(way, 14));  // which is only not what the file may say
    CHECK_THAT(palpate_command({"check", file}).error, !Has("levels"));
}

TEST_CASE("a database whose protocol is deep or long ends no command by a signal") {
    const TemporaryFolder folder;
    const std::string db = run_by({"P1"}, "shape_friction_demo", folder.file("d.sqlite"));
    const std::string text = GENERATE(deep(0, 15'000), "a = '" + times(5'000'000, "x") + "'\n");
    {
        data::Database database(db, data::Access::write);
        for (const char* trigger : {"study_is_kept", "study_stays"}) {
            database.execute(fmt::format("DROP TRIGGER IF EXISTS {}", trigger).c_str());
        }
        auto change = database.first("UPDATE study SET protocol_toml = ?1", text);
    }
    int number = 0;
    for (Words words : {Words{"verify", db},
                        {"summary", db},
                        {"sql", db, "-c", "SELECT avg(rendered_normal_n) FROM sample"},
                        {"trace", db, "1"},
                        {"export", db, "--kind", "all", "--traces", "-o"},
                        {"merge", "", db},
                        {"run", "shape_friction_demo", "--participant", "P2", "--headless",
                         "--device", "replay:" + db, "--db"},
                        {"note", db, "seen", "--participant", "P1"}}) {
        const std::string other = folder.file(fmt::format("other{}", ++number));
        words = words[0] == "merge" ? Words{"merge", other, db} : words;
        if (words.back() == "-o" || words.back() == "--db") {
            words.push_back(other);
        }
        CAPTURE(words);
        const Finished done = palpate_command(words);
        CAPTURE(done.error);
        CHECK(done.code <= 2);
        CHECK((done.code == 0 || done.error.size() + done.out.size() > 10));
        CHECK(done.error.size() < 1'000);
    }
    ran({"verify", db}, 1);
}

TEST_CASE("what is no file is refused as a database by every command, at once") {
    const TemporaryFolder folder;
    const std::string pipe = folder.file("pipe");
    const std::string plug = folder.file("plug");
    REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    plug.copy(address.sun_path, sizeof address.sun_path - 1);
    const int socket_of = socket(AF_UNIX, SOCK_DGRAM, 0);
    REQUIRE(bind(socket_of, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
    const std::string out = folder.file("out");
    for (const std::string& db : {pipe, plug, std::string("/dev/zero"), folder.path().string()}) {
        for (const Words& row : test_rows("database_commands.tsv")) {
            const Words words = words_of("", row.at(0), {{"{db}", db}, {"{out}", out}});
            CAPTURE(words);
            CHECK_THAT(ran(words, 2).error,
                       Matches(".*: this is a (folder|pipe|socket|device), no file: .*\n",
                               Catch::CaseSensitive::Yes));
        }
    }
    close(socket_of);
    CHECK(folder.names() == Words{"pipe", "plug"});
}

TEST_CASE("a pipe beside a database, as an output or as a font makes nobody wait") {
    const TemporaryFolder folder;
    const std::string db = folder.file("d.sqlite");
    ran({"demo", "--headless", "--db", db});
    CHECK_THAT(palpate_command({"merge", "/dev/zero", db}).error, Has("this is a device, no file"));
    for (const std::string& beside : {db + "-wal", db + "-journal", folder.file("pipe")}) {
        std::filesystem::remove(beside);
        REQUIRE(mkfifo(beside.c_str(), 0600) == 0);
    }
    CHECK_THAT(palpate_command({"summary", db}).error, Has("this is a pipe, no file"));
    const std::string pipe = folder.file("pipe");
    CHECK_THAT(ran({"check", "shape_friction_demo", "--svg", pipe}, 1).error,
               Has("cannot be written"));
    CHECK_THAT(ran({"screenshots", "--font", pipe, "-o", folder.file("o")}, 2).error,
               Has("there is no such file"));
    // What comes through a pipe is read: <(...) of a shell is one. What never ends is not.
    ended(shell("\"$0\" check <(cat " PALPATE_SOURCE_DIR "/protocols/library/stress.toml)"));
    CHECK_THAT(palpate_command({"check", "/dev/zero"}).error, Has("is longer than"));
    check_end(palpate_command({"check", pipe}), 2,  // takes its 10 s of patience
              Has("pipe:1:1: cannot be read: nothing has come out"));
}

TEST_CASE("a hand that is too far away is refused at its place, whatever the scene") {
    const TemporaryFolder folder;
    const std::string scene = folder.file("s.toml");
    const bool plane = GENERATE(true, false);
    write(scene, plane ? line_text({0.0, 0.0}, {0.1, 0.0})
                       : plate_text({{0.0, 0.0, 0.0}, {0.0, 0.1, 0.0}},
                                    {{0.1, 0.0, 0.0}, {0.1, 0.1, 0.0}}));
    const std::string z = plane ? "" : ",0";
    for (const char* far : {"1e155", "-1e155", "1e308", "1.7976931348623157e308", "1000001"}) {
        CAPTURE(far);
        write(folder.file("q.csv"), fmt::format("x_m,y_m{0}\n0.05,{1}{2}\n{3},0.001{2}\n",
                                                plane ? "" : ",z_m", "0.01", z, far));
        CHECK_THAT(ran({"closest", scene, folder.file("q.csv")}, 2).error,
                   Has("q.csv:3: x_m is ", "give metres from"));
        write(folder.file("t.csv"),
              fmt::format("t_s,x_m,y_m{0}\n0,0.05,0.01{1}\n0.001,0.05,{2}{1}\n",
                          plane ? "" : ",z_m", z, far));
        CHECK_THAT(ran({"render", scene, folder.file("t.csv")}, 2).error, Has("t.csv:3: y_m is "));
    }
    // The farthest that is let in, and numbers too small to be squared, get the right answer.
    for (const char* far : {"1e6", "1e-300", "5e-324", "-5e-324", "-1e6"}) {
        CAPTURE(far);
        write(folder.file("q.csv"),
              fmt::format("x_m,y_m{}\n{},0.05{}\n", plane ? "" : ",z_m", far, z));
        const Finished closest = ran({"closest", scene, folder.file("q.csv")});
        const double x = std::strtod(far, nullptr) > 1.0 ? 0.1 : 0.0;
        const double distance = std::hypot(std::strtod(far, nullptr) - x, plane ? 0.05 : 0.0);
        const auto row = csv_records(closest.out).at(0);
        CHECK(std::stod(row.at("distance_m")) == Approx(distance).margin(1e-12));
    }
    write(scene, line_text({0.0, 0.0}, {0.1, 1e155}));
    CHECK_THAT(palpate_command({"closest", scene, folder.file("q.csv")}).error,
               Has("s.toml:4:8: to_m holds 1e+155"));
}

TEST_CASE("the numbers of a scene have an end, and up to there its forces are finite") {
    const TemporaryFolder folder;
    const std::string scene = folder.file("s.toml");
    write(folder.file("p.csv"), "t_s,x_m,y_m\n0,0.02,0.01\n0.001,0.03,-0.09\n0.002,0.05,-0.1\n");
    const std::map<std::string, std::string> largest{{"stiffness_n_per_m", "[renderer]"},
                                                     {"damping_n_s_per_m", "[renderer]"},
                                                     {"viscous_n_s_per_m", "[friction]"},
                                                     {"bristle_damping_n_s_per_m", "[friction]"},
                                                     {"tangential_stiffness_n_per_m", "[friction]"},
                                                     {"stribeck_speed_m_per_s", "[friction]"}};
    const auto rendered = [&](const std::string& value, int code) {
        for (const auto& [key, table] : largest) {
            CAPTURE(key, value);
            std::string text = "[renderer]\n[friction]\nlaw = \"lugre\"\nmu_s = 0.7\nmu_d = 0.5\n" +
                               line_text({0.0, 0.0}, {0.1, 0.0});
            text.insert(text.find(table) + table.size(), fmt::format("\n{} = {}", key, value));
            write(scene, text);
            const Finished felt = ran({"render", scene, folder.file("p.csv")}, code);
            if (code == 0) {
                CHECK_THAT(felt.out, HasNone("inf", "nan") && Has(",S"));
            } else {
                CHECK_THAT(felt.error, Has(key + " is ", "1000000000"));
            }
        }
    };
    rendered("1e9", 0);
    rendered("1.1e9", 2);
    rendered("1e308", 2);
}

TEST_CASE("seeded nonsense of up to a megabyte ends in a sentence, never in a signal") {
    const TemporaryFolder folder;
    const std::string file = folder.file("p.toml");
    write(folder.file("p.csv"), "t_s,x_m,y_m\n0,0,0\n");
    const Words parts = split(
        "[|]|{|}|.|=|,|\n|\"|'|a|\\|#|[[|]]|\"\"\"|'''|1e9|-|nan|[design]\n|a.|\xff|\x1b[|\r\n|a = "
        "|[[object]]\n|points_m = [[0, 0]]\n",
        '|');
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
        CAPTURE(seed);
        Random random(seed);
        std::string text = seed % 2 == 0
                             ? std::string()
                             : std::string(protocols::shipped_protocols()[seed % 3].text);
        const auto size = static_cast<std::size_t>(random.decade(2.0, 6.0));
        while (text.size() < size) {
            const std::string& part = parts[random.index(parts.size())];
            text += random.below(6) == 0
                      ? times(static_cast<std::size_t>(random.decade(0.0, 4.5)), part)
                      : part;
        }
        write(file, text);
        const auto all = readers(file, folder.file("p.csv"));
        for (const std::size_t which : {std::size_t{0}, 1 + seed % (all.size() - 1)}) {
            CAPTURE(all[which]);
            const Finished done = palpate_command(all[which]);
            CAPTURE(done.error);
            CHECK((done.code == 2 || (done.code == 0 && text.size() < 20'000)));
            CHECK((done.code == 0 || !done.error.empty()));
            CHECK(done.error.find('\x1b') == std::string::npos);
        }
    }
}

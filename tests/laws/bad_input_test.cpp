#include <filesystem>
#include <fstream>

#include "protocols/library/shipped.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/process.hpp"

using namespace palpate;
using Catch::Matchers::ContainsSubstring;
using tests::Finished;
using tests::palpate_command;
using tests::TemporaryFolder;

namespace {

/// The demo protocol with one text replaced.
std::string edited(const std::string& from, const std::string& to) {
    for (const auto& one : protocols::shipped_protocols()) {
        if (one.name == "shape_friction_demo") {
            std::string text(one.text);
            const std::size_t at = text.find(from);
            REQUIRE(at != std::string::npos);
            return text.replace(at, from.size(), to);
        }
    }
    return {};
}

}  // namespace

TEST_CASE("a wrong protocol file gets place, value and remedy, exit code 2, nothing is created",
          "[cli][law]") {
    struct Wrong {
        const char *from, *to, *value;
    };
    for (const Wrong& wrong :
         {Wrong{"repetitions = 1", "repetitons = 1", "repetitions"},
          Wrong{"rate_hz = 1000", "rate_hz = 100", "100"},
          Wrong{"rate_hz = 1000", "rate_hz = \"fast\"", "rate_hz"},
          Wrong{"mu_s = 0.7", "mu_s = 0.3", "0.3"}, Wrong{"[timing]", "[timing", "table"},
          Wrong{"max_run_object = 2", "max_run_object = -1", "-1"}}) {
        CAPTURE(wrong.to);
        const TemporaryFolder folder;
        std::ofstream(folder.file("p.toml")) << edited(wrong.from, wrong.to);
        const Finished run = palpate_command({"run", folder.file("p.toml"), "--participant", "P1",
                                              "--db", folder.file("d.sqlite"), "--headless"});
        CAPTURE(run.error);
        CHECK(run.code == 2);
        CHECK_THAT(run.error, Catch::Matchers::Matches("(?:[^:\n]*p\\.toml:[0-9]+:[0-9]+: .+\n)+",
                                                       Catch::CaseSensitive::Yes) &&
                                  ContainsSubstring(wrong.value));
        CHECK(folder.names() == std::vector<std::string>{"p.toml"});
    }
}

TEST_CASE("wrong words on the command line get a sentence and exit code 2, and create nothing",
          "[cli][law]") {
    const TemporaryFolder folder;
    const std::string db = folder.file("d.sqlite");
    struct Wrong {
        std::vector<std::string> words;
        const char* says;
    };
    for (const Wrong& wrong :
         {Wrong{{}, "subcommand"}, Wrong{{"fly"}, "fly"}, Wrong{{"run"}, "PROTOCOL"},
          Wrong{{"run", "nothing.toml", "--participant", "P1", "--db", db}, "nothing.toml"},
          Wrong{{"run", "shape_friction_demo", "--participant", "Jane Doe", "--db", db},
                "Jane Doe"},
          Wrong{{"run", "shape_friction_demo", "--participant", "P1", "--db", db, "--device",
                 "haptic"},
                "sim, mouse"},
          Wrong{{"run", "shape_friction_demo", "--participant", "P1", "--db", db, "--device",
                 "mouse"},
                "display"},
          Wrong{
              {"run", "shape_friction_demo", "--participant", "P1", "--db", db, "--kind", "maybe"},
              "maybe"}}) {
        CAPTURE(wrong.words);
        const Finished run = palpate_command(wrong.words);
        CAPTURE(run.error);
        CHECK(run.code == 2);
        CHECK_THAT(run.error + run.out, ContainsSubstring(wrong.says));
        CHECK(folder.names().empty());
    }
}

TEST_CASE("a replay of a file that is not there is said before anything is created", "[cli]") {
    const TemporaryFolder folder;
    const Finished run = palpate_command({"run", "shape_friction_demo", "--participant", "P1",
                                          "--db", folder.file("d.sqlite"), "--headless", "--device",
                                          "replay:" + folder.file("absent.sqlite")});
    CHECK(run.code != 0);
    CHECK_THAT(run.error, ContainsSubstring("absent.sqlite"));
    CHECK(folder.names().empty());
}

TEST_CASE("help and version go to standard output with exit code 0", "[cli]") {
    CHECK(palpate_command({"--help"}).code == 0);
    CHECK_THAT(palpate_command({"--help"}).out, ContainsSubstring("run") &&
                                                    ContainsSubstring("demo") &&
                                                    ContainsSubstring("summary"));
    CHECK_THAT(palpate_command({"--version"}).out, ContainsSubstring("palpate "));
}

TEST_CASE("a finished session is not run again by mistake", "[cli]") {
    const TemporaryFolder folder;
    const std::vector<std::string> words{"run",  "shape_friction_demo",   "--participant", "P1",
                                         "--db", folder.file("d.sqlite"), "--headless"};
    CHECK(palpate_command(words).code == 0);
    const Finished again = palpate_command(words);
    CHECK(again.code == 2);
    CHECK_THAT(again.error, ContainsSubstring("--session 2"));
    std::vector<std::string> second = words;
    second.insert(second.end(), {"--session", "2"});
    CHECK(palpate_command(second).code == 0);
}

TEST_CASE("a session number that leaves a gap is refused, unless the others are in another file",
          "[cli][law]") {
    const TemporaryFolder folder;
    const auto run = [&](std::vector<std::string> more) {
        std::vector<std::string> words{"run",  "shape_friction_demo",   "--participant", "P1",
                                       "--db", folder.file("d.sqlite"), "--headless"};
        words.insert(words.end(), more.begin(), more.end());
        return palpate_command(words);
    };
    const Finished first = run({"--session", "2"});
    CHECK(first.code == 2);
    CHECK_THAT(first.error, ContainsSubstring("no session of shape_friction_demo so far") &&
                                ContainsSubstring("give --session 1"));
    CHECK(folder.names().empty());
    CHECK(run({"--session", "1"}).code == 0);
    const Finished far = run({"--session", "5"});
    CHECK(far.code == 2);
    CHECK_THAT(far.error, ContainsSubstring("sessions up to 1") &&
                              ContainsSubstring("give --session 2, or --elsewhere"));
    CHECK(run({"--session", "2"}).code == 0);
    CHECK(run({"--session", "5", "--elsewhere"}).code == 0);
}

TEST_CASE("a trial or an interval that is not there is a wrong word: exit code 2", "[cli][law]") {
    const TemporaryFolder folder;
    const std::string file = folder.file("d.sqlite");
    REQUIRE(palpate_command(
                {"run", "shape_friction_demo", "--participant", "P1", "--db", file, "--headless"})
                .code == 0);
    for (const std::vector<std::string>& words :
         {std::vector<std::string>{"trace", file, "999"},
          {"trace", file, "1", "--interval", "2"},
          {"mark", file, "999", "--invalid", "x"},
          {"note", file, "x", "--participant", "P1", "--session", "7"},
          {"participant", file, "P7"},
          {"run", "shape_friction_demo", "--participant", "P2", "--db", folder.file("e.sqlite"),
           "--headless", "--device", "replay:" + file + ":999"}}) {
        CAPTURE(words);
        const Finished wrong = palpate_command(words);
        CAPTURE(wrong.error);
        CHECK(wrong.code == 2);
        CHECK(wrong.out.empty());
        CHECK_THAT(wrong.error, ContainsSubstring("7") || ContainsSubstring("999") ||
                                    ContainsSubstring("no interval 2: give 1") ||
                                    ContainsSubstring("no such session"));
    }
    CHECK_FALSE(std::filesystem::exists(folder.file("e.sqlite")));
}

TEST_CASE("a session goes on to its end when nobody reads what it prints", "[cli][law]") {
    const TemporaryFolder folder;
    const std::string file = folder.file("d.sqlite");
    // A pipe whose reader is gone from the start, for both kinds of output.
    const Finished alone =
        tests::Process(
            {"sh", "-c", R"(mkfifo "$1"; exec 4<>"$1" 5>"$1" 4<&-; shift; exec "$@" >&5 2>&5)",
             "sh", folder.file("pipe"), tests::palpate_program(), "run", "shape_friction_demo",
             "--participant", "P1", "--db", file, "--headless", "--kind", "real"},
            {"DISPLAY", "WAYLAND_DISPLAY", "SDL_VIDEODRIVER"})
            .wait();
    CHECK(alone.code == 0);
    const Finished answers =
        tests::Process(
            {"sqlite3", file,
             "SELECT count(*), min(outcome), max(outcome), (SELECT finished FROM session)"
             " FROM trial"})
            .wait();
    CHECK(answers.out == "10|complete|complete|1\n");
    CHECK(palpate_command({"verify", file}).code == 0);
}

TEST_CASE(
    "a database that is somebody else's, or has no name, is a wrong word: exit code 2, untouched",
    "[cli][law]") {
    const TemporaryFolder folder;
    const std::string file = folder.file("letters.txt");
    std::ofstream(file) << "Dear participant, thank you for coming.\n";
    for (const std::string& name : {file, std::string()}) {
        CAPTURE(name);
        const Finished run = palpate_command(
            {"run", "shape_friction_demo", "--participant", "P1", "--db", name, "--headless"});
        CAPTURE(run.error);
        CHECK(run.code == 2);
        CHECK_THAT(run.error, ContainsSubstring(name.empty() ? "empty" : "not a palpate database"));
        CHECK(folder.names() == std::vector<std::string>{"letters.txt"});
    }
    std::ifstream in(file);
    std::string line;
    std::getline(in, line);
    CHECK(line == "Dear participant, thank you for coming.");
}

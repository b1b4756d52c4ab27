#include <nlohmann/json.hpp>

#include "data/store/session_lock.hpp"
#include "tests/support/console.hpp"
#include "tests/support/program.hpp"
#include "tests/support/sql_first.hpp"

// What palpate says of a file on which a session runs.

TEST_CASE("palpate status says who ran and what runs, and follows it to its end", "[live]") {
    ShownSession session(kFourTrials, {"0.3"});
    const data::Json now =
        data::Json::parse(palpate_command({"status", session.file, "--json"}).out);
    CHECK(now["studies"][0]["planned"] == 1);
    REQUIRE(now["running"].size() == 1);
    CHECK(now["running"][0]["participant"] == "P1");
    CHECK(now["running"][0]["kind"] == "simulated");
    CHECK_THAT(palpate_command({"status", session.file}).out,
               Has("running: P1, simulated, session 1: "));
    Process follows({palpate_program(), "status", session.file, "--follow", "--json"});
    REQUIRE(eventually([&] { return follows.out().find('\n') != std::string::npos; }));
    {  // how it ended is said, however late somebody looks
        ShownSession other(kFourTrials, {"0.3"});
        Process late({palpate_program(), "status", other.file, "--follow", "--json"});
        REQUIRE(eventually([&] { return late.out().find('\n') != std::string::npos; }));
        late.signal(SIGSTOP);
        CHECK(other.program.ended_by(SIGTERM) == 3);
        late.signal(SIGCONT);
        CHECK_THAT(late.wait().out, Has("\"ended\":\"ended early\""));
    }
    const Words refuses{"participant", session.file, "P1", "--consent", "no"};
    CHECK_THAT(palpate_command(refuses).error, Has("session 1 of P1 runs now, and goes on"));
    const TemporaryFile other("other.sqlite");
    for (const auto& [into, from] :
         {std::pair<std::string, std::string>(other, session.file), {session.file, other}}) {
        CHECK_THAT(ran({"merge", into, from}).error,
                   Has(session.file + ": a session runs on it, and goes on"));
    }
    const auto notes = [&] {
        const data::Json state = session.state();
        return state.contains("notes") ? state["notes"] : data::Json::array();
    };
    CHECK(ran({"note", session.file, "hand rested", "--participant", "P1"}).error.empty());
    REQUIRE(eventually([&] { return !notes().empty(); }));
    CHECK(notes().back()["text"] == "hand rested");
    CHECK(session.kept("SELECT count(*) FROM event WHERE event_kind = 'note'") == "1");
    session.program.signal(SIGKILL);
    CHECK(follows.wait().code == 0);
    CHECK(palpate_command(refuses).error.empty());
    sql_edit(session.file, "UPDATE session SET session_kind = 'real'");
    CHECK_THAT(palpate_command({"status", session.file}).out,
               Has("Nothing runs on it now", "0 of 1 person planned ran, 1 to go",
                   "  do not consent: P1\n", ", no consent\n"));
}

TEST_CASE("whatever shows stimuli and answers of a file says once that a session runs on it",
          "[live]") {
    const TemporaryFolder folder;
    const std::string file = run_by({"P1"}, kFourTrials, folder.file("d.sqlite"));
    const std::vector<Words> all{
        {"summary", file},
        {"sql", file, "-c", "SELECT planned_object FROM plan"},
        {"sql", file, "--versions", "apart", "-c", "SELECT planned_object FROM plan"},
        {"sequence", kFourTrials, "--participant", "P1", "--db", file},
        {"trace", file, "1"},
        {"report", file, "--trial", "1", "-o", folder.file("trial.html")},
        {"report", file, "--kind", "simulated", "-o", folder.file("all.html")},
        {"export", file, "--kind", "simulated", "-o", folder.file("csv")},
        {"stats", file, "--kind", "simulated"},
        {"fit", file, "--kind", "simulated"},
        {"audit", file, "--kind", "simulated"}};
    const auto warnings = [](const Words& words) {
        return count_of(palpate_command(words).error, "a session runs on it");
    };
    for (const auto& words : all) {
        CAPTURE(words);
        CHECK(warnings(words) == 0);
    }
    std::filesystem::remove_all(folder.file("csv"));
    data::Database database(file, data::Access::write);
    const data::SessionLock session(database, 1);
    for (const auto& words : all) {
        CAPTURE(words);
        CHECK(warnings(words) == 1);
    }
    for (const char* silent : {"status", "verify", "participant"}) {
        CHECK(warnings({silent, file}) == 0);
    }
}

TEST_CASE("status says of a session that hangs whose it is, and that it does not answer",
          "[live]") {
    ShownSession session;
    const auto status = [&] {
        return data::Json::parse(palpate_command({"status", session.file, "--json"}).out);
    };
    CHECK_FALSE(status()["running"][0].contains("answers"));
    session.program.signal(SIGSTOP);
    CHECK(status()["running"] == data::Json::array({{{"session", session.shown.uuid},
                                                     {"participant", "P1"},
                                                     {"number", 1},
                                                     {"kind", "simulated"},
                                                     {"answers", false}}}));
    CHECK_THAT(
        palpate_command({"status", session.file}).out,
        Has("running: P1, simulated, session 1: it does not answer", "the switch of its motors") &&
            !Has("Nothing runs"));

    CHECK_THAT(palpate_command({"console", session.file}).error,
               Has("no session of yours that answers"));

    // Who follows it sees it go on, hang again and end.
    Process follows({palpate_program(), "status", session.file, "--follow"});
    const auto said = [&](const std::string& text) {
        return eventually([&] {
            const std::string out = follows.out();
            return out.substr(out.rfind("running: ") + 1).find(text) != std::string::npos;
        });
    };
    REQUIRE(said("does not answer"));
    session.program.signal(SIGCONT);
    REQUIRE(said(" left"));
    session.program.signal(SIGSTOP);
    REQUIRE(said("does not answer"));
    session.program.signal(SIGKILL);
    static_cast<void>(session.program.wait());
    CHECK(follows.wait().code == 0);
    CHECK(status()["running"].empty());
}

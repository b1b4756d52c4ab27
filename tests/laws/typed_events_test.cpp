#include <filesystem>

#include "data/store/session_store.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/process.hpp"
#include "tests/support/studies.hpp"

using namespace palpate;
using data::Access;
using data::Database;
using tests::palpate_command;

namespace {

std::vector<std::string> run(const std::string& file, const std::string& resume) {
    return {"run",
            "shape_friction_demo",
            "--participant",
            "P1",
            "--db",
            file,
            "--headless",
            "--speed",
            "0",
            "--secret",
            tests::kRunSecret,
            "--resume",
            resume};
}

std::string csv_of(const std::string& file, const std::string& sql) {
    return palpate_command({"sql", file, "--csv", "-c", sql}).out;
}

/// As if the program had ended after so many attempts.
void cut(const std::string& file, int attempts) {
    Database database(file, Access::write);
    for (const char* table : {"response", "presentation", "trace_chunk", "fault_tick", "trial"}) {
        database.execute(
            fmt::format("DELETE FROM {} WHERE trial_id > {}", table, attempts).c_str());
    }
    database.execute(
        fmt::format("DELETE FROM event WHERE trials_begun > {}; UPDATE session SET finished = 0,"
                    " finished_utc = NULL, seal = NULL, seal_events = NULL",
                    attempts)
            .c_str());
}

}  // namespace

TEST_CASE("a session goes on alike whatever the sentences of its events say",
          "[laws][events][law]") {
    const tests::TemporaryFolder folder;
    const std::string file = folder.file("a.sqlite");
    REQUIRE(palpate_command(run(file, "continue")).code == 0);
    cut(file, 9);
    REQUIRE(palpate_command({"mark", file, "7", "--invalid", "the bell rang"}).code == 0);
    // The session begins its block again, and is broken off again.
    REQUIRE(palpate_command(run(file, "redo-block")).code == 0);
    cut(file, 14);
    CHECK(csv_of(file, "SELECT event_kind FROM event WHERE event_kind = 'redo'") ==
          "event_kind\nredo\n");
    const std::string reworded = folder.file("reworded.sqlite");
    std::filesystem::copy(file, reworded);
    Database(reworded, Access::write)
        .execute(
            "UPDATE event SET text = 'after 3 attempts: part 2: position ' || event_id || ' is "
            "done'");
    for (const std::string& one : {file, reworded}) {
        REQUIRE(palpate_command(run(one, "continue")).code == 0);
    }
    for (const char* sql :
         {"SELECT trial_id, plan_position, attempt, outcome, invalid_reason IS NULL, fault_cause,"
          " ticks FROM trial ORDER BY trial_id",
          "SELECT * FROM response ORDER BY trial_id",
          "SELECT trials_begun, event_kind, trial_id, plan_position, part, count, key FROM event"
          " ORDER BY event_id",
          "SELECT answered, faulted, aborted, lost_ticks, breaks FROM session_health"}) {
        CAPTURE(sql);
        const std::string wanted = csv_of(file, sql);
        CHECK(wanted.find('\n') + 1 < wanted.size());
        CHECK(csv_of(reworded, sql) == wanted);
    }
}

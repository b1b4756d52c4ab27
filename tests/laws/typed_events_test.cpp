#include "tests/support/program.hpp"
#include "tests/support/sql_first.hpp"

namespace {

Words run(const std::string& file, const std::string& resume) {
    return run_words("shape_friction_demo", "P1", file,
                     {"--headless", "--speed", "0", "--secret", kRunSecret, "--resume", resume});
}

/// As if the program had ended after so many attempts.
void cut(const std::string& file, int attempts) {
    std::string sql;
    for (const char* table : {"response", "presentation", "trace_chunk", "fault_tick", "trial"}) {
        sql += fmt::format("DELETE FROM {} WHERE trial_id > {};", table, attempts);
    }
    sql_edit(file,
             sql + fmt::format("DELETE FROM event WHERE trials_begun > {}; UPDATE session SET "
                               "finished = 0, finished_utc = NULL, seal = NULL, seal_events "
                               "= NULL",
                               attempts));
}

}  // namespace

TEST_CASE("a session goes on alike whatever the sentences of its events say") {
    const TemporaryFolder folder;
    const std::string file = folder.file("a.sqlite");
    ran(run(file, "continue"));
    cut(file, 9);
    ran({"mark", file, "7", "--invalid", "the bell rang"});
    // The session begins its block again, and is broken off again.
    ran(run(file, "redo-block"));
    cut(file, 14);
    CHECK(sql_csv(file, "SELECT event_kind FROM event WHERE event_kind = 'redo'") ==
          "event_kind\nredo\n");
    const std::string reworded = copied(file, folder.file("reworded.sqlite"));
    sql_edit(reworded,
             "UPDATE event SET text = 'after 3 attempts: part 2: position ' || event_id || ' is "
             "done'");
    for (const std::string& one : {file, reworded}) {
        ran(run(one, "continue"));
    }
    for (const char* sql :
         {"SELECT trial_id, plan_position, attempt, outcome, invalid_reason IS NULL, fault_cause,"
          " ticks FROM trial ORDER BY trial_id",
          "SELECT * FROM response ORDER BY trial_id",
          "SELECT trials_begun, event_kind, trial_id, plan_position, part, count, key FROM event"
          " ORDER BY event_id",
          "SELECT answered, faulted, aborted, lost_ticks, breaks FROM session_health"}) {
        CAPTURE(sql);
        const std::string wanted = sql_csv(file, sql);
        CHECK(wanted.find('\n') + 1 < wanted.size());
        CHECK(sql_csv(reworded, sql) == wanted);
    }
}

#include "data/schema/catalogue.hpp"
#include "data/verify/verify.hpp"
#include "tests/support/database_edits.hpp"
#include "tests/support/mixed_study.hpp"
#include "tests/support/program.hpp"
#include "tests/support/sql_first.hpp"

namespace {

/// What follows from nothing else: clocks, people and the outside said it, or it is a seal.
bool only_sealed(const std::string& column) {
    static const std::set<std::string> said{"session.operator", "session.uuid", "trial.started_ns",
                                            "response.input"};
    return said.contains(column) || column.ends_with("_utc") ||
           column.find("seal") != std::string::npos || column.starts_with("event.") ||
           column.starts_with("session_provenance.");
}

}  // namespace

TEST_CASE("one changed value in any column of any table of results is reported", "[long]") {
    const TemporaryFolder folder;
    data::Database database(mixed_study(folder), data::Access::write);
    CAPTURE(text_of(data::verify(database)));
    REQUIRE(text_of(data::verify(database)).empty());
    database.execute("PRAGMA foreign_keys = OFF");
    int columns = 0;
    for (const data::TableManual& table : data::catalogue()) {
        if (table.view || table.name == "participant_detail") {  // kNotChecked
            continue;
        }
        for (const std::string& name : result_columns(database, {table.name})) {
            bool by_itself = false;
            int made = 0;
            // Some bits of a time are below what two C libraries differ by: then another edit.
            const bool sealed = only_sealed(name);
            for (std::uint64_t seed = 0; (made < 1 || !(by_itself || sealed)) && seed < 200;
                 ++seed) {
                Random random(seed + 1000 * static_cast<std::uint64_t>(columns));
                const std::int64_t row = a_row(database, table.name, random);
                made += check_edit(database, table.name, name.substr(table.name.size() + 1), row,
                                   random, &by_itself);
            }
            CAPTURE(name);
            CHECK((made >= 1 || name == "trace_chunk.codec"));  // there is but one codec
            CHECK((by_itself || sealed || made == 0));
            ++columns;
        }
    }
    CHECK(columns > 140);
}

TEST_CASE("rows that were swapped, moved, copied, added or taken away are reported") {
    const TemporaryFolder folder;
    data::Database database(mixed_study(folder), data::Access::write);
    database.execute("PRAGMA foreign_keys = OFF");
    // Ids of the first two such trials; a position that was run again felt and answered the same.
    const auto two = [&](const std::string& where) {
        const auto ids =
            integers(database.prepare("SELECT min(trial_id) FROM trial WHERE " + where +
                                      " GROUP BY plan_position ORDER BY 1 LIMIT 2"));
        return std::pair(ids.at(0), ids.at(1));
    };
    Words edits;
    for (const std::string where : {"session_id = 1 AND outcome IN ('complete', 'timed_out')",
                                    "session_id = 2 AND outcome IN ('complete', 'timed_out')"}) {
        const auto [a, b] = two(where);
        for (const std::string table : {"response", "presentation", "trace_chunk"}) {
            edits.push_back(fmt::format(
                "UPDATE {0} SET trial_id = -trial_id WHERE trial_id IN ({1}, {2});UPDATE {0} SET "
                "trial_id = {1} + {2} + trial_id WHERE trial_id < 0",
                table, a, b));
        }
        edits.push_back(
            fmt::format("UPDATE trace_chunk SET (ticks, crc32, derived, holds, data) = (SELECT "
                        "ticks, crc32, derived, holds, data FROM trace_chunk AS other WHERE "
                        "trial_id = {} LIMIT 1) WHERE trial_id = {} AND interval = 1",
                        a, b));
        edits.push_back(
            fmt::format("UPDATE trial SET trial_id = -trial_id WHERE trial_id IN ({0}, {1});UPDATE "
                        "trial SET trial_id = {0} + {1} + trial_id WHERE trial_id < 0",
                        a, b));
    }
    const auto [mine, other] = std::pair(two("session_id = 1 AND fault_cause IS NULL").first,
                                         two("session_id = 2 AND fault_cause IS NULL").first);
    edits.push_back(fmt::format(  // from another session
        "UPDATE trace_chunk SET (ticks, crc32, derived, holds, data) = (SELECT ticks, crc32, "
        "derived, holds, data FROM trace_chunk WHERE trial_id = {}) WHERE trial_id = {}",
        other, mine));
    for (const std::string last : {"SELECT max(trial_id) FROM trial WHERE session_id = 1",
                                   "SELECT max(trial_id) FROM trial WHERE session_id = 2"}) {
        std::string all;
        for (const char* table :
             {"response", "presentation", "trace_chunk", "fault_tick", "adaptive_step", "event"}) {
            all += fmt::format("DELETE FROM {} WHERE trial_id = ({});", table, last);
        }
        edits.push_back(all + fmt::format("DELETE FROM trial WHERE trial_id = ({})", last));
    }
    std::ranges::copy(lines_in(test_text("edits/other_edits.sql")), std::back_inserter(edits));
    for (const std::string& edit : edits) {
        check_seen(database, edit);
    }
    // What somebody added of his own is his.
    const Undone undone(database);
    database.execute(
        "CREATE TABLE mine (x); CREATE INDEX by_outcome ON trial (outcome); CREATE VIEW theirs AS "
        "SELECT * FROM trial; CREATE TRIGGER u AFTER INSERT ON mine BEGIN SELECT 1; END");
    CHECK(text_of(data::verify(database)).empty());
}

TEST_CASE("what a lab calls sample is its own, and no query is answered by it") {
    const TemporaryFolder folder;
    const std::string file = mixed_study(folder);
    const auto answer = [&](const std::string& query) {
        return sql_csv(file, query);
    };
    const std::string query = "SELECT count(*), sum(rendered_normal_n) FROM sample";
    const std::string before = answer(query);
    for (const std::string own :
         {"CREATE VIEW sample AS SELECT 1 AS trial_id, 5 AS rendered_normal_n",
          "DROP VIEW sample; CREATE TABLE Sample (trial_id, rendered_normal_n);"
          "INSERT INTO Sample VALUES (1, 5)"}) {
        CAPTURE(own);
        sql_edit(file, own);
        CHECK(answer(query) == before);
        CHECK(answer("SELECT rendered_normal_n AS n FROM main.sample") == "n\n5\n");
        CHECK_THAT(ran({"sql", file, "-c", query}).error,
                   Has("what the file calls so is main.sample"));
        ran({"verify", file});
        ran({"report", file, "--kind", "simulated", "--study", "shape_friction_demo", "--output",
             folder.file("r.html")});
    }
}

TEST_CASE(
    "Python computes every column of the views and the ten usual questions again, and notices a "
    "changed value",
    "[long]") {
    const TemporaryFolder folder;
    const std::string file = mixed_study(folder);
    const auto ticks = palpate_command(
        {"sql", file, "--csv", "-c", "SELECT * FROM sample ORDER BY trial_id, interval, tick"});
    REQUIRE(ticks.code == 0);
    std::ofstream(folder.file("sample.csv")) << ticks.out;
    if (!installed("python3 with sqlite3", {"python3", "-c", "import sqlite3, csv"})) {
        return;
    }
    const auto recompute = [&](const std::string& of) {
        return Process({"python3", PALPATE_SOURCE_DIR "/tests/support/recompute.py", of,
                        folder.file("sample.csv"), PALPATE_SOURCE_DIR "/docs/data.md"})
            .wait();
    };
    const Finished same = recompute(file);
    CAPTURE(same.out, same.error);
    CHECK(same.code == 0);
    CHECK_THAT(same.out, Has("values, 0 differences"));
    sql_edit(file,
             "UPDATE trial SET strokes = strokes + 1, mean_speed_m_per_s = mean_speed_m_per_s * "
             "1.0001 WHERE trial_id = 2; UPDATE presentation SET reversals = reversals + 1, "
             "path_length_m = path_length_m * 1.0001 WHERE trial_id = 2; DROP VIEW confusion; "
             "CREATE VIEW confusion AS SELECT study_name, session_kind, friction, planned_object, "
             "chosen_object, count(*) + 1 AS n FROM analysis_trial WHERE counts AND phase = 'main' "
             "GROUP BY 1, 2, 3, 4, 5");
    const Finished changed = recompute(file);
    CHECK(changed.code == 1);
    CHECK_THAT(changed.out, Has(": strokes is ", ": mean_speed_m_per_s is ", ": reversals is ",
                                ": path_length_m is ", "confusion"));
}

#include "protocols/library/shipped.hpp"
#include "data/verify/verify.hpp"
#include "tests/support/child.hpp"
#include "tests/support/database_edits.hpp"
#include "tests/support/program.hpp"
#include "tests/support/sql_first.hpp"

using data::FindingKind;

namespace {

/// The demo protocol with two objects, four trials, and `edit` made.
void write_protocol(const std::string& file,
                    const std::string& from = "",
                    const std::string& to = "") {
    std::string text(protocols::shipped_protocol("shape_friction_demo").text);
    for (const char* object : {"concave_10", "concave_5", "convex_10"}) {
        const std::size_t at = text.find(fmt::format("[[object]]\nname = \"{}\"", object));
        REQUIRE(at != std::string::npos);
        text.erase(at, text.find("[[", at + 2) - at);
    }
    write(file, from.empty() ? text : replaced(text, from, to));
}

/// The same with trials of a second, for laws that verify a file some hundred times.
void write_quick_protocol(const std::string& file) {
    write_protocol(
        file, "[timing]\nexplore_min_s = 2\nexplore_prompt_s = 30\nexplore_timeout_s = 45\n",
        "[invalid]\ncontact_min_s = 0\npath_min_mm = 0\n\n"
        "[timing]\nexplore_min_s = 0.5\nexplore_prompt_s = 0.8\nexplore_timeout_s = 1\n");
}

Words words_in(const TemporaryFolder& folder, const std::string& database) {
    return run_words(folder.file("p.toml"), "P1", folder.file(database), {"--headless"});
}

/// The file of such a session.
std::string quick_session(const TemporaryFolder& folder) {
    write_quick_protocol(folder.file("p.toml"));
    ran(words_in(folder, "a.sqlite"));
    return folder.file("a.sqlite");
}

}  // namespace

TEST_CASE("a clean file verifies, a replayed session too, and not a byte of it changes") {
    const TemporaryFile file("a.sqlite");
    ran({"demo", "--headless", "--db", file});
    ran({"demo", "--headless", "--db", file});
    ran(run_words("shape_friction_demo", "P2", file, {"--headless", "--device", "replay:" + file}));
    const std::string before = slurp(file);
    CHECK_THAT(ran({"verify", file}).out,
               Has("3 sessions", "participant P2, session 1 (simulated): 10 trials",
                   "\nNothing differs.\n"));
    CHECK(slurp(file) == before);
    CHECK_THAT(ran({"verify", file, "--json"}).out,
               Has("\"differences\": 0,\n  \"missing\": 0,\n  \"findings\": []"));
}

TEST_CASE("a session keeps which binary, which libraries and which geometry made it") {
    const TemporaryFolder folder;
    write_protocol(folder.file("p.toml"));
    ran(words_in(folder, "a.sqlite"));
    const auto value = [&](const std::string& key) {
        return sql_first(folder.file("a.sqlite"),
                         "SELECT value FROM session_provenance WHERE key = '" + key + "'");
    };
    std::string id;  // as bytes, which the program's file must hold
    for (std::size_t i = 0; i + 1 < value("build id").size(); i += 2) {
        id += static_cast<char>(std::stoi(value("build id").substr(i, 2), nullptr, 16));
    }
    REQUIRE(id.size() >= 8);
    CHECK(slurp(palpate_program()).find(id) != std::string::npos);
    for (const char* key : {"sqlite", "zlib", "nettle", "fmt", "toml++", "CLI11", "libc", "kernel",
                            "system", "processor"}) {
        CAPTURE(key);
        CHECK_FALSE(value(key).empty());
    }
    CHECK(value("object sha256 straight").size() == 64);
    CHECK(value("object sha256 straight") != value("object sha256 convex_5"));
}

TEST_CASE("any changed value of a result, and any changed bit of a trace, is reported") {
    const TemporaryFolder folder;
    data::Database database(quick_session(folder), data::Access::write);
    REQUIRE(text_of(data::verify(database)).empty());
    const auto rows = result_columns(database, {"study", "participant", "session", "picture",
                                                "trial", "response", "trace_column"});
    CHECK(check_edits(database, rows, 150, 1) > 90);
    CHECK(check_edits(database, result_columns(database, {"plan"}), 40, 2) > 25);
    CHECK(check_edits(database, {"trace_chunk.data"}, 120, 3) == 120);
    CHECK(check_edits(database,
                      {"trace_chunk.trial_id", "trace_chunk.first_tick", "trace_chunk.ticks",
                       "trace_chunk.crc32", "trace_chunk.interval", "trace_chunk.codec",
                       "trace_chunk.period_ns", "trace_chunk.holds", "trace_chunk.derived"},
                      60, 4) > 30);
}

TEST_CASE(
    "a tick that does not follow from its HIP is reported, also in a chunk whose checksum is "
    "right") {
    const TemporaryFolder folder;
    data::Database database(quick_session(folder), data::Access::write);
    for (std::uint64_t seed = 0; seed < cases(80U); ++seed) {
        Random random(seed);
        const Undone undone(database);
        const std::int64_t row = a_row(database, "trace_chunk", random);
        repack(database, row,
               {"tick", "time_s", "mode", "segment", "u", "cp_x_m", "cp_y_m", "go_x_m", "go_y_m",
                "rendered_x_n", "rendered_y_n", "rendered_normal_n", "rendered_tangential_n", "mu"},
               random);
        const data::Verification found = data::verify(database);
        CAPTURE(seed, row);
        CHECK(found.count(FindingKind::differs) > 0);
        CHECK_THAT(text_of(found), Has("trace"));
    }
}

TEST_CASE("a row that is gone is reported") {
    const TemporaryFolder folder;
    data::Database database(quick_session(folder), data::Access::write);
    database.execute("PRAGMA foreign_keys = OFF");
    for (const std::string table : {"study", "participant", "plan", "picture", "trial", "response",
                                    "trace_chunk", "trace_column"}) {
        for (int i = 0; i < 8; ++i) {
            Random random(static_cast<std::uint64_t>(i));
            check_seen(database, fmt::format("DELETE FROM {} WHERE rowid = {}", table,
                                             a_row(database, table, random)));
        }
    }
    for (const std::string& gone : lines_in(test_text("edits/gone.sql"))) {
        check_seen(database, gone);
    }
}

TEST_CASE("a session whose device trips verifies as that, and its last ticks are watched over") {
    const TemporaryFolder folder;
    write_protocol(folder.file("p.toml"), "dead_man = false", "speed_limit_m_per_s = 0.12");
    const Finished run = palpate_command(words_in(folder, "a.sqlite"));
    CAPTURE(run.out, run.error);
    data::Database database(folder.file("a.sqlite"), data::Access::write);
    const data::Verification found = data::verify(database);
    CHECK(text_of(found).empty());
    REQUIRE(found.sessions.size() == 1);
    CHECK(found.sessions[0].replayed > 100);
    REQUIRE(count(database, "fault WHERE fault_cause = 'over_speed'") > 0);
    CHECK(check_edits(database, result_columns(database, {"fault_tick"}), 80, 5) > 60);
    for (const std::string& wrong : lines_in(test_text("edits/trips.sql"))) {
        check_seen(database, wrong);
    }
}

TEST_CASE(
    "a file verifies while its session runs, after it was killed, interrupted and gone on with",
    "[long]") {
    const TemporaryFolder folder;
    write_protocol(folder.file("p.toml"));
    const std::string file = folder.file("a.sqlite");
    const Words words = joined(command_of(words_in(folder, "a.sqlite")),
                               {"--speed", "2"});  // longer than a slow machine takes to verify
    const auto has_ticks_from = [&](int trial) {
        return eventually([&] {
            return sql_now(file, fmt::format("SELECT sum(ticks) >= 512 FROM trace_chunk WHERE "
                                             "trial_id >= {}",
                                             trial)) == "1";
        });
    };
    const auto outcome = [&](const std::string& which) {
        return std::stoi(
            sql_first(file, "SELECT count(*) FROM trial WHERE outcome = '" + which + "'"));
    };
    const auto verifies = [&] {
        CHECK_THAT(ran({"verify", file}).out, !Has("missing"));
    };
    {
        Process killed(words, kNoDisplay);
        REQUIRE(has_ticks_from(2));
        verifies();
        REQUIRE(killed.running());  // and the reader did not disturb it
        killed.signal(SIGKILL);
        (void)killed.wait();
    }
    CHECK(outcome("running") == 1);
    verifies();
    {
        // On a slow machine verify may have taken the time of another trial.
        const int next = 1 + outcome("complete") + outcome("timed_out") + 1;
        Process stopped(words, kNoDisplay);
        REQUIRE(has_ticks_from(next));
        CHECK(stopped.ended_by(SIGINT) == 3);
    }
    CHECK(outcome("interrupted") == 1);
    CHECK(outcome("aborted") == 1);
    verifies();
    ran(words_in(folder, "a.sqlite"));
    verifies();
    data::Database database(file, data::Access::write);
    CHECK(check_edits(database, result_columns(database, {"trial"}), 100, 6) > 60);
}

TEST_CASE(
    "a difference is reported with trial, column, stored and recomputed value, other files with "
    "2") {
    const TemporaryFolder folder;
    write_protocol(folder.file("p.toml"));
    const std::string file = folder.file("a.sqlite");
    ran(words_in(folder, "a.sqlite"));
    sql_edit(file, "UPDATE response SET correct = 1 - correct WHERE trial_id = 2");
    CHECK_THAT(ran({"verify", file}, 1).out,
               Has("  differs  trial 2, response.correct: stored ", ", recomputed ",
                   "trial 2, trial.seal: stored ", "\n2 differences. Take what differs"));
    ran({"verify", folder.file("p.toml")}, 2);
    std::ofstream(folder.file("empty")).flush();
    ran({"verify", folder.file("empty")}, 2);
    CHECK(palpate_command({"verify", folder.file("nothing")}).code != 0);
}

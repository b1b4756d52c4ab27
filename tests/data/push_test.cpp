#include "data/store/people.hpp"
#include "data/sync/push.hpp"
#include "tests/support/push_world.hpp"
#include "tests/support/random.hpp"
#include "tests/support/sql_first.hpp"

using namespace palpate::data;

namespace {

/// Makes the chains of a file hold again, as somebody who edits with care would.
void chain_again(Database& database) {
    database.execute(
        "UPDATE trial SET seal = NULL, seal_events = NULL;UPDATE session SET seal = NULL, "
        "seal_events = NULL");
    for (const auto& trial : database.prepare("SELECT trial_id FROM trial ORDER BY trial_id")) {
        data::chain_trial(database, trial.integer(0));
    }
    data::chain_session(database, 1);
}

}  // namespace

TEST_CASE("pushing twice is pushing once, and chunks arrive as they are") {
    A_SERVER_AND_FILE(server, folder, file);
    const PushReport first = data::push_file(file, server->url());
    CHECK(first.conflicts.empty());
    const std::string once = content(server->url());
    const PushReport second = data::push_file(file, server->url());
    CHECK(second.rows == 0);
    CHECK(second.conflicts.empty());
    CHECK(content(server->url()) == once);

    Database database(file, Access::read);
    auto chunk = database.prepare(
        "SELECT trial.trial_id - (SELECT min(trial_id) FROM trial) + 1, first_tick, "
        "lower(hex(data)), done_s FROM trace_chunk JOIN trial USING (trial_id)");
    Postgres there(server->url());
    while (chunk.step()) {
        const auto row = there.rows(fmt::format(
            "SELECT encode(data, 'hex'), done_s FROM palpate.trace_chunk JOIN palpate.trial USING "
            "(session_uuid, trial_number) WHERE trial_number = {} AND first_tick = {}",
            chunk.integer(0), chunk.integer(1)));
        REQUIRE(row.size() == 1);
        CHECK(*row[0][0] == chunk.text(2));
        CHECK(std::stod(*row[0][1]) == chunk.real(3));
    }
    // What the session became since is added, and nothing else.
    {
        Database mine(file, Access::write);
        data::add_note(mine, 1, "seen by the other lab too", "Ada");
    }
    CHECK(data::push_file(file, server->url()).rows == 1);
    const auto later = there.rows(
        "SELECT operator, seal FROM palpate.event WHERE text = 'seen by the other lab too'");
    REQUIRE(later.size() == 1);
    CHECK(*later[0][0] == "Ada");
    CHECK(*later[0][1] == data::chain_head(database, 1));
}

TEST_CASE(
    "a push or its server cut off at random moments, and pushed again, equals one whole push") {
    A_SERVER_AND_FILE(server, folder, file);
    const std::string whole = new_database(*server, "whole");
    REQUIRE(data::push_file(file, whole).conflicts.empty());
    const std::string expected = content(whole);
    for (int seed = 0; seed < 2; ++seed) {
        CAPTURE(seed);
        Random random(static_cast<std::uint64_t>(seed));
        const std::string url = new_database(*server, fmt::format("cut{}", seed));
        for (int i = 0; i < 8; ++i) {
            Process push({palpate_program(), "push", file, "--to", url});
            std::this_thread::sleep_for(std::chrono::microseconds(random.below(60'000)));
            if (i % 4 == 0) {
                server->crash_and_restart();
            } else if (random.coin()) {
                push.signal(SIGKILL);
            } else {  // the connection is cut instead
                Postgres(server->url())
                    .run(fmt::format("SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE "
                                     "datname = 'cut{}'",
                                     seed));
            }
            const Finished cut = push.wait();
            CAPTURE(i, cut.error);
            CHECK_THAT(cut.error, !Has(PostgresServer::kPassword));
            // One sentence of ours; libpq itself may print the server's last warning before.
            const std::string ours =
                cut.error.substr(std::min(cut.error.find("palpate: "), cut.error.size()));
            CHECK(std::count(ours.begin(), ours.end(), '\n') <= 1);
            Postgres now(url);
            if (now.rows("SELECT 1 FROM pg_tables WHERE schemaname = 'palpate' AND tablename = "
                         "'trace_chunk'")
                    .empty()) {
                continue;
            }
            // An attempt is there with all that belongs to it, or not at all.
            CHECK(now.rows("SELECT session_uuid, trial_number FROM palpate.trial EXCEPT SELECT "
                           "session_uuid, trial_number FROM palpate.trace_chunk")
                      .empty());
            CHECK(now.rows("SELECT session_uuid, trial_number FROM palpate.trace_chunk EXCEPT "
                           "SELECT session_uuid, trial_number FROM palpate.trial")
                      .empty());
        }
        CHECK(data::push_file(file, url).conflicts.empty());
        CHECK(content(url) == expected);
    }
}

TEST_CASE(
    "an attempt is on the server with all that belongs to it or not at all, wherever it fails") {
    A_SERVER_AND_FILE(server, folder, file);
    Postgres admin(server->url());
    admin.run(data::push_setup());
    admin.run(
        "CREATE FUNCTION fail() RETURNS trigger LANGUAGE plpgsql AS $$ BEGIN IF (SELECT count(*) "
        "FROM palpate.trace_chunk) >= TG_ARGV[0]::int THEN RAISE EXCEPTION 'enough'; END IF; "
        "RETURN NEW; END $$");
    for (const int chunks : {0, 1, 4, 8, 15}) {
        CAPTURE(chunks);
        admin.run(
            fmt::format("CREATE OR REPLACE TRIGGER fail BEFORE INSERT ON palpate.trace_chunk FOR"
                        " EACH ROW EXECUTE FUNCTION fail({})",
                        chunks));
        CHECK_THROWS_AS(data::push_file(file, server->url()), data::PostgresError);
        CHECK(admin
                  .rows("SELECT session_uuid, trial_number FROM palpate.trial EXCEPT SELECT "
                        "session_uuid, trial_number FROM palpate.trace_chunk")
                  .empty());
        CHECK(admin
                  .rows("SELECT session_uuid, trial_number FROM palpate.trace_chunk EXCEPT SELECT "
                        "session_uuid, trial_number FROM palpate.trial")
                  .empty());
    }
    admin.run("DROP TRIGGER fail ON palpate.trace_chunk");
    const std::string whole = new_database(*server, "whole");
    (void)data::push_file(file, whole);
    CHECK(data::push_file(file, server->url()).conflicts.empty());
    CHECK(content(server->url()) == content(whole));
}

TEST_CASE("what the server has otherwise is a conflict, and stays") {
    A_SERVER_AND_FILE(server, folder, file);
    REQUIRE(data::push_file(file, server->url()).conflicts.empty());
    const std::string before = content(server->url());
    for (const char* change :
         {"UPDATE session SET device = 'other'", "UPDATE plan SET mu_s = mu_s + 1",
          "UPDATE trial SET done_s = 99.0 WHERE trial_id = 2",
          "UPDATE response SET reaction_s = 99.0",
          "UPDATE session SET uuid = '00000000-0000-4000-8000-000000000000'"}) {
        CAPTURE(change);
        const std::string other = copied(file, folder.file("other.sqlite"));
        {
            Database database(other, Access::write);
            database.execute(change);
            chain_again(database);
        }
        CHECK_THAT(ran({"push", other, "--to", server->url()}, 1).error, Has("conflict: "));
        CHECK(content(server->url()) == before);
        std::filesystem::remove(other + "-wal");
        std::filesystem::remove(other + "-shm");
    }
}

TEST_CASE("a study or a trace_column that is wrong is not sent, and said to be wrong on a server") {
    A_SERVER_AND_FILE(server, folder, file);
    for (const auto& [edit, says] :
         {std::pair{"study SET protocol_toml = replace(protocol_toml, 'force_limit_n = 10', "
                    "'force_limit_n = 9')",
                    "was changed since"},
          {"study SET study_title = 'Another'", "was changed since"},
          {"study SET study_name = 'another'", "was changed since"},
          {"trace_column SET scale = 2 * scale",
           "its trace_column is not how ticks are written"}}) {
        CAPTURE(edit);
        const std::string url =
            new_database(*server, fmt::format("db{}", std::hash<std::string>()(edit)));
        const std::string other = copied(file, folder.file("other.sqlite"));
        sql_edit(other, fmt::format("UPDATE {}", edit));
        check_end(palpate_command({"push", other, "--to", url}), 1, Has(says));
        ran({"push", file, "--to", url});
        const std::string whole = content(url);
        CHECK(palpate_command({"push", other, "--to", url}).code == 1);
        CHECK(content(url) == whole);
        // As if it was there before.
        Postgres admin(url);
        admin.run(fmt::format("UPDATE palpate.{}", edit));
        check_end(palpate_command({"push", file, "--to", url}), 1,
                  Has("conflict: ", "the server has it otherwise in palpate."));
        admin.run("DELETE FROM palpate.study; DELETE FROM palpate.trace_column");
        ran({"push", file, "--to", url});
        CHECK(content(url) == whole);
    }
}

TEST_CASE("what a server lost comes again, and a column that it lost is named") {
    A_SERVER_AND_FILE(server, folder, file);
    const Words push{"push", file, "--to", server->url()};
    ran({"participant", file, "demo", "--consent", "yes"});
    ran(push);
    const std::string whole = content(server->url());
    Postgres admin(server->url());
    for (const auto& table : admin.rows(
             "SELECT tablename, tablename IN ('trace_chunk', 'plan', 'trial') FROM pg_tables WHERE "
             "schemaname = 'palpate'")) {
        admin.run(*table[1] == "t" ? "DROP TABLE palpate." + *table[0]
                                   : fmt::format("DELETE FROM palpate.{0} WHERE ctid = (SELECT "
                                                 "max(ctid) FROM palpate.{0})",
                                                 *table[0]));
    }
    CHECK(content(server->url()) != whole);
    ran(push);
    CHECK(content(server->url()) == whole);

    admin.run("DELETE FROM palpate.response WHERE trial_number = 2");
    ran(push);
    CHECK(content(server->url()) == whole);

    for (const char* column : {"trial DROP COLUMN done_s", "plan DROP COLUMN mu_s"}) {
        CAPTURE(column);
        const std::string table = std::string(column).substr(0, std::string(column).find(' '));
        admin.run("ALTER TABLE palpate." + std::string(column));
        check_end(palpate_command(push), 1, Has("palpate." + table + " has no column"));
        admin.run("DROP TABLE palpate." + table);
        ran(push);
        CHECK(content(server->url()) == whole);
    }
}

TEST_CASE("a writer adds and never changes, a reader only reads, and no message holds a password") {
    A_SERVER_AND_FILE(server, folder, file);
    Postgres admin(server->url());
    admin.run(data::push_setup());
    admin.run("CREATE SCHEMA secret; CREATE TABLE secret.diary (line text)");
    for (const char* role : {"writer", "reader"}) {
        admin.run(fmt::format("CREATE ROLE {0} LOGIN PASSWORD '{1}'; GRANT palpate_{0} TO {0}",
                              role, PostgresServer::kPassword));
    }
    const std::string writer = server->url("postgres", "writer");
    const std::string reader = server->url("postgres", "reader");
    CHECK(data::push_file(file, writer).rows > 0);
    CHECK(Postgres(reader).rows("SELECT * FROM palpate.trial").size() == 10);
    for (const char* sql :
         {"UPDATE palpate.trial SET done_s = 0", "DELETE FROM palpate.trial",
          "TRUNCATE palpate.trial", "DROP TABLE palpate.trial", "CREATE TABLE palpate.mine ()",
          "ALTER TABLE palpate.trial ADD x int",
          "CREATE TRIGGER t BEFORE INSERT ON palpate.trial EXECUTE FUNCTION f()",
          "CREATE ROLE another", "SELECT * FROM pg_authid", "SELECT * FROM secret.diary"}) {
        CHECK_THROWS_AS(Postgres(writer).run(sql), data::PostgresError);
    }
    CHECK_THROWS_AS(Postgres(reader).run(
                        "INSERT INTO palpate.session_end SELECT session_uuid FROM palpate.session"),
                    data::PostgresError);

    const std::string empty = new_database(*server, "empty");
    std::string nobody = server->url("empty", "reader");
    CHECK_THAT(ran({"push", file, "--to", nobody}, 1).error, Has("--roles"));
    nobody.replace(nobody.find("reader:") + 7, 3, "NOT");
    for (const std::string& url :
         {nobody, "postgresql://u:%zz" + std::string(PostgresServer::kPassword) + "@h/d",
          "host=h password=" + std::string(PostgresServer::kPassword)}) {
        const Finished wrong = palpate_command({"push", file, "--to", url});
        CHECK(wrong.code != 0);
        CHECK_THAT(wrong.error, !Has("to-be-said"));
    }
}

TEST_CASE("which session is whose the server goes by the uuid, then by what its events say last") {
    A_SERVER(server);
    const TemporaryFolder folder;
    const auto run_in = [&folder](const char* name) {
        const std::string file = folder.file(name);
        ran(run_words("shape_friction_demo", "P01", file,
                      {"--device", "sim", "--headless", "--speed", "0"}));
        return file;
    };
    const std::string file = run_in("a.sqlite");
    const std::string older = copied(file, folder.file("older.sqlite"));
    const auto move = [&](const Words& words) {
        ran(joined({"participant", file}, joined(words, {"--reason", "typo"})));
    };
    ran({"participant", file, "P02", "--new"});
    move({"P01", "--is-really", "P02"});
    run_in("a.sqlite");  // P01 in person
    const std::string merged = folder.file("merged.sqlite");
    ran({"merge", merged, file});  // in the order of the codes
    const std::string rig = run_in("rig.sqlite");
    const std::string other = new_database(*server, "other");
    for (const auto& [url, files] : {std::pair{server->url(), Words{file, older, merged, file}},
                                     std::pair{other, Words{older, merged, file, older}}}) {
        for (const std::string& one : files) {
            CAPTURE(url, one);
            CHECK(ran({"push", one, "--to", url}).code == 0);
        }
        CHECK(told(url, kSessions) == "2");
        // Somebody else's session of that number.
        check_end(palpate_command({"push", rig, "--to", url}), 1, Has("it under the uuid"));
        CHECK(told(url, kSessions) == "2");
    }
    // Back again, beside P01's own.
    move({"P02", "--is-really", "P01"});
    for (const std::string& url : {server->url(), other}) {
        ran({"push", file, "--to", url});
        ran({"push", older, "--to", url});
        CHECK(told(url, "count(*) FROM palpate.event WHERE key = 'is really'") == "2");
    }
}

TEST_CASE("details that were destroyed come by no session of an older copy, new ones do") {
    A_SERVER_AND_FILE(server, folder, newer);
    const std::string url = server->url();
    ran({"participant", newer, "demo", "--handedness", "73", "--consent", "yes"});
    const std::string older = copied(newer, folder.file("older.sqlite"));
    const std::string person = folder.file("person.sqlite");  // without a session
    ran({"participant", person, "demo", "--new"});
    for (const std::string& file : {person, newer}) {
        ran({"participant", file, "demo", "--destroy", "details", "--yes"});
    }
    CHECK(pushed(person, url).code == 0);
    Postgres there(url);
    check_end(pushed(older, url), 1,
              Has("what was noted of demo was destroyed, says the server", "--destroy details"));
    CHECK(there.rows("SELECT 1 FROM palpate.event").empty());
    CHECK(pushed(newer, url).code == 0);
    CHECK(there.rows("SELECT 1 FROM palpate.event WHERE value = '73'").empty());
    ran({"participant", newer, "demo", "--handedness", "74"});
    CHECK(pushed(newer, url).code == 0);
    ran({"participant", older, "demo", "--destroy", "details", "--yes"});
    CHECK_THAT(pushed(older, url).error, !Has("says the server"));
    CHECK(there.rows("SELECT value FROM palpate.participant_note WHERE key = 'handedness'") ==
          std::vector<std::vector<std::optional<std::string>>>{{"74"}});
}

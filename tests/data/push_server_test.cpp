#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include "data/store/database.hpp"
#include "data/sync/push.hpp"
#include "tests/support/child.hpp"
#include "tests/support/push_world.hpp"
#include "tests/support/sql_first.hpp"

using namespace palpate::data;

TEST_CASE("a damaged session does not reach the server") {
    A_SERVER_AND_FILE(server, folder, file);
    sql_edit(file, "UPDATE response SET reaction_s = 9.0 WHERE trial_id = 3");
    const PushReport report = data::push_file(file, server->url());
    REQUIRE(report.conflicts.size() == 1);
    CHECK_THAT(report.conflicts.front(), Has("palpate verify"));
    CHECK(Postgres(server->url()).rows("SELECT * FROM palpate.session").empty());
}

TEST_CASE(
    "rigs that push at the same time, into a table in parts, leave what one after the other "
    "would") {
    A_SERVER(server);
    const TemporaryFolder folder;
    Words files;
    for (const char* who : {"P01", "P02", "P03"}) {
        files.push_back(folder.file(fmt::format("{}.sqlite", who)));
        ran(run_words("shape_friction_demo", who, files.back(),
                      {"--device", "sim", "--headless", "--speed", "0"}));
    }
    const std::string one = new_database(*server, "one");
    for (const std::string& file : files) {
        CHECK(data::push_file(file, one).rows > 0);
    }
    const std::string together = new_database(*server, "together");
    Postgres admin(together);
    admin.run(data::push_setup());
    admin.run("DROP TABLE palpate.session");  // made again by whoever comes first
    admin.run(
        "ALTER TABLE palpate.trace_chunk RENAME TO whole; CREATE TABLE palpate.trace_chunk (LIKE "
        "palpate.whole INCLUDING ALL) PARTITION BY HASH (session_uuid); DROP TABLE palpate.whole; "
        "CREATE TABLE palpate.part_0 PARTITION OF palpate.trace_chunk FOR VALUES WITH (MODULUS 2, "
        "REMAINDER 0); CREATE TABLE palpate.part_1 PARTITION OF palpate.trace_chunk FOR VALUES "
        "WITH (MODULUS 2, REMAINDER 1)");
    std::vector<std::unique_ptr<Process>> pushes;
    for (int i = 0; i < 2; ++i) {
        for (const std::string& file : files) {
            pushes.push_back(std::make_unique<Process>(
                Words{palpate_program(), "push", file, "--to", together}));
        }
    }
    for (const auto& push : pushes) {
        ended(push->wait());
    }
    for (const char* table :
         {"session", "trial", "trace_chunk", "response", "plan", "presentation"}) {
        CAPTURE(table);
        const std::string sql = fmt::format(
            "SELECT md5(string_agg(to_jsonb(t)::text, '' ORDER BY to_jsonb(t)::text)) FROM"
            " palpate.{} AS t",
            table);
        const auto at_once = admin.rows(sql);
        CHECK(at_once == Postgres(one).rows(sql));
        CHECK(at_once.at(0).at(0).has_value());  // else the table is empty
    }
}

TEST_CASE(
    "TLS is checked as the address says: the server's name, who signed for it, no plain words") {
    const TemporaryFolder folder;
    for (const char* name : {"rig", "other"}) {
        const Finished made =
            Process({"openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt",
                     "ec_paramgen_curve:prime256v1", "-nodes", "-days", "2", "-subj",
                     "/CN=palpate test", "-addext", "subjectAltName=DNS:rig.test", "-keyout",
                     folder.file(fmt::format("{}.key", name)), "-out",
                     folder.file(fmt::format("{}.crt", name))})
                .wait();
        if (made.code != 0) {
            WARN("skipped: no openssl to make a certificate with: " << made.error);
            return;
        }
    }
    A_SERVER(server, folder.file("rig.crt"), folder.file("rig.key"));
    const std::string file = a_database(folder);
    // hostaddr is where, the host's name what the certificate must say.
    const auto url = [&](const char* host, const std::string& words) {
        return fmt::format("postgresql://postgres:{}@{}:{}/postgres?hostaddr=127.0.0.1&{}",
                           PostgresServer::kPassword, host, server->port(), words);
    };
    const std::string full = "sslmode=verify-full&sslrootcert=" + folder.file("rig.crt");
    ran({"push", file, "--to", url("rig.test", full)});
    for (const std::string& wrong :
         {url("other.test", full),
          url("rig.test", "sslmode=verify-full&sslrootcert=" + folder.file("other.crt")),
          url("rig.test", "sslmode=verify-full&sslrootcert=" + folder.file("none.crt")),
          url("rig.test", "sslmode=disable")}) {
        CAPTURE(wrong);
        const Finished refused = ran({"push", file, "--to", wrong}, 1);
        CHECK_THAT(refused.error, Has("rig.test") || Has("other.test"));
        CHECK_THAT(refused.error, !Has(PostgresServer::kPassword));
        CHECK(std::count(refused.error.begin(), refused.error.end(), '\n') == 1);
    }
    // Where the place of an address is empty, libpq goes by the name.
    const Finished elsewhere =
        ran({"push", file, "--to",
             fmt::format("postgresql://postgres:{}@192.0.2.2:5432,localhost:{}/postgres?"
                         "hostaddr=,127.0.0.1",
                         PostgresServer::kPassword, server->port())},
            2);
    CHECK_THAT(elsewhere.error, Has("192.0.2.2 is another machine"));
    // What libpq takes from elsewhere it takes here: service file, password file, variables.
    const std::string service = folder.file("service.conf");
    std::ofstream(service) << fmt::format(
        "[lab]\nhost=rig.test\nhostaddr=127.0.0.1\nport={}\ndbname=postgres\nuser=postgres\n",
        server->port());
    const std::string word = folder.file("pgpass");
    std::ofstream(word) << fmt::format("*:{}:*:postgres:{}\n", server->port(),
                                       PostgresServer::kPassword);
    std::filesystem::permissions(word, std::filesystem::perms::owner_read);
    const auto by_service = [&](const std::string& certificate) {
        return Process({palpate_program(), "push", file, "--to", "postgresql://?service=lab"},
                       {"PGSERVICEFILE=" + service, "PGPASSFILE=" + word, "PGSSLMODE=verify-full",
                        "PGSSLROOTCERT=" + folder.file(certificate)})
            .wait()
            .code;
    };
    CHECK(by_service("rig.crt") == 0);
    CHECK(by_service("other.crt") == 1);
}

TEST_CASE("a password in the address is not left among the words that ps shows") {
    if (!has_libpq()) {
        return;
    }
    // Somebody who takes the call and says nothing.
    const int silent = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    REQUIRE(bind(silent, reinterpret_cast<const sockaddr*>(&address), size) == 0);
    REQUIRE(listen(silent, 1) == 0);
    getsockname(silent, reinterpret_cast<sockaddr*>(&address), &size);
    const TemporaryFolder folder;
    Process push({palpate_program(), "push", a_database(folder), "--to",
                  fmt::format("postgresql://u:{}@127.0.0.1:{}/d", PostgresServer::kPassword,
                              ntohs(address.sin_port))});
    const auto words = [&push] {
        return slurp(fmt::format("/proc/{}/cmdline", push.id()));
    };
    CHECK(eventually([&] { return words().find("://***") != std::string::npos; }));
    CHECK_THAT(words(), !Has(PostgresServer::kPassword));
    push.signal(SIGKILL);
    close(silent);
}

TEST_CASE("of a file only palpate's tables go to a server, and only who consents") {
    A_SERVER_AND_FILE(server, folder, file);
    const Finished lab =
        Process(
            {"sqlite3", file,
             "CREATE TABLE my_codes (code TEXT PRIMARY KEY, real_name TEXT);INSERT INTO my_codes "
             "VALUES ('demo', 'Jane Doe');CREATE TABLE mine (trial_id INTEGER, x);"
             "CREATE TABLE \"x\"\"); COMMIT; CREATE TABLE public.pwned AS SELECT current_user; "
             "--\" (a)"})
            .wait();
    REQUIRE(lab.code == 0);
    const std::string older = copied(file, folder.file("older.sqlite"));
    ran({"participant", file, "demo", "--consent", "no"});
    ran({"participant", file, "later", "--new", "--consent", "yes"});
    const auto push = [&](const Words& more) {
        return pushed(file, server->url(), more);
    };
    const auto count = [&](const std::string& what) {
        return told(server->url(), "count(*) FROM " + what);
    };
    const Finished without = ended(push({}));
    CHECK_THAT(without.out,
               Has("1 session (1 of them left out: no consent)", "not encrypted by TLS"));
    for (const char* table : {"session", "trace_chunk", "event", "response"}) {
        CAPTURE(table);
        CHECK(count(std::string("palpate.") + table) == "0");
    }
    CHECK(count("pg_class WHERE relname IN ('pwned', 'my_codes', 'mine')") == "0");
    // Nor does a file that does not know of it, as another rig's, or an older copy.
    check_end(pushed(older, server->url()), 1, Has("they do not consent, says the server"));
    CHECK(count("palpate.session") == "0");
    // Who refuses later does so on the server too, and a yes after that is not taken there.
    const std::string refused =
        "palpate.participant_note WHERE participant_code = 'later' AND key = 'consent' AND value = "
        "'0'";
    CHECK(count(refused) == "0");
    ran({"participant", file, "later", "--consent", "no"});
    CHECK(push({}).code == 0);
    CHECK(count(refused) == "1");
    CHECK(push({}).code == 0);
    ran({"participant", file, "later", "--consent", "yes"});
    check_end(push({}), 1, Has("participant later: consent is 1 here and 0 on the server"));
    ran({"participant", file, "later", "--consent", "no"});
    CHECK(push({"--including-refused"}).code == 0);
    CHECK(count("palpate.session") == "1");
    const Finished again = push({});
    check_end(again, 1, Has("the server has it: an administrator"));
    // Another machine: nothing is sent to it, not even the question whether it is there.
    CHECK_THAT(
        ran({"push", file, "--to", "postgresql://rig:word@192.0.2.1/lab?sslmode=require"}, 2).error,
        Has("192.0.2.1 is another machine", "--insecure"));
    CHECK_THAT(
        palpate_command({"push", file, "--to", "postgresql://rig:word@LOCALHOST:1/lab"}).error,
        !Has("another machine"));
}

TEST_CASE("what is repaired after a push reaches the server as events, and nothing twice") {
    A_SERVER_AND_FILE(server, folder, file);
    const auto does = [&](Words words) {
        words.insert(words.begin() + 1, file);
        ran(words);
    };
    const std::string url = server->url();
    // Reasons stand in the events' words.
    const std::string said =
        "count(*) FROM palpate.event WHERE text IN ('fell ill', 'another one did')";
    CHECK(pushed(file, url).code == 0);
    does({"session", "demo", "1", "--withdraw", "fell ill"});
    CHECK_THAT(pushed(file, url).out,
               Has("1 of them withdrawn: on the server, too, an event says so"));
    CHECK(told(url, said) == "1");
    CHECK(told(url, kSessions) == "1");
    does({"session", "demo", "1", "--undo", "another one did"});
    does({"participant", "other", "--new", "--consent", "yes"});
    does({"participant", "demo", "--is-really", "other", "--reason", "wrong code"});
    CHECK(pushed(file, url).code == 0);
    CHECK(told(url, kSessions) == "1");
    CHECK(told(url, "participant_code FROM palpate.session") ==
          "demo");  // as it began: events say the rest
    CHECK(told(url, said) == "2");
    CHECK(told(url, "value FROM palpate.event WHERE key = 'is really'") == "other");
    does({"participant", "other", "--destroy", "everything", "--yes", "--reason", "asked"});
    check_end(pushed(file, url), 1, Has("the server has it: an administrator deletes"));
}

TEST_CASE("an older copy brings no session of who refuses, under whosever code it has it") {
    A_SERVER_AND_FILE(server, folder, newer);
    const std::string url = server->url();
    const std::string older = copied(newer, folder.file("older.sqlite"));
    const auto participant = [&](const Words& words) {
        ran(joined({"participant", newer}, words));
    };
    for (const char* code : {"P09", "P10"}) {
        participant({code, "--new", "--consent", "yes"});
    }
    participant({"demo", "--is-really", "P09", "--reason", "typo"});
    const std::string between = copied(newer, folder.file("between.sqlite"));
    participant({"P09", "--consent", "no"});
    CHECK(pushed(newer, url).code == 0);
    for (const std::string& file : {older, between, older}) {
        CAPTURE(file);
        check_end(pushed(file, url), 1, Has("they do not consent, says the server"));
        CHECK(told(url, kSessions) == "0");
    }
    // It was not theirs after all.
    participant({"P09", "--is-really", "P10", "--reason", "another typo"});
    CHECK(pushed(newer, url).code == 0);
    CHECK(told(url, kSessions) == "1");
}

TEST_CASE("an older copy brings no session that was destroyed") {
    A_SERVER_AND_FILE(server, folder, newer);
    for (const char* code : {"P09", "P10"}) {
        ran({"participant", newer, code, "--new", "--consent", "yes"});
    }
    ran({"participant", newer, "demo", "--is-really", "P09", "--reason", "typo"});
    const std::string older = copied(newer, folder.file("older.sqlite"));
    ran({"participant", newer, "P09", "--is-really", "P10", "--reason", "another typo"});
    ran({"participant", newer, "P10", "--destroy", "everything", "--yes", "--reason", "asked"});
    static_cast<void>(pushed(newer, server->url()));
    check_end(pushed(older, server->url()), 1, Has("they do not consent, says the server"));
    CHECK(Postgres(server->url()).rows("SELECT * FROM palpate.session").empty());
}

TEST_CASE("what a file says is of who refused on the server comes by no older copy") {
    A_SERVER_AND_FILE(server, folder, older);
    const std::string refused = folder.file("refused.sqlite");
    ran({"participant", refused, "P09", "--new", "--consent", "no", "--handedness", "40"});
    CHECK(pushed(refused, server->url()).code == 0);
    const std::string newer = copied(older, folder.file("newer.sqlite"));
    ran({"participant", newer, "P09", "--new", "--handedness", "80"});
    ran({"participant", newer, "demo", "--is-really", "P09", "--reason", "badge"});
    for (const std::string& file : {newer, older, newer}) {
        CAPTURE(file);
        check_end(pushed(file, server->url()), 1, Has("they do not consent, says the server"));
        Postgres there(server->url());
        CHECK(there.rows("SELECT 1 FROM palpate.session").empty());
        CHECK(
            there.rows("SELECT 1 FROM palpate.participant_note WHERE key = 'handedness'").empty());
    }
}

TEST_CASE(
    "a score that the server has of who refuses or had it destroyed is named until it is gone") {
    A_SERVER(server);
    const std::string url = server->url();
    const TemporaryFolder folder;
    for (const Words& later : {Words{"--consent", "no"}, Words{"--destroy", "everything", "--yes"},
                               Words{"--destroy", "details", "--yes"}}) {
        CAPTURE(later);
        const std::string code = later[1];
        const std::string file = folder.file(code + ".sqlite");
        const bool refuses = code != "details";
        ran({"participant", file, code, "--new", "--consent", "yes", "--handedness", "80"});
        const std::string older = copied(file, folder.file(code + "-older.sqlite"));
        CHECK(pushed(file, url).code == 0);
        ran(joined({"participant", file, code}, later));
        for (int again = 0; again < 2; ++again) {
            check_end(pushed(file, url), 1,
                      Has("participant " + code + ": the server has their handedness, and " +
                          (refuses ? "they do not consent" : "it was destroyed")));
        }
        if (refuses) {
            check_end(pushed(older, url), 1,
                      Has("their handedness, and they do not consent, says"));
        }
        Postgres admin(url);
        admin.run("DELETE FROM palpate.participant_note WHERE key = 'handedness'");
        CHECK(pushed(file, url).code == 0);
        check_end(pushed(older, url), 1, Has("the server"));
        CHECK(
            admin.rows("SELECT 1 FROM palpate.participant_note WHERE key = 'handedness'").empty());
    }
}

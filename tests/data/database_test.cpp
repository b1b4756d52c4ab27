#include <fstream>
#include <iterator>

#include <sys/stat.h>
#include <unistd.h>

#include "data/store/database.hpp"
#include "data/store/schema.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/process.hpp"
#include "tests/support/studies.hpp"

using namespace palpate;
using Catch::Matchers::ContainsSubstring;
using data::Access;
using data::Database;
using tests::TemporaryFolder;

namespace {

std::string bytes_of(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

}  // namespace

TEST_CASE("a new database says whose it is, and only its owner may read it", "[store]") {
    const TemporaryFolder folder;
    const std::string file = folder.file("a.sqlite");
    {
        Database database(file, Access::write);
        auto id = database.prepare(
            "SELECT application_id, user_version FROM pragma_application_id, pragma_user_version");
        id.step();
        CHECK(id.integer(0) == data::kApplicationId);
        CHECK(id.integer(1) == data::kSchemaVersion);
    }
    struct stat status {};
    REQUIRE(stat(file.c_str(), &status) == 0);
    CHECK((status.st_mode & 0777U) == 0600U);
    CHECK_NOTHROW(Database(file, Access::write));
    CHECK_NOTHROW(Database(file, Access::read));
}

TEST_CASE("a file that is no palpate database is refused and stays as it is", "[store][law]") {
    const TemporaryFolder folder;
    const std::string text = folder.file("notes.txt");
    std::ofstream(text) << std::string(5000, 'x');
    const std::string before = bytes_of(text);
    CHECK_THROWS_WITH(
        Database(text, Access::write),
        ContainsSubstring("notes.txt") && ContainsSubstring("choose another file name"));
    CHECK(bytes_of(text) == before);

    const std::string other = folder.file("other.sqlite");
    tests::Process({"sqlite3", other, "CREATE TABLE theirs (x); INSERT INTO theirs VALUES (1);"})
        .wait();
    const std::string theirs = bytes_of(other);
    CHECK_THROWS_WITH(Database(other, Access::write), ContainsSubstring("not a palpate database"));
    CHECK(bytes_of(other) == theirs);
}

TEST_CASE("a database of a newer program is refused with what to do", "[store]") {
    const TemporaryFolder folder;
    const std::string file = folder.file("a.sqlite");
    { Database(file, Access::write).execute("PRAGMA user_version = 99"); }
    CHECK_THROWS_WITH(Database(file, Access::write),
                      ContainsSubstring("schema 99") && ContainsSubstring("update palpate"));
}

TEST_CASE("a place that cannot be written is named, with the remedy", "[store]") {
    CHECK_THROWS_WITH(
        Database("/nowhere/at/all.sqlite", Access::write),
        ContainsSubstring("/nowhere/at/all.sqlite") && ContainsSubstring("folder exists"));
    const TemporaryFolder folder;
    CHECK_THROWS_WITH(Database(folder.file("absent.sqlite"), Access::read),
                      ContainsSubstring("absent.sqlite"));
    CHECK(folder.names().empty());
}

TEST_CASE("a transaction that is not committed leaves nothing", "[store][law]") {
    const TemporaryFolder folder;
    Database database(folder.file("a.sqlite"), Access::write);
    {
        data::Transaction all(database);
        database.execute("INSERT INTO participant (code) VALUES ('P1')");
    }
    auto count = database.prepare("SELECT count(*) FROM participant");
    count.step();
    CHECK(count.integer(0) == 0);
}

TEST_CASE("the schema refuses what cannot be: kinds, units below zero, orphans, wild names",
          "[store][law]") {
    const TemporaryFolder folder;
    Database database(folder.file("a.sqlite"), Access::write);
    static_cast<void>(data::open_session(database, tests::session_spec(tests::small_protocol())));
    const char* nonsense[] = {
        "INSERT INTO participant (code) VALUES ('Jane Doe')",
        "INSERT INTO participant (code) VALUES ('')",
        "UPDATE session SET kind = 'maybe'",
        "UPDATE session SET rate_hz = 0",
        "UPDATE plan SET mu_s = 0.1, mu_d = 0.5",
        "UPDATE plan SET phase = 'other'",
        "INSERT INTO trial (session, position, attempt, outcome, slip_decay, heal_decay, "
        "started_utc) VALUES (1, 999, 1, 'running', 0, 0, '')",
        "INSERT INTO trial (session, position, attempt, outcome, slip_decay, heal_decay, "
        "started_utc) VALUES (1, 0, 1, 'lost', 0, 0, '')",
        "INSERT INTO response VALUES (77, 0, 'convex', 1, 1.0, 0.0, 'key')",
        "INSERT INTO trace_chunk VALUES (77, 0, 1, 1, 0, x'00')",
        "INSERT INTO event (session, kind, text, at_utc) VALUES (99, 'a', 'b', 'c')",
        "DELETE FROM study",
        "INSERT INTO study (name, title, protocol_sha256, protocol_toml) VALUES ('x', 'y', "
        "'short', '')",
        "UPDATE session SET number = 'one'",
    };
    for (const char* sql : nonsense) {
        CAPTURE(sql);
        CHECK_THROWS_AS(database.execute(sql), data::StoreError);
    }
}

TEST_CASE("a file of an older schema is brought up to date when it is opened for writing",
          "[store]") {
    const TemporaryFolder folder;
    const std::string file = folder.file("old.sqlite");
    {
        Database database(file, Access::write);
        database.execute(
            "ALTER TABLE trial DROP COLUMN skipped_ticks;"
            "ALTER TABLE trial DROP COLUMN worst_episode_j;"
            "ALTER TABLE trial DROP COLUMN contact_episodes; PRAGMA user_version = 1;");
    }
    {
        Database database(file, Access::read);  // as it is
        data::Statement row = database.prepare(
            "SELECT count(*) FROM pragma_table_info('trial')"
            " WHERE name = 'worst_episode_j'");
        REQUIRE(row.step());
        CHECK(row.integer(0) == 0);
    }
    Database database(file, Access::write);
    data::Statement row = database.prepare(
        "SELECT (SELECT user_version FROM pragma_user_version), count(*) FROM "
        "pragma_table_info('trial')"
        " WHERE name IN ('worst_episode_j', 'contact_episodes')");
    REQUIRE(row.step());
    CHECK(row.integer(0) == data::kSchemaVersion);
    CHECK(row.integer(1) == 2);
}

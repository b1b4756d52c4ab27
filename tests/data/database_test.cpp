#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "data/analysis/summary.hpp"
#include "data/store/database.hpp"
#include "data/store/reader.hpp"
#include "data/store/schema.hpp"
#include "data/store/uuid.hpp"
#include "data/trace/codec.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/old_database.hpp"
#include "tests/support/process.hpp"
#include "tests/support/slurp.hpp"
#include "tests/support/studies.hpp"

using namespace palpate;
using Catch::Matchers::ContainsSubstring;
using data::Access;
using data::Database;
using tests::TemporaryFolder;
using tests::write_old;

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
    const std::string before = tests::slurp(text);
    CHECK_THROWS_WITH(
        Database(text, Access::write),
        ContainsSubstring("notes.txt") && ContainsSubstring("choose another file name"));
    CHECK(tests::slurp(text) == before);

    const std::string other = folder.file("other.sqlite");
    tests::Process({"sqlite3", other, "CREATE TABLE theirs (x); INSERT INTO theirs VALUES (1);"})
        .wait();
    const std::string theirs = tests::slurp(other);
    CHECK_THROWS_WITH(Database(other, Access::write), ContainsSubstring("not a palpate database"));
    CHECK(tests::slurp(other) == theirs);
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
                      ContainsSubstring("absent.sqlite: there is no such file"));
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
        "INSERT INTO trace_chunk VALUES (77, 1, 0, 1, 2, 1000000, '', 0, 0, x'00')",
        "INSERT INTO trial (session, position, attempt, outcome, slip_decay, heal_decay, "
        "started_utc, fault) VALUES (1, 0, 1, 'complete', 0, 0, '', 'late')",
        "INSERT INTO fault_tick (trial, tick, time_ns, count_1, count_2, code_1, code_2, flags, "
        "mode, feature) VALUES (77, 0, 0, 0, 0, 0, 0, 0, 0, 0)",
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

namespace {

/// Every table's columns and every view's text.
std::string shape(const std::string& file) {
    const auto ask = [&](const std::string& sql) {
        return tests::Process({"sqlite3", file, sql}).wait().out;
    };
    return ask("SELECT m.name, c.cid, c.name, c.type, c.\"notnull\", c.pk FROM sqlite_master AS m,"
               " pragma_table_info(m.name) AS c ORDER BY 1, 2") +
           ask("SELECT name, sql FROM sqlite_master WHERE type = 'view' ORDER BY 1");
}

/// Version 8 from python3's hashlib: sha256(b"aaa...a P1 1 2026-01-31T12:34:56.789Z").
constexpr const char* kOldUuid = "e955f9b1-8cd4-858b-aa14-f4aa493c425c";

}  // namespace

TEST_CASE(
    "a file of an older schema is as a new one after it was opened for writing, its rows kept",
    "[store][law]") {
    const int version = GENERATE(1, 2, 3, 4);
    CAPTURE(version);
    const TemporaryFolder folder;
    const std::string file = folder.file("old.sqlite");
    write_old(file, version);
    const std::string before = shape(file);
    {
        Database as_it_is(file, Access::read);
        CHECK_THAT(data::summary_text(as_it_is), ContainsSubstring("No main trial"));
    }
    CHECK(shape(file) == before);

    Database database(file, Access::write);
    { const Database fresh(folder.file("new.sqlite"), Access::write); }
    CHECK(shape(file) == shape(folder.file("new.sqlite")));
    data::Statement row = database.prepare(
        "SELECT (SELECT user_version FROM pragma_user_version), trial, cause, ticks_kept FROM "
        "fault");
    REQUIRE(row.step());
    CHECK(row.integer(0) == data::kSchemaVersion);
    CHECK(row.integer(1) == 1);
    CHECK(row.null(2));  // nobody knew then
    CHECK(row.integer(3) == 0);
    CHECK_FALSE(row.step());
    data::Statement plan = database.prepare("SELECT curvature_per_m, object, mu_s FROM plan");
    REQUIRE(plan.step());
    CHECK(plan.real(0) == -2.5);
    CHECK(plan.text(1) == "o");
    CHECK(plan.real(2) == 0.7);
    data::Statement session = database.prepare("SELECT uuid, device FROM session");
    REQUIRE(session.step());
    CHECK(session.text(0) == kOldUuid);
    CHECK(session.text(1) == "d");
    data::Statement orphans = database.prepare("PRAGMA foreign_key_check");
    CHECK_FALSE(orphans.step());
    data::Statement sound = database.prepare("PRAGMA integrity_check");
    REQUIRE(sound.step());
    CHECK(sound.text(0) == "ok");
}

TEST_CASE(
    "a trace of an older schema is read to the bit, before it was brought up to date and after",
    "[store][trace][law]") {
    const int version = GENERATE(1, 2, 3, 4);
    CAPTURE(version);
    const TemporaryFolder folder;
    const std::string file = folder.file("old.sqlite");
    write_old(file, version);
    const auto ticks = tests::random_ticks(3, 5);
    const data::EncodedChunk chunk = data::encode(ticks);
    std::string hex;
    for (const std::byte byte : chunk.data) {
        hex += fmt::format("{:02x}", std::to_integer<unsigned>(byte));
    }
    REQUIRE(tests::Process({"sqlite3", file,
                            fmt::format("INSERT INTO trace_chunk VALUES (1, 0, 5, 1, {}, X'{}')",
                                        chunk.crc32, hex)})
                .wait()
                .code == 0);
    for (const Access access : {Access::read, Access::write, Access::read}) {
        Database database(file, access);
        const auto back = data::read_trace(database, 1);
        REQUIRE(back.size() == ticks.size());
        CHECK(std::equal(back.begin(), back.end(), ticks.begin(), tests::same_bits));
        CHECK(data::TraceReader(database).column(1, data::Stored::count_1).at(4) ==
              ticks[4].counts[0]);
    }
}

TEST_CASE("before a file of an older schema is changed a copy of it is kept, as it was",
          "[store][law]") {
    const int version = GENERATE(1, 4);
    CAPTURE(version);
    const TemporaryFolder folder;
    const std::string file = folder.file("old.sqlite");
    write_old(file, version);
    const std::string before = tests::Process({"sqlite3", file, ".dump"}).wait().out;
    const std::string backup = fmt::format("{}.schema{}.backup", file, version);
    {
        const Database database(file, Access::write);
        CHECK(std::filesystem::equivalent(database.backup(), backup));
    }
    CHECK(tests::Process({"sqlite3", backup, ".dump"}).wait().out == before);
    struct stat status {};
    REQUIRE(stat(backup.c_str(), &status) == 0);
    CHECK((status.st_mode & 0777U) == 0600U);
    CHECK(Database(file, Access::write).backup().empty());  // once is enough

    std::filesystem::remove(file);
    write_old(file, version);
    const std::string copy = tests::slurp(backup);
    CHECK(std::filesystem::equivalent(Database(file, Access::write).backup(), backup + ".2"));
    CHECK(tests::slurp(backup) == copy);
}

TEST_CASE("a file of an older schema whose copy cannot be kept stays as it is", "[store][law]") {
    const TemporaryFolder folder;
    const std::string file = folder.file("old.sqlite");
    write_old(file, 4);
    const std::string before = tests::slurp(file);
    std::filesystem::create_directory(file +
                                      ".schema4.backup.part");  // nothing can be written there
    CHECK_THROWS_WITH(Database(file, Access::write),
                      ContainsSubstring("old.sqlite.schema4.backup") && ContainsSubstring("free"));
    CHECK(tests::slurp(file) == before);
}

TEST_CASE("names of sessions are UUIDs, random for new ones and the same for the same old one",
          "[store][law]") {
    std::set<std::string> all;
    for (int i = 0; i < 1000; ++i) {
        const std::string uuid = data::random_uuid();
        CAPTURE(uuid);
        REQUIRE(uuid.size() == 36);
        REQUIRE(uuid.find_first_not_of("0123456789abcdef-") == std::string::npos);
        REQUIRE((uuid[8] == '-' && uuid[13] == '-' && uuid[18] == '-' && uuid[23] == '-'));
        REQUIRE(uuid[14] == '4');
        REQUIRE(std::string("89ab").find(uuid[19]) != std::string::npos);
        REQUIRE(all.insert(uuid).second);
    }
    // sha256sum: ba7816bf 8f01 cfea 4141 40de5dae2223... (FIPS 180-4, "abc"), version 8, variant 10
    CHECK(data::derived_uuid("abc") == "ba7816bf-8f01-8fea-8141-40de5dae2223");
}

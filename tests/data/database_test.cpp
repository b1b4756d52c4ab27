#include <sys/stat.h>

#include "protocols/design/counterbalance.hpp"
#include "data/schema/catalogue.hpp"
#include "data/store/reader.hpp"
#include "data/store/row.hpp"
#include "data/store/uuid.hpp"
#include "tests/support/child.hpp"
#include "tests/support/program.hpp"
#include "tests/support/studies.hpp"

using namespace palpate::data;

TEST_CASE("a new database says whose it is, and only its owner may read it") {
    const TemporaryFile file("a.sqlite");
    {
        Database database(file, Access::write);
        auto id = database.first(
            "SELECT application_id, user_version FROM pragma_application_id, pragma_user_version");
        CHECK(id.integer(0) == data::kApplicationId);
        CHECK(id.integer(1) == data::kSchemaVersion);
    }
    struct stat status {};
    REQUIRE(stat(file.c_str(), &status) == 0);
    CHECK((status.st_mode & 0777U) == 0600U);
    CHECK_NOTHROW(Database(file, Access::write));
    CHECK_NOTHROW(Database(file, Access::read));
}

TEST_CASE("a database of another schema is refused by every command, and stays as it is") {
    EACH(version, 0, 2, 5, 99);
    const TemporaryFolder folder;
    const std::string file = folder.file("a.sqlite");
    {
        Database(file, Access::write)
            .execute(fmt::format("PRAGMA user_version = {}", version).c_str());
    }
    const std::string before = slurp(file);
    const std::string why =
        version == 0 ? "not a palpate database" : fmt::format("schema {}", version);
    CHECK_THROWS_WITH(Database(file, Access::write), Has(why));
    for (const Words& words : {run_words("shape_friction", "P1", file, {"--headless"}),
                               {"summary", file},
                               {"verify", file},
                               {"sql", file, "-c", "SELECT 1"},
                               {"note", file, "x", "--participant", "P1"},
                               {"merge", folder.file("all.sqlite"), file},
                               {"export", file, "--format", "csv", "-o", folder.file("out")}}) {
        CAPTURE(words.front());
        CHECK_THAT(ran(words, 2).error, Has(why));
    }
    CHECK(slurp(file) == before);
    for (const std::string& name : folder.names()) {
        CHECK_THAT(name, StartsWith("a.sqlite"));  // SQLite's own beside it
    }
}

TEST_CASE("a place that cannot be written is named, with the remedy") {
    CHECK_THROWS_WITH(Database("/nowhere/at/all.sqlite", Access::write),
                      Has("/nowhere/at/all.sqlite", "folder exists"));
    const TemporaryFolder folder;
    CHECK_THROWS_WITH(Database(folder.file("absent.sqlite"), Access::read),
                      Has("absent.sqlite: there is no such file"));
    CHECK(folder.names().empty());
}

TEST_CASE("a transaction that is not committed leaves nothing") {
    NewDatabase database;
    {
        data::Transaction all(database);
        database.execute("INSERT INTO participant (participant_code, subject) VALUES ('P1', 1)");
    }
    CHECK(count(database, "participant") == 0);
}

TEST_CASE("the schema refuses what cannot be: kinds, units below zero, orphans, wild names") {
    NewDatabase database;
    static_cast<void>(data::open_session(database, session_spec(small_protocol())));
    for (const std::string& sql : lines_in(test_text("edits/nonsense.sql"))) {
        CAPTURE(sql);
        CHECK_THROWS_AS(database.execute(sql.c_str()), data::StoreError);
    }
}

TEST_CASE("names of sessions are random UUIDs") {
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
}

TEST_CASE("a statement that is asked again keeps nothing of the time before") {
    NewDatabase database;
    const auto value = [&](std::optional<std::int64_t> bound) {
        auto row = database.prepare("SELECT ?1");
        if (bound) {
            row.bind(1, *bound);
        }
        row.step();  // and is left in the middle
        return row.null(0) ? -1 : row.integer(0);
    };
    CHECK(value(7) == 7);
    CHECK(value(std::nullopt) == -1);
    {
        auto outer = database.prepare("SELECT name FROM sqlite_schema ORDER BY name");
        auto inner = database.prepare("SELECT name FROM sqlite_schema ORDER BY name");
        REQUIRE((outer.step() && outer.step() && inner.step()));
        CHECK(inner.text(0) < outer.text(0));
    }
    const auto columns = [&] {
        auto row = database.prepare("SELECT * FROM later");
        return row.step() ? row.columns() : 0;
    };
    database.execute("CREATE TABLE later (a); INSERT INTO later VALUES (1)");
    CHECK(columns() == 1);
    database.execute("ALTER TABLE later ADD COLUMN b");
    CHECK(columns() == 2);
    for (int i = 0; i < 300; ++i) {
        CHECK(database.prepare(fmt::format("SELECT {}", i)).step());
    }
    database.execute("DROP TABLE later");
    CHECK_THROWS_AS(columns(), data::StoreError);
    CHECK_NOTHROW(database.checkpoint());
}

namespace {

/// Runs `work` in `programs` child processes, which all begin at once.
/// @returns how many ended well
template <class Work>
int at_once(int programs, const Work& work) {
    int gate[2];
    REQUIRE(pipe(gate) == 0);
    std::vector<pid_t> children;
    for (int i = 0; i < programs; ++i) {
        children.push_back(in_a_child([&] {
            close(gate[1]);
            char opened = 0;
            static_cast<void>(!read(gate[0], &opened, 1));  // until the parent closes its end
            try {
                work(i);
            } catch (const std::exception& e) {
                std::fprintf(stderr, "%s\n", e.what());
                _exit(1);
            }
        }));
    }
    close(gate[0]);
    close(gate[1]);
    int well = 0;
    for (const pid_t child : children) {
        int status = 0;
        waitpid(child, &status, 0);
        well += WIFEXITED(status) && WEXITSTATUS(status) == 0 ? 1 : 0;
    }
    return well;
}

}  // namespace

TEST_CASE("programs that make one database at the same time all get it") {
    constexpr int kPrograms = 4;
    constexpr int kRounds = 8;
    for (int round = 0; round < kRounds; ++round) {
        CAPTURE(round);
        const TemporaryFile file("a.sqlite");
        REQUIRE(at_once(kPrograms, [&](int i) {
                    Database database(file, Access::write);
                    const auto spec =
                        session_spec(small_protocol(), std::string("P").append(std::to_string(i)));
                    static_cast<void>(data::open_session(database, spec));
                }) == kPrograms);
        Database database(file, Access::read);
        CHECK(count(database, "session") == kPrograms);
        CHECK(count(database, "study") == 1);
    }
}

TEST_CASE(
    "rigs that begin at the same moment take rows of the pictures as one after the other would") {
    constexpr int kRounds = 8;
    const protocols::Protocol protocol = small_protocol();
    const auto rigs = static_cast<int>(picture_rows(protocol).size());
    for (int round = 0; round < kRounds; ++round) {
        CAPTURE(round);
        const TemporaryFile file("a.sqlite");
        Database database(file, Access::write);
        REQUIRE(at_once(rigs, [&](int i) {
                    Database rig(file, Access::write);
                    auto spec = session_spec(protocol, std::string("P").append(std::to_string(i)));
                    spec.kind = data::RunKind::real;
                    const auto opened = data::plan_and_open_session(rig, spec);
                    // Whoever leaves before the first trial gives the row back: all stay.
                    for (int tries = 0; tries < 20000 && count(rig, "session") < rigs; ++tries) {
                        usleep(1000);
                    }
                }) == rigs);
        CHECK(count(database,
                    "(SELECT DISTINCT group_concat(picture_object) FROM (SELECT * FROM picture "
                    "ORDER BY session_id, picture_place) GROUP BY session_id)") == rigs);
    }
}

TEST_CASE("a row is written by the names of its columns, and no other name") {
    NewDatabase database;
    data::Row("participant").set("participant_code", "P1").set("subject", 7).insert(database);
    CHECK_THROWS_WITH(data::Row("participant").set("mood", "calm"),
                      Has("no column participant.mood"));
    CHECK(data::Row("participant")
              .set("participant_code", "P1")
              .set("consent", true)
              .update(database, {"participant_code"}) == 1);
    CHECK(database.first("SELECT consent || subject FROM participant").text(0) == "17");
    CHECK_THROWS_AS(data::Row("participant").set("subject", 8).insert(database), data::StoreError);
}

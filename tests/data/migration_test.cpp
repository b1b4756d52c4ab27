#include "data/schema/catalogue.hpp"
#include "data/store/own_schema.hpp"
#include "data/store/row.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/process.hpp"

using namespace palpate::data;

namespace {

std::string answer(Database& database, const char* sql) {
    return database.first(sql).text(0);
}

/// A file of schema 1 with somebody in it.
std::string old_file(const TemporaryFolder& folder) {
    std::string file = folder.file("a.sqlite");
    Database database(file, Access::write);
    data::Row("participant").set("participant_code", "P1").set("subject", 7).insert(database);
    return file;
}

const MigrationStep kMood{
    2, "ALTER TABLE participant ADD COLUMN mood TEXT; UPDATE participant SET mood = 'calm';"};

}  // namespace

TEST_CASE("an older file is copied, then all steps are taken and its views made anew",
          "[store][migration]") {
    const TemporaryFolder folder;
    const std::string file = old_file(folder);
    Database database(file, Access::write);
    const MigrationStep steps[] = {kMood, {3, "UPDATE participant SET mood = mood || '!'"}};
    const std::string copy = data::migrate(database.connection(), steps);
    CHECK(copy == file + ".schema-1.sqlite");
    CHECK(answer(database, "PRAGMA user_version") == "3");
    CHECK(answer(database, "SELECT participant_code || mood FROM participant") == "P1calm!");
    CHECK(answer(database, "SELECT count(*) FROM analysis_trial") == "0");
    Database before(copy, Access::read);  // this program's own schema, with all that was in it
    CHECK(answer(before, "SELECT participant_code FROM participant") == "P1");
    CHECK(data::migrate(database.connection(), steps).empty());  // it is not older any more
}

TEST_CASE("a step that fails leaves the file as it was, and its copy", "[store][migration][law]") {
    const TemporaryFolder folder;
    const std::string file = old_file(folder);
    Database database(file, Access::write);
    const auto wrong = GENERATE(as<const char*>{}, "UPDATE nothing SET x = 1",
                                "INSERT INTO participant_detail VALUES (99, 'age', '3')",
                                "DROP TABLE trial");  // the views need it
    const MigrationStep steps[] = {kMood, {3, wrong}};
    CAPTURE(wrong);
    CHECK_THROWS_AS(data::migrate(database.connection(), steps), data::StoreError);
    CHECK(answer(database, "PRAGMA user_version") == "1");
    CHECK(answer(database,
                 "SELECT count(*) FROM pragma_table_info('participant') WHERE name = 'mood'") ==
          "0");
    CHECK(answer(database, "SELECT count(*) FROM analysis_trial") == "0");
    CHECK(std::filesystem::exists(file + ".schema-1.sqlite"));
    CHECK_THROWS_WITH(data::migrate(database.connection(), steps), Has("move it away"));
}

TEST_CASE("no file is led over a gap, and nothing was released yet", "[store][migration]") {
    const TemporaryFolder folder;
    Database database(old_file(folder), Access::write);
    const MigrationStep steps[] = {{3, ""}};
    CHECK_THROWS_WITH(data::migrate(database.connection(), steps),
                      Has("no step leads on from schema 1"));
    CHECK(data::migration_steps().empty());
    CHECK(data::kSchemaVersion == 1);
}

TEST_CASE("a row is written by the names of its columns, and no other name", "[store]") {
    const TemporaryFolder folder;
    Database database(old_file(folder), Access::write);
    CHECK_THROWS_WITH(data::Row("participant").set("mood", "calm"),
                      Has("no column participant.mood"));
    CHECK(data::Row("participant")
              .set("participant_code", "P1")
              .set("consent", true)
              .update(database, {"participant_code"}) == 1);
    CHECK(answer(database, "SELECT consent || subject FROM participant") == "17");
    CHECK_THROWS_AS(data::Row("participant").set("subject", 8).insert(database), data::StoreError);
}

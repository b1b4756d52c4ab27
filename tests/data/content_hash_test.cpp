#include "data/store/sqlite_recorder.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/content_hash.hpp"
#include "tests/support/process.hpp"
#include "tests/support/studies.hpp"
#include "tests/support/test_text.hpp"

using namespace palpate;
using namespace palpate::data;
using tests::TemporaryFolder;

namespace {

void fill(Database& database, std::uint64_t seed) {
    auto spec = tests::session_spec(tests::small_protocol());
    spec.provenance = {{"run", std::to_string(seed)}};  // differs, and must not matter
    const auto opened = data::open_session(database, spec);
    data::SqliteRecorder recorder(database, spec.protocol, opened.id);
    for (const auto& planned : spec.plan.trials) {
        const auto id = tests::begin_trial(recorder, spec.protocol, planned);
        recorder.append(id, tests::random_ticks(planned.position, 4500));
        recorder.end_trial(id, tests::answered(0, planned.condition.object == 0, 4500));
    }
    recorder.event({.text = "a test"});
    recorder.finish_session();
}

}  // namespace

TEST_CASE("two equal sessions have one hash, whatever the clock and the machine's versions",
          "[store][law]") {
    const TemporaryFolder folder;
    Database a(folder.file("a.sqlite"), Access::write);
    Database b(folder.file("b.sqlite"), Access::write);
    fill(a, 1);
    fill(b, 2);
    CHECK(tests::content_hash(a) == tests::content_hash(b));
    a.execute("UPDATE trial SET started_utc = 'yesterday'; VACUUM");
    CHECK(tests::content_hash(a) == tests::content_hash(b));
}

TEST_CASE("any change of what was recorded changes the hash", "[store][law]") {
    const TemporaryFolder folder;
    Database database(folder.file("a.sqlite"), Access::write);
    fill(database, 1);
    const std::string before = tests::content_hash(database);
    for (const std::string& sql : tests::lines_in(tests::test_text("edits/hashed.sql"))) {
        CAPTURE(sql);
        database.execute("SAVEPOINT edit");
        database.execute(sql.c_str());
        CHECK(tests::content_hash(database) != before);
        database.execute("ROLLBACK TO edit; RELEASE edit");
    }
    CHECK(tests::content_hash(database) == before);
}

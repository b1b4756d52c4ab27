#include "tests/support/catch.hpp"
#include "tests/support/studies.hpp"
#include "tests/support/test_text.hpp"

using namespace palpate::data;

namespace {

struct Filled : SmallSession {
    Filled() {
        for (const auto& planned : spec.plan.trials) {
            record(planned.position, answered(0, planned.condition.object == 0, 4500),
                   random_ticks(planned.position, 4500));
        }
        recorder.event({.text = "a test"});
        recorder.finish_session();
    }
};

}  // namespace

TEST_CASE("two equal sessions have one hash, whatever the clock and the machine's versions") {
    Filled a;
    Filled b;
    CHECK(content_hash(a.database) == content_hash(b.database));
    a.database.execute(
        "UPDATE trial SET started_utc = 'yesterday'; UPDATE session_provenance SET value = 'x'; "
        "VACUUM");
    CHECK(content_hash(a.database) == content_hash(b.database));
}

TEST_CASE("any change of what was recorded changes the hash") {
    Filled filled;
    Database& database = filled.database;
    const std::string before = content_hash(database);
    for (const std::string& sql : lines_in(test_text("edits/hashed.sql"))) {
        CAPTURE(sql);
        database.execute("SAVEPOINT edit");
        database.execute(sql.c_str());
        CHECK(content_hash(database) != before);
        database.execute("ROLLBACK TO edit; RELEASE edit");
    }
    CHECK(content_hash(database) == before);
}

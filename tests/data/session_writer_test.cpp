#include "tests/support/catch.hpp"
#include "tests/support/content_hash.hpp"
#include "tests/support/studies.hpp"

using namespace palpate::data;

namespace {

std::string outcomes(Database& database) {
    auto row = database.first(
        "SELECT group_concat(outcome), (SELECT count(*) FROM event) FROM trial ORDER BY trial_id");
    return row.text(0) + ", events " + row.text(1);
}

/// From its first trial on a session is what it was begun as.
void begin(Database& database, const data::SessionSpec& spec, std::int64_t session) {
    data::SqliteRecorder recorder(database, spec.protocol, session);
    static_cast<void>(tests::begin_trial(recorder, spec.protocol, spec.plan.trials[0]));
}

}  // namespace

TEST_CASE("a session that somebody runs is refused, and its running trial goes on running",
          "[store][law]") {
    const TemporaryFolder folder;
    Database rig(folder.file("a.sqlite"), Access::write);
    const auto spec = tests::session_spec(tests::small_protocol());
    const std::int64_t session = data::open_session(rig, spec).id;
    const data::SessionLock lock(rig, session);
    data::SqliteRecorder recorder(rig, spec.protocol, session);
    const auto trial = tests::begin_trial(recorder, spec.protocol, spec.plan.trials[0]);
    recorder.append(trial, tests::random_ticks(1, 300));
    const std::string before = tests::content_hash(rig);

    Database second(folder.file("a.sqlite"), Access::write);
    auto elsewhere = spec;
    elsewhere.device = "another device";
    CHECK_THROWS_WITH(data::open_session(second, spec), Has("another palpate"));
    CHECK_THROWS_WITH(data::open_session(second, elsewhere), Has("another palpate"));
    CHECK_THROWS_WITH(data::open_session(rig, spec), Has("another palpate"));

    CHECK(outcomes(rig) == "running, events 0");
    CHECK(tests::content_hash(rig) == before);
    CHECK_NOTHROW(recorder.end_trial(trial, tests::answered(0, true, 300)));
    CHECK(outcomes(rig) == "complete, events 0");
}

TEST_CASE("an opened session has its writer from before it can be seen until it is let go",
          "[store][law]") {
    const TemporaryFolder folder;
    Database first(folder.file("a.sqlite"), Access::write);
    Database second(folder.file("a.sqlite"), Access::write);
    const auto spec = tests::session_spec(tests::small_protocol());
    for (const bool resumed : {false, true}) {
        CAPTURE(resumed);
        const auto opened = data::open_session(first, spec);
        CHECK(opened.resumed == resumed);
        CHECK_THROWS_WITH(data::open_session(second, spec), Has("another palpate"));
        CHECK_THROWS_WITH(data::SessionLock(second, opened.id), Has("another palpate"));
    }
    CHECK_NOTHROW(data::open_session(second, spec));
    CHECK(outcomes(first) == ", events 0");
}

TEST_CASE("a session that cannot go on is let go", "[store][law]") {
    const TemporaryFolder folder;
    Database database(folder.file("a.sqlite"), Access::write);
    const auto spec = tests::session_spec(tests::small_protocol());
    const std::int64_t session = data::open_session(database, spec).id;
    begin(database, spec, session);
    auto real = spec;
    real.kind = data::RunKind::real;
    CHECK_THROWS_WITH(data::open_session(database, real), Has("simulated session"));
    CHECK_NOTHROW(data::SessionLock(database, session));
}

// A plan's hash tells its seed, so a plan that was made from another seed is refused by its hash.
// What is refused here is a caller who gives the plan of one seed and the hand and answers of
// another.
TEST_CASE("a session goes on only with its own seed, also when the order is the same",
          "[store][law]") {
    const TemporaryFolder folder;
    Database database(folder.file("a.sqlite"), Access::write);
    const auto spec = tests::session_spec(tests::small_protocol());
    begin(database, spec, data::open_session(database, spec).id);
    static_cast<void>(data::open_session(database, spec));
    const std::string before = tests::content_hash(database);
    for (const std::uint64_t seed : {spec.seed + 1, ~std::uint64_t{0}, std::uint64_t{0}}) {
        CAPTURE(seed);
        auto seeded = spec;
        seeded.seed = seed;
        CHECK_THROWS_WITH(data::open_session(database, seeded), Has("seed 7", "--seed"));
    }
    CHECK(tests::content_hash(database) == before);
    CHECK_NOTHROW(data::open_session(database, spec));
}

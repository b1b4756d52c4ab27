#include "tests/support/program.hpp"
#include "tests/support/sql_first.hpp"
#include "tests/support/studies.hpp"

namespace {

std::string hash_of(const std::string& file) {
    data::Database database(file, data::Access::read);
    return content_hash(database);
}

std::string demo_hash(const std::string& file, const std::string& seed) {
    ran({"demo", "--headless", "--db", file, "--seed", seed});
    return hash_of(file);
}

}  // namespace

// The golden hash is this program's own, of its first release build: it holds for every build type,
// sanitizer and x86-64 machine, or a recorded trace would not replay there. It changes only with
// the stimulus, the law, the schedule, the schema or the demo's secret, and whoever changes one of
// these writes it anew.
TEST_CASE("same seed, same plan, same content: in two runs, and in every build") {
    const TemporaryFolder folder;
    const std::string first = demo_hash(folder.file("a.sqlite"), "1");
    CHECK(demo_hash(folder.file("b.sqlite"), "1") == first);
    CHECK(demo_hash(folder.file("c.sqlite"), "2") != first);
    CHECK(first == "82e0d89f6f25560ad8f266dad4f198efbae3ed583bb79b56c1bef7a418e268c6");
}

TEST_CASE("a wall clock that jumps by days while a session runs changes nothing but its dates") {
    const TemporaryFolder folder;
    const auto hash = [&](const std::string& file, const Words& environment) {
        ended(Process({palpate_program(), "demo", "--headless", "--speed", "20", "--db", file,
                       "--seed", "1"},
                      environment)
                  .wait());
        ran({"verify", file});
        CHECK((sql_first(file, "SELECT count(DISTINCT date(started_utc)) > 2 FROM trial") == "1") ==
              !environment.empty());
        return hash_of(file);
    };
    CHECK(hash(folder.file("a.sqlite"),
               {"LD_PRELOAD=" PALPATE_JUMPING_CLOCK, "ASAN_OPTIONS=verify_asan_link_order=0"}) ==
          hash(folder.file("b.sqlite"), {}));
    sql_edit(folder.file("a.sqlite"), "UPDATE session SET started_utc = '2999-01-01T00:00:00Z'");
    CHECK(sql_first(folder.file("a.sqlite"), "SELECT duration_s IS NULL FROM session_health") ==
          "1");  // set back: nobody knows how long it took
}

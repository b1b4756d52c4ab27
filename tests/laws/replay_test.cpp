#include "data/store/reader.hpp"
#include "tests/support/program.hpp"
#include "tests/support/short_text.hpp"
#include "tests/support/sql_first.hpp"
#include "tests/support/studies.hpp"

namespace {

Words run(const std::string& study, const std::string& file, const std::string& device) {
    return run_words(study, "P1", file, {"--headless", "--device", device});
}

/// A study in the plane, or the shipped patches in space, each condition once.
std::string study_in(const TemporaryFolder& folder, bool space) {
    return space ? write(folder.file("patches.toml"),
                         short_text("patch_friction",
                                    {{"repetitions = 5", "repetitions = 1"},
                                     {"practice_repetitions = 1", "practice_repetitions = 0"}}))
                 : "shape_friction_demo";
}

std::string hash_of(const std::string& file) {
    data::Database database(file, data::Access::read);
    return content_hash(database);
}

std::string demo_hash(const std::string& file, const std::string& seed) {
    ran({"demo", "--headless", "--db", file, "--seed", seed});
    return hash_of(file);
}

}  // namespace

TEST_CASE("a session on a replayed hand feels and answers as the recorded one") {
    EACH(space, false, true);
    const TemporaryFolder folder;
    const std::string study = study_in(folder, space);
    const std::string first = folder.file("a.sqlite");
    const std::string second = folder.file("b.sqlite");
    ran(run(study, first, "sim"));
    ran(run(study, second, "replay:" + first));
    data::Database a(first, data::Access::read);
    data::Database b(second, data::Access::read);
    const auto trials_a = data::answered_trials(a);
    const auto trials_b = data::answered_trials(b);
    REQUIRE(trials_a.size() == (space ? 8 : 10));
    REQUIRE(trials_b.size() == trials_a.size());
    for (std::size_t i = 0; i < trials_a.size(); ++i) {
        const auto one = data::TraceReader(a).read(trials_a[i]);
        const auto two = data::TraceReader(b).read(trials_b[i]);
        REQUIRE(one.size() == two.size());
        for (std::size_t k = 0; k < one.size(); ++k) {
            REQUIRE(std::memcmp(&one[k].force, &two[k].force, sizeof one[k].force) == 0);
            REQUIRE(std::memcmp(&one[k].hip, &two[k].hip, sizeof one[k].hip) == 0);
        }
    }
    const auto choices = [](data::Database& database) {
        return database
            .first(
                "SELECT group_concat(chosen_object) FROM (SELECT chosen_object FROM analysis_trial "
                "WHERE counts ORDER BY plan_position)")
            .text(0);
    };
    CHECK(choices(a) == choices(b));
}

TEST_CASE("one named trial can be replayed for all") {
    const TemporaryFolder folder;
    const std::string first = folder.file("a.sqlite");
    const std::string demo = study_in(folder, false);
    ran(run(demo, first, "sim"));
    ran(run(demo, folder.file("b.sqlite"), "replay:" + first + ":3"));
    CHECK_THAT(ran(run(demo, folder.file("c.sqlite"), "replay:" + first + ":333"), 2).error,
               Has("no trial 333"));
}

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

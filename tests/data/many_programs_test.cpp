#include "protocols/design/counterbalance.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/child.hpp"
#include "tests/support/studies.hpp"

using namespace palpate::data;

namespace {

/// Runs `work` in `programs` child processes, which all begin at once.
/// @returns how many ended well
template <class Work>
int at_once(int programs, const Work& work) {
    int gate[2];
    REQUIRE(pipe(gate) == 0);
    const pid_t test = getpid();
    std::vector<pid_t> children;
    for (int i = 0; i < programs; ++i) {
        const pid_t child = fork();
        if (child == 0) {
            tests::die_with(test);
            close(gate[1]);
            char opened = 0;
            static_cast<void>(!read(gate[0], &opened, 1));  // until the parent closes its end
            try {
                work(i);
            } catch (const std::exception& e) {
                std::fprintf(stderr, "%s\n", e.what());
                _exit(1);
            }
            _exit(0);
        }
        children.push_back(child);
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

std::int64_t number(Database& database, const char* sql) {
    return database.first(sql).integer(0);
}

}  // namespace

TEST_CASE("programs that make one database at the same time all get it", "[store][law]") {
    constexpr int kPrograms = 4;
    constexpr int kRounds = 8;
    for (int round = 0; round < kRounds; ++round) {
        CAPTURE(round);
        const TemporaryFolder folder;
        const std::string file = folder.file("a.sqlite");
        REQUIRE(at_once(kPrograms, [&](int i) {
                    Database database(file, Access::write);
                    const auto spec = tests::session_spec(
                        tests::small_protocol(), std::string("P").append(std::to_string(i)));
                    static_cast<void>(data::open_session(database, spec));
                }) == kPrograms);
        Database database(file, Access::read);
        CHECK(number(database, "SELECT count(*) FROM session") == kPrograms);
        CHECK(number(database, "SELECT count(*) FROM study") == 1);
    }
}

TEST_CASE(
    "rigs that begin at the same moment take rows of the pictures as one after the other would",
    "[store][law]") {
    constexpr int kRounds = 8;
    constexpr const char* kSessions = "SELECT count(*) FROM session";
    const protocols::Protocol protocol = tests::small_protocol();
    const auto rigs = static_cast<int>(picture_rows(protocol).size());
    for (int round = 0; round < kRounds; ++round) {
        CAPTURE(round);
        const TemporaryFolder folder;
        const std::string file = folder.file("a.sqlite");
        Database database(file, Access::write);
        REQUIRE(at_once(rigs, [&](int i) {
                    Database rig(file, Access::write);
                    auto spec =
                        tests::session_spec(protocol, std::string("P").append(std::to_string(i)));
                    spec.kind = data::RunKind::real;
                    const auto opened = data::plan_and_open_session(rig, spec);
                    // Whoever leaves before the first trial gives the row back: all stay.
                    for (int tries = 0; tries < 20000 && number(rig, kSessions) < rigs; ++tries) {
                        usleep(1000);
                    }
                }) == rigs);
        CHECK(number(database,
                     "SELECT count(DISTINCT o) FROM (SELECT group_concat(picture_object) AS o FROM "
                     "(SELECT * FROM picture ORDER BY session_id, picture_place) GROUP BY "
                     "session_id)") == rigs);
    }
}

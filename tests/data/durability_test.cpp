#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <thread>

#include <sys/wait.h>
#include <unistd.h>

#include "data/store/async_recorder.hpp"
#include "data/store/chain.hpp"
#include "data/store/disk_space.hpp"
#include "data/store/people.hpp"
#include "data/store/reader.hpp"
#include "data/store/sqlite_recorder.hpp"
#include "data/verify/verify.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/process.hpp"
#include "tests/support/studies.hpp"

using namespace palpate;
using Catch::Matchers::ContainsSubstring;
using data::Access;
using data::Database;
using tests::TemporaryFolder;
using namespace std::chrono_literals;

namespace {

/// A servo of 1 kHz, as one sees it from outside: says on `pipe` the number of each tick that it made.
[[noreturn]] void record_in_real_time(const std::string& file,
                                      const data::SessionSpec& spec,
                                      int pipe) {
    Database database(file, Access::write);
    const auto opened = data::open_session(database, spec);
    data::SqliteRecorder disk(database, spec.protocol, opened.id);
    data::AsyncRecorder recorder(disk);
    const auto id = recorder.begin_trial(spec.plan.trials[opened.next], {});
    const auto start = std::chrono::steady_clock::now();
    for (std::int64_t tick = 0;; ++tick) {
        std::this_thread::sleep_until(start + tick * 1ms);
        recorder.append(id, tests::random_ticks(1, 1, tick));
        const auto at = std::chrono::steady_clock::now().time_since_epoch().count();
        static_cast<void>(!write(pipe, &at, sizeof at));
    }
}

struct Killed {
    std::vector<std::int64_t> made;  ///< when each tick was made, ns of the steady clock
    std::int64_t at = 0;
};

Killed record_and_kill(const std::string& file, const data::SessionSpec& spec, std::size_t ticks) {
    int ends[2];
    REQUIRE(pipe(ends) == 0);
    const pid_t child = fork();
    if (child == 0) {
        close(ends[0]);
        record_in_real_time(file, spec, ends[1]);
    }
    close(ends[1]);
    Killed killed;
    std::int64_t at = 0;
    while (killed.made.size() < ticks && read(ends[0], &at, sizeof at) == sizeof at) {
        killed.made.push_back(at);
    }
    killed.at = std::chrono::steady_clock::now().time_since_epoch().count();
    kill(child, SIGKILL);
    close(ends[0]);
    waitpid(child, nullptr, 0);
    return killed;
}

void wait_for_ticks(const std::string& file, std::int64_t ticks) {
    Database reader(file, Access::read);
    for (int i = 0; i < 1000; ++i) {
        auto row = reader.prepare("SELECT coalesce(sum(ticks), 0) FROM trace_chunk");
        row.step();
        if (row.integer(0) >= ticks) {
            return;
        }
        std::this_thread::sleep_for(2ms);
    }
    FAIL("the ticks were not saved");
}

std::string findings_of(Database& database) {
    const data::Verification found = data::verify(database);
    std::string text;
    const auto add = [&text](const std::vector<data::Finding>& findings) {
        for (const data::Finding& one : findings) {
            text += one.what + ' ' + one.stored + ' ' + one.recomputed + '\n';
        }
    };
    add(found.file);
    for (const auto& session : found.sessions) {
        add(session.findings);
    }
    return text;
}

}  // namespace

TEST_CASE("kill -9 in a trial: of what the recorder had for 120 ms every tick is there, in order",
          "[store][law]") {
    const auto seed = GENERATE(range(std::uint64_t{0}, std::uint64_t{6}));
    CAPTURE(seed);
    tests::Random random(seed);
    const TemporaryFolder folder;
    const std::string file = folder.file("a.sqlite");
    const auto spec = tests::session_spec(tests::small_protocol());
    const Killed killed =
        record_and_kill(file, spec, 1100 + static_cast<std::size_t>(random.below(300)));

    Database database(file, Access::write);
    auto check = database.prepare("PRAGMA integrity_check");
    check.step();
    CHECK(check.text(0) == "ok");
    check.reset();
    const auto opened = data::open_session(database, spec);
    CHECK(opened.interrupted == 1);
    CHECK(opened.next == 0);
    auto trial = database.prepare("SELECT id FROM trial WHERE outcome = 'interrupted'");
    REQUIRE(trial.step());
    const auto ticks = data::stored_ticks(database, trial.integer(0));
    for (std::size_t i = 0; i < ticks.size(); ++i) {
        REQUIRE(
            tests::same_bits(ticks[i], tests::random_ticks(1, 1, static_cast<std::int64_t>(i))[0]));
    }
    // A disk that others use takes its time: on a quiet machine the limit is 120 ms.
    const double oldest = ticks.size() < killed.made.size()
                            ? static_cast<double>(killed.at - killed.made[ticks.size()]) * 1e-6
                            : 0.0;
    CAPTURE(oldest);
    CHECK(oldest < 1000.0);
}

TEST_CASE("a lock of another program keeps no tick and no answer back for good", "[store][law]") {
    const TemporaryFolder folder;
    const std::string file = folder.file("a.sqlite");
    const auto spec = tests::session_spec(tests::small_protocol());
    Database database(file, Access::write);
    const auto session = data::open_session(database, spec).id;
    data::SqliteRecorder disk(database, spec.protocol, session);
    data::AsyncRecorder recorder(disk, 5ms);
    const auto id = recorder.begin_trial(spec.plan.trials[0], {});
    const auto ticks = tests::random_ticks(1, 9000);
    Database analyst(file, Access::write);
    analyst.execute("BEGIN IMMEDIATE");
    for (std::size_t i = 0; i < ticks.size(); i += 100) {
        recorder.append(id, std::span(ticks).subspan(i, 100));
        CHECK_FALSE((i == 5000 && recorder.save()));  // it waits, and does not fail
    }
    std::thread ends([&] {
        std::this_thread::sleep_for(300ms);
        analyst.execute("COMMIT");
    });
    recorder.end_trial(id, tests::answered(0, true, 9000));
    ends.join();
    const auto stored = data::read_trace(database, id);
    REQUIRE(stored.size() == ticks.size());
    CHECK(std::equal(stored.begin(), stored.end(), ticks.begin(), tests::same_bits));
    auto row = analyst.prepare("SELECT count(*) FROM response");
    row.step();
    CHECK(row.integer(0) == 1);
}

TEST_CASE("ticks that come slowly are saved by the clock, not by their number", "[store][law]") {
    const TemporaryFolder folder;
    const std::string file = folder.file("a.sqlite");
    const auto spec = tests::session_spec(tests::small_protocol());
    Database database(file, Access::write);
    const auto session = data::open_session(database, spec).id;
    data::SqliteRecorder disk(database, spec.protocol, session);
    data::AsyncRecorder recorder(disk, 5ms);
    const auto id = recorder.begin_trial(spec.plan.trials[0], {});
    for (std::int64_t tick = 0; tick < 5; ++tick) {
        recorder.append(id, tests::random_ticks(1, 1, tick));
        wait_for_ticks(file, tick + 1);  // nothing else is appended
    }
    recorder.end_trial(id, tests::answered(0, true, 5));
    CHECK(data::read_trace(database, id).size() == 5);
}

TEST_CASE("the log and its index are as private as the file", "[store][law]") {
    const TemporaryFolder folder;
    Database database(folder.file("a.sqlite"), Access::write);
    database.execute("INSERT INTO participant (code) VALUES ('P1')");
    for (const char* name : {"a.sqlite", "a.sqlite-wal", "a.sqlite-shm"}) {
        CAPTURE(name);
        CHECK(std::filesystem::status(folder.file(name)).permissions() ==
              (std::filesystem::perms::owner_read | std::filesystem::perms::owner_write));
    }
}

TEST_CASE("a disk without room for the session refuses it with what it needs", "[store][law]") {
    const TemporaryFolder folder;
    const std::string file = folder.file("a.sqlite");
    const Database database(file, Access::write);
    auto protocol = tests::small_protocol();
    CHECK_NOTHROW(data::require_space(file, protocol, 1));
    CHECK(data::bytes_needed(protocol, 10) >
          static_cast<std::int64_t>(10 * protocol.timing.explore_timeout *
                                    protocol.apparatus.rate_hz * 30));
    const auto many =
        static_cast<std::size_t>(static_cast<double>(data::bytes_free(file)) /
                                     (protocol.timing.explore_timeout * 1000.0 * 40.0) +
                                 2.0);
    CHECK_THROWS_WITH(data::require_space(file, protocol, many),
                      ContainsSubstring("a.sqlite") && ContainsSubstring("free some space"));
}

TEST_CASE("every edit of a chained session is evident, and a mark is none", "[store][chain][law]") {
    const TemporaryFolder folder;
    Database database(folder.file("a.sqlite"), Access::write);
    const auto spec = tests::session_spec(tests::small_protocol());
    const auto session = data::open_session(database, spec).id;
    data::SqliteRecorder recorder(database, spec.protocol, session);
    for (const auto& planned : spec.plan.trials) {
        const auto id = recorder.begin_trial(planned, {});
        recorder.append(id, tests::random_ticks(planned.position, 50));
        recorder.end_trial(id, tests::answered(0, planned.condition.object == 0, 50));
        recorder.event("note", "after it");
    }
    recorder.finish_session();
    REQUIRE(data::chain_breaks(database, session).empty());
    const std::string head = data::chain_head(database, session);
    CHECK(head.size() == 64);
    static_cast<void>(data::mark_invalid(database, 2, "the bell rang"));
    CHECK(data::chain_breaks(database, session).empty());
    const char* edits[] = {
        "UPDATE trial SET started_utc = '' WHERE id = 1",
        "UPDATE response SET input = 'mouse' WHERE trial = 3",
        "UPDATE response SET place = 2, object = 'convex' WHERE trial = 4",
        "UPDATE event SET text = 'before it' WHERE id = 3",
        "DELETE FROM event WHERE id = 1",
        "INSERT INTO event (id, session, kind, text, at_utc) VALUES (0, 1, 'a', 'b', '')",
        "UPDATE session SET device = 'another'",
        "UPDATE session SET uuid = replace(uuid, substr(uuid, 1, 8), '00000000')",
        "UPDATE session SET finished_utc = '2026'",
        "UPDATE trace_chunk SET derived = derived + 1 WHERE trial = 5",
        "DELETE FROM trace_chunk WHERE trial = 2",
        "UPDATE trial SET chain = NULL",
        "UPDATE trial SET chain = NULL WHERE id = 3",
        "UPDATE trial SET chain_events = chain_events + 1 WHERE id = 3",
        "UPDATE session SET chain = NULL",
        "UPDATE participant SET code = 'P02'",
        "UPDATE plan SET mu_s = 0.9 WHERE position = 3"};
    for (const char* edit : edits) {
        CAPTURE(edit);
        database.execute("PRAGMA foreign_keys = OFF; BEGIN");
        database.execute(edit);
        CHECK_FALSE(data::chain_breaks(database, session).empty());
        database.execute("ROLLBACK");
    }
    CHECK(data::chain_breaks(database, session).empty());
    // Row numbers are no part of it: files may be merged.
    database.execute(
        "PRAGMA foreign_keys = OFF; UPDATE response SET trial = trial + 100;"
        "UPDATE trace_chunk SET trial = trial + 100; UPDATE event SET trial = trial + 100;"
        "UPDATE presentation SET trial = trial + 100;"
        "UPDATE trial SET id = id + 100; UPDATE event SET text = 'mark after trial 106: the bell "
        "rang'"
        " WHERE kind = 'mark' AND 0");
    CHECK(data::chain_breaks(database, session).empty());
    CHECK(data::chain_head(database, session) == head);
}

TEST_CASE(
    "one flipped bit anywhere in a file is reported, or nothing that the file says has changed",
    "[store][chain][law]") {
    const TemporaryFolder folder;
    const std::string file = folder.file("a.sqlite");
    const auto spec = tests::session_spec(tests::small_protocol());
    {
        Database database(file, Access::write);
        const auto session = data::open_session(database, spec).id;
        data::SqliteRecorder recorder(database, spec.protocol, session);
        for (std::size_t i = 0; i < 2; ++i) {
            const auto id = recorder.begin_trial(spec.plan.trials[i], {});
            recorder.append(id, tests::random_ticks(i, 100));
            recorder.end_trial(id,
                               tests::answered(0, spec.plan.trials[i].condition.object == 0, 100));
        }
    }
    const auto said = [](Database& database) {  // all that an analyst can read
        std::string text;
        auto tables =
            database.prepare("SELECT name FROM sqlite_schema WHERE type = 'table' ORDER BY name");
        while (tables.step()) {
            auto row = database.prepare("SELECT * FROM " + tables.text(0));
            while (row.step()) {
                for (int i = 0; i < row.columns(); ++i) {
                    const auto blob = row.blob(i);
                    text += row.type(i) == 4
                              ? std::string(reinterpret_cast<const char*>(blob.data()), blob.size())
                              : row.text(i);
                    text += '|';
                }
            }
        }
        return text;
    };
    std::ifstream in(file, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    std::string before;
    std::string known;
    {
        Database database(file, Access::read);
        before = said(database);
        known = findings_of(database);  // made-up ticks follow from no scene
    }
    int wrong = 0;
    int noticed = 0;
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
        tests::Random random(seed);
        std::string damaged = bytes;
        auto& byte =
            damaged[static_cast<std::size_t>(random.below(static_cast<int>(bytes.size())))];
        byte = static_cast<char>(byte ^ (1 << random.below(8)));
        const std::string copy = folder.file("copy.sqlite");
        std::ofstream(copy, std::ios::binary) << damaged;
        try {
            Database database(copy, Access::read);
            const bool reported = findings_of(database) != known;
            noticed += reported ? 1 : 0;
            if (!reported && said(database) != before) {
                CAPTURE(seed);
                ++wrong;
                WARN("silently wrong with seed " << seed);
            }
        } catch (const std::exception&) {  // it cannot be read, and says so
            ++noticed;
        }
    }
    CHECK(wrong == 0);
    CHECK(noticed > 50);
}

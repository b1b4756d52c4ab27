#include <csignal>

#include <sys/wait.h>
#include <unistd.h>

#include "data/store/reader.hpp"
#include "data/store/sqlite_recorder.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/child.hpp"
#include "tests/support/process.hpp"
#include "tests/support/studies.hpp"

using namespace palpate;
using tests::TemporaryFolder;

namespace {

/// Records trials for ever and says on `pipe` what was acknowledged: 'c' a chunk, 't' a trial.
[[noreturn]] void record(const std::string& file, const data::SessionSpec& spec, int pipe) {
    data::Database database(file, data::Access::write);
    const auto opened = data::open_session(database, spec);
    data::SqliteRecorder recorder(database, spec.protocol, opened.id);
    for (std::size_t i = opened.next; i < spec.plan.trials.size(); ++i) {
        const auto id = tests::begin_trial(recorder, spec.protocol, spec.plan.trials[i]);
        for (std::int64_t chunk = 0; chunk < 4; ++chunk) {
            recorder.append(id, tests::random_ticks(i, 256, 256 * chunk));
            if (!recorder.save()) {
                _exit(1);
            }
            static_cast<void>(!write(pipe, "c", 1));
        }
        recorder.end_trial(id, tests::answered(0, true, 1024));
        static_cast<void>(!write(pipe, "t", 1));
    }
    _exit(0);
}

struct Acknowledged {
    std::int64_t chunks = 0;
    std::size_t trials = 0;
};

/// Lets a child record and kills it after `max` acknowledgements and a moment.
Acknowledged record_and_kill(const std::string& file,
                             const data::SessionSpec& spec,
                             int max,
                             unsigned pause_us) {
    int ends[2];
    REQUIRE(pipe(ends) == 0);
    const pid_t test = getpid();
    const pid_t child = fork();
    if (child == 0) {
        tests::die_with(test);
        close(ends[0]);
        record(file, spec, ends[1]);
    }
    close(ends[1]);
    Acknowledged seen;
    char word = 0;
    const auto take = [&] {
        seen.chunks += word == 'c' ? 1 : 0;
        seen.trials += word == 't' ? 1 : 0;
    };
    for (int i = 0; i < max && read(ends[0], &word, 1) == 1; ++i) {
        take();
    }
    usleep(pause_us);
    kill(child, SIGKILL);
    while (read(ends[0], &word, 1) == 1) {
        take();
    }
    close(ends[0]);
    waitpid(child, nullptr, 0);
    return seen;
}

}  // namespace

TEST_CASE(
    "kill -9 at any moment: the file is sound, nothing acknowledged is lost, the order goes on",
    "[store][law]") {
    SEEDED(random, std::uint64_t{40});
    const TemporaryFolder folder;
    const std::string file = folder.file("a.sqlite");
    const auto spec = tests::session_spec(tests::small_protocol(3));
    const Acknowledged seen =
        record_and_kill(file, spec, random.below(40), static_cast<unsigned>(random.below(3000)));

    data::Database database(file, data::Access::write);
    auto check = database.first("PRAGMA integrity_check");
    CHECK(check.text(0) == "ok");
    check.reset();
    auto chunks = database.first("SELECT sum(ticks) / 256 FROM trace_chunk");
    CHECK(chunks.integer(0) >= seen.chunks);
    chunks.reset();
    const auto answered = data::answered_trials(database);
    CHECK(answered.size() >= seen.trials);
    for (const std::int64_t trial : answered) {
        CHECK(data::read_trace(database, trial).size() == 1024);
    }
    const auto opened = data::open_session(database, spec);
    CHECK(opened.next == answered.size());
    auto order = database.first("SELECT plan_sha256 FROM session");
    CHECK(order.text(0) == spec.plan.hash);
}

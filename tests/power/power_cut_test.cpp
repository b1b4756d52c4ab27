#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "data/store/async_recorder.hpp"
#include "tests/power/watched_session.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/process.hpp"

using namespace palpate;
using data::Access;
using data::Database;
using tests::content;
using tests::DiskModel;
using tests::Leaves;
using tests::lines;
using tests::Noting;
using tests::number;
using tests::Promise;
using tests::TemporaryFolder;
using tests::WatchedDisk;
using tests::wrong;

namespace {

/// A watched session from the making of its file to the last line.
struct Recorded {
    std::vector<Promise> promises;
    std::string content;
};

Recorded record(const std::string& file,
                const data::SessionSpec& spec,
                bool on_a_thread,
                const WatchedDisk& disk) {
    Database database(file, Access::write);
    std::unique_ptr<data::AsyncRecorder> async;
    std::unique_ptr<Noting> noting;
    const auto end = tests::run_simulated(
        database, spec, [&](protocols::Recorder& recorder) -> protocols::Recorder& {
            if (on_a_thread) {
                async = std::make_unique<data::AsyncRecorder>(recorder,
                                                              data::AsyncRecorder::kSaveOften);
            }
            noting = std::make_unique<Noting>(async ? *async : recorder, disk);
            return *noting;
        });
    CHECK(end.why == protocols::SessionEnd::Why::finished);
    return {noting->promises(), content(database)};
}

/// What must hold of the file that a power cut left.
void check_left(const std::string& file,
                const data::SessionSpec& spec,
                const Promise& promised,
                const std::string* whole) {
    Database database(file, Access::write);
    REQUIRE(lines(database, "PRAGMA integrity_check") == "ok \n");
    CHECK(number(database, "SELECT count(*) FROM response") >=
          static_cast<std::int64_t>(promised.answered));
    CHECK(number(database, "SELECT count(*) FROM trial") >= promised.trial);
    CHECK(
        number(database,
               fmt::format("SELECT sum(ticks) FROM trace_chunk WHERE trial = {} AND interval = {}",
                           promised.trial, promised.interval)) >= promised.ticks);
    CHECK((!promised.finished || number(database, "SELECT finished FROM session") == 1));
    CHECK(wrong(database).empty());
    const std::size_t running = static_cast<std::size_t>(
        number(database, "SELECT count(*) FROM trial WHERE outcome = 'running'"));
    CHECK(data::open_session(database, spec).interrupted == running);
    if (whole != nullptr && !promised.finished) {
        CHECK(tests::run_simulated(database, spec).why == protocols::SessionEnd::Why::finished);
        CHECK(content(database) == *whole);
        CHECK(wrong(database).empty());
    }
}

/// Cuts the power at every `step`-th call of a session, and goes on with each 16th of what that left.
void cut_everywhere(bool adaptive, bool on_a_thread, std::size_t step, std::uint64_t seed) {
    const TemporaryFolder folder;
    const auto spec = tests::short_session(adaptive);
    WatchedDisk disk(folder.path());
    const Recorded recorded = record(folder.file("a.sqlite"), spec, on_a_thread, disk);
    disk.stop();
    REQUIRE(recorded.promises.back().finished);

    DiskModel model = disk.before();
    auto promise = recorded.promises.begin();
    for (std::size_t cut = 0; cut <= disk.log().size(); ++cut) {
        while (promise + 1 != recorded.promises.end() && (promise + 1)->calls <= cut) {
            ++promise;
        }
        if (cut % step == seed % step) {
            tests::Random random(seed * 1000003 + cut);
            const Leaves leaves = tests::kLeaves[random.below(5)];
            CAPTURE(cut, static_cast<int>(leaves));
            const TemporaryFolder left;
            model.lay_out(leaves, random, left.path());
            const WatchedDisk unsynced(left.path());
            check_left(left.file("a.sqlite"), spec, *promise,
                       cut / step % 16 == 0 ? &recorded.content : nullptr);
        }
        if (cut < disk.log().size()) {
            model.apply(disk.log()[cut]);
        }
    }
}

}  // namespace

TEST_CASE(
    "a power cut at any write leaves a sound file with all that was said to be saved, and the "
    "session goes on to the same answers",
    "[power][law]") {
    cut_everywhere(false, false, 1, 0);
}

TEST_CASE("a power cut in a session with a rule loses nothing that was said to be saved",
          "[power][law]") {
    cut_everywhere(true, false, 3, GENERATE(range(std::uint64_t{0}, std::uint64_t{3})));
}

TEST_CASE("a power cut under the writing thread loses nothing that was said to be saved",
          "[power][law]") {
    cut_everywhere(GENERATE(false, true), true, 4, 1);
}

TEST_CASE("many power cuts", "[.power-long]") {
    const bool adaptive = GENERATE(false, true);
    cut_everywhere(adaptive, GENERATE(false, true), 1,
                   GENERATE(range(std::uint64_t{10}, std::uint64_t{20})));
}

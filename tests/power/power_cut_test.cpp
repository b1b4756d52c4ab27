#include "tests/power/watched_session.hpp"
#include "tests/support/catch.hpp"

using namespace palpate::data;

namespace {

using SaveEvery = std::optional<std::chrono::milliseconds>;

/// A watched session, from wherever its file is to the last line.
struct Recorded {
    std::vector<Promise> promises;
    std::string content;
};

Recorded record(const std::string& file,
                const data::SessionSpec& spec,
                SaveEvery save_every,
                const WatchedDisk& disk) {
    Database database(file, Access::write);
    Recorded recorded;
    recorded.promises.push_back(
        {.answered = static_cast<std::size_t>(count(database, "response"))});
    const auto end = run_simulated(database, spec, [&](protocols::Recorder& recorder) {
        return Noting(recorder, disk, recorded.promises, save_every);
    });
    CHECK(end.why == protocols::SessionEnd::Why::finished);
    recorded.content = content(database);
    return recorded;
}

/// What must hold of the file that a power cut left.
void check_left(const std::string& file,
                const data::SessionSpec& spec,
                const Promise& promised,
                const std::string* whole) {
    Database database(file, Access::write);
    REQUIRE(lines(database, "PRAGMA integrity_check") == "ok \n");
    CHECK(count(database, "response") >= static_cast<std::int64_t>(promised.answered));
    CHECK(count(database, "trial") >= promised.trial);
    CHECK(database
              .first(fmt::format(
                  "SELECT sum(ticks) FROM trace_chunk WHERE trial_id = {} AND interval = {}",
                  promised.trial, promised.interval))
              .integer(0) >= promised.ticks);
    CHECK((!promised.finished || database.first("SELECT finished FROM session").integer(0) == 1));
    CHECK(differences(database) == "");
    const std::size_t running =
        static_cast<std::size_t>(count(database, "trial WHERE outcome = 'running'"));
    CHECK(data::open_session(database, spec).interrupted == running);
    if (whole != nullptr && !promised.finished) {
        CHECK(run_simulated(database, spec).why == protocols::SessionEnd::Why::finished);
        CHECK(content(database) == *whole);
        CHECK(differences(database) == "");
    }
}

/// Cuts the power at every `step`-th call of the session in `folder`, and goes on with each 16th of
/// what that left.
void cut_everywhere(const TemporaryFolder& folder,
                    const data::SessionSpec& spec,
                    SaveEvery save_every,
                    std::size_t step,
                    std::uint64_t seed) {
    WatchedDisk disk(folder.path());
    const Recorded recorded = record(folder.file("a.sqlite"), spec, save_every, disk);
    disk.stop();
    REQUIRE(recorded.promises.back().finished);

    DiskModel model = disk.before();
    auto promise = recorded.promises.begin();
    for (std::size_t cut = 0; cut <= disk.log().size(); ++cut) {
        while (promise + 1 != recorded.promises.end() && (promise + 1)->calls <= cut) {
            ++promise;
        }
        if (cut % step == seed % step) {
            Random random(seed * 1000003 + cut);
            const Leaves leaves = kLeaves[random.below(5)];
            CAPTURE(seed, cut, static_cast<int>(leaves));
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
    "[long]") {
    cut_everywhere(TemporaryFolder(), short_session(false), {}, 3, 0);
}

TEST_CASE("a power cut in a session with a rule loses nothing that was said to be saved",
          "[long]") {
    cut_everywhere(TemporaryFolder(), short_session(true), {}, 10, 0);
}

TEST_CASE("a power cut under the writing thread loses nothing that was said to be saved") {
    const bool adaptive = GENERATE(false, true);
    cut_everywhere(TemporaryFolder(), short_session(adaptive), data::AsyncRecorder::kSaveOften, 16,
                   1);
}

TEST_CASE("a second power cut, after a session went on from the first, loses nothing either") {
    const auto spec = short_session(false);
    const TemporaryFolder first;
    WatchedDisk disk(first.path());
    static_cast<void>(record(first.file("a.sqlite"), spec, {}, disk));
    disk.stop();
    DiskModel model = disk.before();
    for (std::size_t call = 0; call < disk.log().size() / 2; ++call) {
        model.apply(disk.log()[call]);
    }
    const TemporaryFolder left;
    Random random(1);
    model.lay_out(GENERATE(Leaves::everything, Leaves::sectors_512), random, left.path());
    cut_everywhere(left, spec, {}, 6, 2);
}

TEST_CASE("many power cuts", "[.power-long]") {
    const bool adaptive = GENERATE(false, true);
    const bool on_a_thread = GENERATE(false, true);
    cut_everywhere(TemporaryFolder(), short_session(adaptive),
                   on_a_thread ? SaveEvery(data::AsyncRecorder::kSaveOften) : SaveEvery(), 1,
                   GENERATE(range(std::uint64_t{10}, std::uint64_t{20})));
}

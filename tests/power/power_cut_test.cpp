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
            check_left(left.file("a.sqlite"), spec, *promise, recorded.content,
                       cut / step % 16 == 0);
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

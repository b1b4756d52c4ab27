#include "tests/power/watched_session.hpp"
#include "tests/support/catch.hpp"

using namespace palpate::data;
using protocols::TrialId;

namespace {

/// Another program takes all that is free as soon as a trial has `ticks`, and before each trial
/// from then on.
class Filling : public Noting {
public:
    Filling(protocols::Recorder& recorder,
            WatchedDisk& disk,
            std::vector<Promise>& promises,
            std::optional<std::chrono::milliseconds> save_every,
            TrialId trial,
            std::int64_t ticks)
        : Noting(recorder, disk, promises, save_every), disk_(disk), trial_(trial), left_(ticks) {}
    TrialId begin_trial(const protocols::PlannedTrial& planned) override {
        if (left_ < 0) {
            disk_.room(0);
        }
        return Noting::begin_trial(planned);
    }
    void append(TrialId trial, std::span<const engine::TickRecord> ticks) override {
        const bool filled = left_ < 0;
        left_ -= trial == trial_ ? static_cast<std::int64_t>(ticks.size()) : 0;
        if (left_ < 0 && !filled) {
            disk_.room(0);
        }
        Noting::append(trial, ticks);
    }

private:
    WatchedDisk& disk_;
    TrialId trial_;
    std::int64_t left_;
};

/// Runs the session to its end or to an error. @return what the error said; empty: the end
template <class Wrap>
std::string run(Database& database, const data::SessionSpec& spec, const Wrap& wrap) {
    try {
        const auto end = run_simulated(database, spec, wrap);
        CHECK(end.why == protocols::SessionEnd::Why::finished);
    } catch (const data::StoreError& e) {
        return e.what();
    }
    return "";
}

std::string run(Database& database, const data::SessionSpec& spec) {
    return run(database, spec,
               [](protocols::Recorder& recorder) -> protocols::Recorder& { return recorder; });
}

std::string content_of_unbroken(const data::SessionSpec& spec) {
    const TemporaryFolder folder;
    const WatchedDisk unsynced(folder.path());
    Database database(folder.file("a.sqlite"), Access::write);
    static_cast<void>(run_simulated(database, spec));
    return content(database);
}

}  // namespace

TEST_CASE(
    "a disk that others fill during a trial costs no tick and no answer of it, and the session "
    "ends after it") {
    EACH(adaptive, false, true);
    EACH(on_a_thread, false, true);
    EACH(when, range(0, 4));
    const auto spec = short_session(adaptive);
    const TrialId trial = 2;
    const TemporaryFolder folder;
    WatchedDisk disk(folder.path());
    {
        Database database(folder.file("a.sqlite"), Access::write);
        std::vector<Promise> promises{{}};
        const std::string said = run(database, spec, [&](protocols::Recorder& recorder) {
            return Filling(
                recorder, disk, promises,
                on_a_thread ? std::optional(data::AsyncRecorder::kSaveEvery) : std::nullopt, trial,
                100 * when);
        });
        CHECK_THAT(said, Has("a.sqlite: its disk does not have the 16 MB that a trial",
                             "free some space"));
        CHECK(lines(database, "SELECT outcome FROM trial WHERE trial_id >= 2") == "timed_out \n");
        CHECK(database.first("SELECT sum(ticks) FROM presentation WHERE trial_id = 2").integer(0) <=
              database.first("SELECT sum(ticks) FROM trace_chunk WHERE trial_id = 2").integer(0));
        CHECK(differences(database) == "");
    }
    constexpr std::int64_t kPlenty = 1'000'000'000;
    disk.room(kPlenty);
    Database database(folder.file("a.sqlite"), Access::write);
    CHECK(run(database, spec).empty());
    CHECK(content(database) == content_of_unbroken(spec));
    CHECK(count(database, "trial WHERE outcome = 'interrupted'") == 0);
}

TEST_CASE("a call that the disk refuses at any moment loses nothing that was said to be saved") {
    const int error = GENERATE(EIO, ENOSPC);
    const bool for_good = GENERATE(false, true);
    CAPTURE(error, for_good);
    const auto spec = short_session(false);
    const std::string whole = content_of_unbroken(spec);
    std::size_t calls = 1;
    for (std::size_t call = 0; call < calls; call += 1 + call % 29) {
        CAPTURE(call);
        const TemporaryFolder folder;
        WatchedDisk disk(folder.path());
        disk.fail(call, error, for_good);
        std::vector<Promise> promises{{}};
        std::string said;
        try {
            Database database(folder.file("a.sqlite"), Access::write);
            said = run(database, spec, [&](protocols::Recorder& recorder) {
                return Noting(recorder, disk, promises, {});
            });
        } catch (const data::StoreError& e) {
            said = e.what();
        }
        calls = said.empty() ? disk.tried() : calls + 100;
        CHECK((said.empty() || said.find("a.sqlite") != std::string::npos));
        disk.fail(SIZE_MAX, 0, false);
        const Promise& promised = promises.back();
        CHECK((!said.empty() || promised.finished));
        check_left(folder.file("a.sqlite"), spec, promised, whole, true);
    }
}

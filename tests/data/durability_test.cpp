#include "data/store/async_recorder.hpp"
#include "data/store/disk_space.hpp"
#include "data/store/people.hpp"
#include "data/store/reader.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/child.hpp"
#include "tests/support/studies.hpp"
#include "tests/support/test_text.hpp"

using namespace palpate::data;
using namespace std::chrono_literals;

namespace {

/// What the writer says as soon as a save has come back.
struct Saved {
    std::int64_t ticks = 0;   ///< all of them up to here
    std::int64_t age_ns = 0;  ///< from when the oldest of this save was handed over
};

/// Hears of the ticks when they are handed over, and tells of every save on `pipe`.
class Telling : public data::SqliteRecorder {
public:
    Telling(Database& database, const protocols::Protocol& protocol, std::int64_t id, int pipe)
        : SqliteRecorder(database, protocol, id), pipe_(pipe), handed_(8192) {}
    /// Before it is handed over: nothing is younger than it says.
    void hands(std::int64_t tick) { handed_.at(static_cast<std::size_t>(tick)) = now(); }
    void append(protocols::TrialId id, std::span<const engine::TickRecord> ticks) override {
        SqliteRecorder::append(id, ticks);
        appended_ += static_cast<std::int64_t>(ticks.size());
    }
    bool save() override {
        const bool saved = SqliteRecorder::save();
        if (saved && appended_ > saved_) {
            const Saved said{appended_, now() - handed_.at(static_cast<std::size_t>(saved_))};
            saved_ = appended_;
            static_cast<void>(!write(pipe_, &said, sizeof said));
        }
        return saved;
    }

private:
    static std::int64_t now() { return std::chrono::steady_clock::now().time_since_epoch() / 1ns; }
    int pipe_;
    std::vector<std::atomic<std::int64_t>> handed_;  ///< ns
    std::int64_t appended_ = 0;
    std::int64_t saved_ = 0;
};

/// A servo of 1 kHz that goes on until it is killed.
[[noreturn]] void record_in_real_time(const std::string& file,
                                      const data::SessionSpec& spec,
                                      int pipe) {
    Database database(file, Access::write);
    const auto opened = data::open_session(database, spec);
    Telling disk(database, spec.protocol, opened.id, pipe);
    data::AsyncRecorder recorder(disk);
    const auto id = begin_trial(recorder, spec.protocol, spec.plan.trials[opened.next]);
    const auto start = std::chrono::steady_clock::now();
    for (std::int64_t tick = 0; tick < 8192; ++tick) {
        std::this_thread::sleep_until(start + tick * 1ms);
        disk.hands(tick);
        recorder.append(id, random_ticks(1, 1, tick));
    }
    _exit(0);
}

/// Kills it some time after `saves` saves. @return all that it said
std::vector<Saved> record_and_kill(const std::string& file,
                                   const data::SessionSpec& spec,
                                   std::size_t saves,
                                   std::chrono::milliseconds later) {
    int ends[2];
    REQUIRE(pipe(ends) == 0);
    const pid_t child = in_a_child([&] {
        close(ends[0]);
        record_in_real_time(file, spec, ends[1]);
    });
    close(ends[1]);
    std::vector<Saved> said;
    Saved one;
    while (said.size() < saves && read(ends[0], &one, sizeof one) == sizeof one) {
        said.push_back(one);
    }
    std::this_thread::sleep_for(later);
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    while (read(ends[0], &one, sizeof one) == sizeof one) {
        said.push_back(one);
    }
    close(ends[0]);
    return said;
}

void wait_for_ticks(const std::string& file, std::int64_t ticks) {
    Database reader(file, Access::read);
    REQUIRE(eventually([&] {
        return reader.first("SELECT coalesce(sum(ticks), 0) FROM trace_chunk").integer(0) >= ticks;
    }));
}

/// A disk that fails once, and would take everything after it.
class DiskWithHiccup : public protocols::Recorder {
public:
    explicit DiskWithHiccup(int failing) : failing_(failing) {}
    protocols::TrialId begin_trial(const protocols::PlannedTrial& /*p*/) override {
        return ++calls_;
    }
    void append(protocols::TrialId /*t*/, std::span<const engine::TickRecord> ticks) override {
        ++calls_;
        if (++appends_ == failing_) {
            throw data::StoreError("the disk did not take it");
        }
        last_ = ticks.back().tick;
    }
    void end_trial(protocols::TrialId /*t*/, const protocols::TrialResult& /*r*/) override {
        ++calls_;
    }
    void event(const protocols::Event& /*event*/) override { ++calls_; }
    void finish_session() override { ++calls_; }

    [[nodiscard]] int calls() const { return calls_; }
    [[nodiscard]] std::int64_t last_tick() const { return last_; }

private:
    int failing_;
    int appends_ = 0;
    int calls_ = 0;
    std::int64_t last_ = -1;
};

constexpr std::int64_t kPart = 1000;  ///< ticks that are not kept to be handed over with more

/// @returns whether one part was refused
bool append_all(protocols::Recorder& recorder, std::int64_t parts) {
    try {
        for (std::int64_t i = 0; i < parts; ++i) {
            recorder.append(1, random_ticks(1, kPart, i * kPart));
        }
    } catch (const data::StoreError&) {
        return true;
    }
    return false;
}

}  // namespace

TEST_CASE("kill -9 loses no tick that was saved, and ticks are saved before they are 120 ms old") {
    SEEDED(random, std::uint64_t{6});
    const TemporaryFile file("a.sqlite");
    const auto spec = session_spec(small_protocol());
    const std::vector<Saved> said =
        record_and_kill(file, spec, 12, std::chrono::milliseconds(random.below(100)));
    REQUIRE(said.size() >= 12);

    Database database(file, Access::write);
    CHECK(database.first("PRAGMA integrity_check").text(0) == "ok");
    const auto opened = data::open_session(database, spec);
    CHECK(opened.interrupted == 1);
    CHECK(opened.next == 0);
    auto trial = database.first("SELECT trial_id FROM trial WHERE outcome = 'interrupted'");
    const auto ticks = data::TraceReader(database).stored(trial.integer(0));
    CHECK(static_cast<std::int64_t>(ticks.size()) >= said.back().ticks);
    for (std::size_t i = 0; i < ticks.size(); ++i) {
        REQUIRE(same_bits(ticks[i], random_ticks(1, 1, static_cast<std::int64_t>(i))[0]));
    }
    // A busy machine lets the writer wait for its turn, and only ever adds to the age: the least
    // disturbed save shows what the writer does of itself.
    const auto least = std::ranges::min(said, {}, &Saved::age_ns);
    CHECK(std::chrono::nanoseconds(least.age_ns) < 120ms);
    CHECK(std::chrono::nanoseconds(least.age_ns) >= data::AsyncRecorder::kSaveEvery);
}

TEST_CASE("a lock of another program keeps no tick and no answer back for good") {
    SmallSession session;
    const std::string file = session.folder.file("a.sqlite");
    data::AsyncRecorder recorder(session.recorder, 5ms);
    const auto id = begin_trial(recorder, session.spec.protocol, session.spec.plan.trials[0]);
    const auto ticks = random_ticks(1, 9000);
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
    recorder.end_trial(id, answered(0, true, 9000));
    ends.join();
    const auto stored = data::TraceReader(session.database).read(id);
    REQUIRE(stored.size() == ticks.size());
    CHECK(std::equal(stored.begin(), stored.end(), ticks.begin(), same_bits));
    CHECK(count(analyst, "response") == 1);
}

TEST_CASE("what a lock keeps back is stored with the time when it happened") {
    SmallSession session;
    const std::string file = session.folder.file("a.sqlite");
    const auto asked = palpate::monotonic_ns();
    {
        data::AsyncRecorder recorder(session.recorder, 5ms);
        Database analyst(file, Access::write);
        analyst.execute("BEGIN IMMEDIATE");
        recorder.event_soon({.text = "soon"}, [] {});
        recorder.event_soon({.text = "earlier", .when_ns = asked - 2'000'000'000}, [] {});
        std::thread ends([&] {
            std::this_thread::sleep_for(1500ms);
            analyst.execute("COMMIT");
        });
        recorder.event({.text = "waits"});
        ends.join();
    }
    const auto stored_ns = palpate::monotonic_ns();
    const auto since = [&](const std::string& text) {
        return session.database.first("SELECT at_ns FROM event WHERE text = ?1", text).integer(0) -
               asked;
    };
    CHECK(since("earlier") == -2'000'000'000);
    for (const char* text : {"soon", "waits"}) {
        CHECK(since(text) >= 0);
        CHECK(since(text) < stored_ns - asked - 1'400'000'000);
    }
    // The wall's clock says the same to the ms.
    const double between = session.database
                               .first(
                                   "SELECT (julianday(w.at_utc) - julianday(e.at_utc)) * 86400 "
                                   "FROM event w, event e WHERE w.text = 'waits' AND e.text = "
                                   "'earlier'")
                               .real(0);
    CHECK(between ==
          Approx(1e-9 * static_cast<double>(since("waits") + 2'000'000'000)).margin(2e-3));
}

TEST_CASE("ticks that come slowly are saved by the clock, not by their number") {
    SmallSession session;
    const std::string file = session.folder.file("a.sqlite");
    data::AsyncRecorder recorder(session.recorder, 5ms);
    const auto id = begin_trial(recorder, session.spec.protocol, session.spec.plan.trials[0]);
    for (std::int64_t tick = 0; tick < 5; ++tick) {
        recorder.append(id, random_ticks(1, 1, tick));
        wait_for_ticks(file, tick + 1);  // nothing else is appended
    }
    recorder.end_trial(id, answered(0, true, 5));
    CHECK(data::TraceReader(session.database).read(id).size() == 5);
}

TEST_CASE("the log and its index are as private as the file") {
    const TemporaryFolder folder;
    Database database(folder.file("a.sqlite"), Access::write);
    database.execute("INSERT INTO participant (participant_code, subject) VALUES ('P1', 1)");
    for (const char* name : {"a.sqlite", "a.sqlite-wal", "a.sqlite-shm"}) {
        CAPTURE(name);
        CHECK(std::filesystem::status(folder.file(name)).permissions() ==
              (std::filesystem::perms::owner_read | std::filesystem::perms::owner_write));
    }
}

TEST_CASE("a disk without room for the session refuses it with what it needs") {
    const TemporaryFolder folder;
    const std::string file = folder.file("a.sqlite");
    const Database database(file, Access::write);
    auto protocol = small_protocol();
    CHECK_NOTHROW(data::require_space(file, protocol, 1));
    CHECK(data::bytes_needed(protocol, 10) >
          static_cast<std::int64_t>(10 * protocol.timing.explore_timeout *
                                    protocol.apparatus.rate_hz * 30));
    const auto many =
        static_cast<std::size_t>(static_cast<double>(data::bytes_free(file)) /
                                     (protocol.timing.explore_timeout * 1000.0 * 40.0) +
                                 2.0);
    CHECK_THROWS_WITH(data::require_space(file, protocol, many),
                      Has("a.sqlite", "free some space"));
    const std::string none = folder.file("none.sqlite");  // before it is made
    CHECK_NOTHROW(data::require_space(none, protocol, 1));
    CHECK_THROWS_WITH(data::require_space(none, protocol, 2 * many), Has("none.sqlite"));
    CHECK_THROWS_WITH(data::require_space(folder.file("no/b.sqlite"), protocol, 1),
                      Has("is not known"));
}

TEST_CASE("every edit of a chained session is evident, and a mark is a link of its own") {
    SmallSession small;
    Database& database = small.database;
    const std::int64_t session = small.id;
    for (const auto& planned : small.spec.plan.trials) {
        small.record(planned.position, answered(0, planned.condition.object == 0, 50),
                     random_ticks(planned.position, 50));
        small.recorder.event({.text = "after it"});
    }
    small.recorder.finish_session();
    REQUIRE(data::chain_breaks(database, session).empty());
    const std::string finished = data::chain_head(database, session);
    CHECK(finished.size() == 64);
    const std::string head = data::mark_invalid(database, 2, {"the bell rang", "Ada"}).head;
    CHECK(head != finished);
    CHECK(data::chain_head(database, session) == head);
    CHECK(data::chain_breaks(database, session).empty());
    for (const std::string& edit : lines_in(test_text("edits/evident.sql"))) {
        CAPTURE(edit);
        database.execute("PRAGMA foreign_keys = OFF; BEGIN");
        database.execute(edit.c_str());
        CHECK_FALSE(data::chain_breaks(database, session).empty());
        database.execute("ROLLBACK");
    }
    CHECK(data::chain_breaks(database, session).empty());
    // Row numbers are no part of it: files may be merged.
    database.execute(
        "PRAGMA foreign_keys = OFF; UPDATE response SET trial_id = trial_id + 100;UPDATE "
        "trace_chunk SET trial_id = trial_id + 100; UPDATE event SET trial_id = trial_id + "
        "100;UPDATE presentation SET trial_id = trial_id + 100;UPDATE trial SET trial_id = "
        "trial_id + 100; UPDATE event SET text = 'mark after trial 106: the bell rang' WHERE "
        "event_kind = 'mark' AND 0");
    CHECK(data::chain_breaks(database, session).empty());
    CHECK(data::chain_head(database, session) == head);
}

TEST_CASE("after one lost append nothing is stored any more, and every call says so") {
    EACH(failing, 1, 2, 7, 20);
    constexpr std::int64_t kParts = 20;
    DiskWithHiccup disk(failing);
    {
        data::AsyncRecorder recorder(disk);
        const auto id = recorder.begin_trial({});
        const bool refused = append_all(recorder, kParts);
        CAPTURE(refused);
        const std::function<void()> calls[] = {
            [&] { recorder.end_trial(id, answered(0, true)); },
            [&] { recorder.append(id, random_ticks(1, 10, kParts * kPart)); },
            [&] { recorder.event({.text = "somebody noted it"}); },
            [&] { static_cast<void>(recorder.begin_trial({})); },
            [&] {
                recorder.finish_session();
            }};
        for (int round = 0; round < 3; ++round) {
            for (const auto& call : calls) {
                CHECK_THROWS_WITH(call(), Has("did not take it"));
            }
        }
    }
    CHECK(disk.calls() == 1 + failing);  // begin_trial and the appends up to the lost one
    CHECK(disk.last_tick() == (failing - 1) * kPart - 1);
}

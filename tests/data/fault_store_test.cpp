#include "data/store/session_store.hpp"
#include "data/store/sqlite_recorder.hpp"
#include "data/trace/columns.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/faulty.hpp"
#include "tests/support/process.hpp"
#include "tests/support/studies.hpp"

using namespace palpate;
using namespace palpate::data;
using namespace palpate::tests;
using namespace palpate::protocols;

namespace {

/// Ends the program at a given call, before or after the recorder has done it.
class Killing : public Recorder {
public:
    Killing(Recorder& recorder, int calls) : recorder_(recorder), calls_(calls) {}

    TrialId begin_trial(const PlannedTrial& planned) override {
        call();
        return recorder_.begin_trial(planned);
    }
    void append(TrialId trial, std::span<const engine::TickRecord> ticks) override {
        recorder_.append(trial, ticks);
    }
    void end_trial(TrialId trial, const TrialResult& result) override {
        call();
        recorder_.end_trial(trial, result);
        call();
    }
    void begin_interval(TrialId trial,
                        const Presentation& felt,
                        const SceneConstants& scene) override {
        recorder_.begin_interval(trial, felt, scene);
    }
    void event(const Event& event) override {
        call();
        recorder_.event(event);
    }
    void finish_session() override { recorder_.finish_session(); }

private:
    void call() {
        if (calls_-- == 0) {
            throw Killed{};
        }
    }

    Recorder& recorder_;
    int calls_;
};

constexpr const char* kFelt =
    "SELECT plan_position, outcome FROM trial WHERE outcome NOT IN ('running', 'interrupted') "
    "ORDER BY trial_id";

/// Runs a session on a database until it is finished, killed after `kill_after` calls at a time.
/// @return how often it was killed
int run_to_the_end(Database& database, const data::SessionSpec& spec, World world, int kill_after) {
    Random random(world.seed);
    for (int kills = 0;; ++kills) {
        world.faults.clear();  // a fault counts when it was written down
        for (const auto& known :
             database.prepare("SELECT plan_position FROM trial WHERE outcome = 'faulted'")) {
            ++world.faults[static_cast<std::size_t>(known.integer(0))];
        }
        const data::OpenedSession opened = data::open_session(database, spec);
        CHECK(opened.next == opened.progress.pending().next());
        data::SqliteRecorder recorder(database, spec.protocol, opened.id);
        Killing killing(recorder, kill_after > 0 && kills < 8 ? random.below(kill_after) : -1);
        FaultyApparatus apparatus(world);
        Patient observer;
        try {
            const SessionEnd end = run_session(spec.protocol, spec.plan, {}, opened.progress,
                                               {.apparatus = apparatus,
                                                .observer = observer,
                                                .recorder = killing,
                                                .pause = [](double) {
                                                }});
            CHECK(end.why == SessionEnd::Why::finished);
            return kills;
        } catch (const Killed&) {
            CHECK_FALSE(apparatus.force_on);
        }
    }
}

}  // namespace

TEST_CASE(
    "resumed from its database after any kill, a session with faults runs as the unbroken one",
    "[store][fault][law]") {
    const auto seed = GENERATE(seeds(std::uint64_t{12}));
    CAPTURE(seed);
    const TemporaryFolder folder;
    const auto spec = session_spec(short_protocol());
    const World world{.seed = seed, .fault_share = 0.3, .away = 1};
    Database unbroken(folder.file("unbroken.sqlite"), Access::write);
    REQUIRE(run_to_the_end(unbroken, spec, world, 0) == 0);
    Database broken(folder.file("broken.sqlite"), Access::write);
    CHECK(run_to_the_end(broken, spec, world, 25) > 0);
    CHECK(lines(broken, kFelt) == lines(unbroken, kFelt));
    // Each position is answered once, and its attempts count up.
    CHECK(
        lines(broken,
              "SELECT count(*), count(DISTINCT plan_position) FROM analysis_trial WHERE counts") ==
        lines(broken, "SELECT count(*), count(*) FROM plan"));
    CHECK(lines(broken,
                "SELECT plan_position FROM trial GROUP BY plan_position HAVING count(*) <> "
                "max(attempt) OR count(DISTINCT attempt) <> count(*)")
              .empty());
    CHECK(
        lines(
            broken,
            "SELECT count(*) FROM fault WHERE fault_cause <> 'over_speed' OR ticks_kept <> 100") ==
        "0 \n");
}

TEST_CASE(
    "the last ticks before a fault are there in plain SQL, also when the trace lost its chunks",
    "[store][fault][law]") {
    const auto seed = GENERATE(seeds(std::uint64_t{10}));
    CAPTURE(seed);
    const TemporaryFolder folder;
    Database database(folder.file("a.sqlite"), Access::write);
    const auto spec = session_spec(small_protocol());
    const auto opened = data::open_session(database, spec);
    data::SqliteRecorder recorder(database, spec.protocol, opened.id);
    const auto ticks = random_ticks(seed, 1 + 11 * seed, 12345);
    TrialResult result;
    result.outcome = Outcome::faulted;
    result.summary.slewed_ticks = 3;
    result.summary.stale_ticks = 2;
    result.fault = Fault{.cause = engine::Trip::device_lost, .text = "gone", .last = ticks};
    const auto id = begin_trial(recorder, spec.protocol, spec.plan.trials[0]);
    recorder.end_trial(id, result);  // no tick came through the ring

    auto row = database.prepare("SELECT * FROM fault_tick ORDER BY tick");
    for (const engine::TickRecord& tick : ticks) {
        REQUIRE(row.step());
        CHECK(row.integer(0) == id);
        int column = 1;
        for (const data::TraceColumn& c : data::trace_columns()) {
            REQUIRE(row.name(column) == c.name);
            ++column;
        }
        REQUIRE(column == row.columns());
        const auto same = [&row](int at, double value) {
            return std::isnan(value) ? row.null(at) : row.real(at) == value;
        };
        CHECK(row.integer(1) == tick.tick);
        CHECK(row.integer(3) == tick.counts[0]);
        CHECK(row.integer(6) == tick.codes[1]);
        CHECK(same(7, double{tick.lateness_us}));
        CHECK(row.integer(8) == tick.flags);
        CHECK(row.text(9) == to_string(tick.mode));
        CHECK(row.integer(10) == tick.segment);
        CHECK(same(12, tick.hip.x));
        CHECK(same(13, tick.hip.y));
        CHECK(same(18, tick.force.x));
        CHECK(same(21, tick.command.y));
        CHECK(same(24, tick.mu));
    }
    CHECK_FALSE(row.step());
    CHECK(lines(database,
                "SELECT trial_id, plan_position, attempt, fault_cause, ticks_kept FROM fault") ==
          "1 0 1 device_lost " + std::to_string(ticks.size()) + " \n");
    CHECK(lines(database, "SELECT force_slew_ticks, stale_ticks FROM trial") == "3 2 \n");
}

TEST_CASE("a fault belongs to a faulted trial, and a refused result leaves nothing",
          "[store][fault]") {
    const TemporaryFolder folder;
    Database database(folder.file("a.sqlite"), Access::write);
    const auto spec = session_spec(small_protocol());
    const auto opened = data::open_session(database, spec);
    data::SqliteRecorder recorder(database, spec.protocol, opened.id);
    const auto id = begin_trial(recorder, spec.protocol, spec.plan.trials[0]);
    TrialResult result = answered(0, true);
    result.fault = Fault{.cause = engine::Trip::late, .text = {}, .last = random_ticks(1, 5)};
    CHECK_THROWS_WITH(recorder.end_trial(id, result), Has("with a fault"));
    CHECK(lines(database, "SELECT count(*) FROM fault_tick") == "0 \n");
    CHECK_NOTHROW(recorder.end_trial(id, answered(0, true)));
    CHECK(lines(database, "SELECT count(*) FROM fault") == "0 \n");
}

TEST_CASE("a question that nobody answered in time leaves an unanswered trial, which comes again",
          "[store][session][law]") {
    class Slow : public Patient {
    public:
        Choice choose(const TrialView& /*trial*/, const Question& /*question*/) override {
            return {.signal = ++asked % 3 == 1 ? Signal::too_late : Signal::done};
        }
        int asked = 0;
    };
    const TemporaryFolder folder;
    Database database(folder.file("a.sqlite"), Access::write);
    const auto spec = session_spec(short_protocol());
    const data::OpenedSession opened = data::open_session(database, spec);
    data::SqliteRecorder recorder(database, spec.protocol, opened.id);
    World world;
    FaultyApparatus apparatus(world);
    Slow observer;
    const SessionEnd end = run_session(
        spec.protocol, spec.plan, {}, opened.progress,
        {.apparatus = apparatus, .observer = observer, .recorder = recorder, .pause = [](double) {
         }});
    CHECK(end.why == SessionEnd::Why::finished);
    CHECK(count(database, "trial WHERE outcome = 'unanswered'") == (observer.asked + 2) / 3);
    CHECK(count(database, "trial JOIN response USING (trial_id) WHERE outcome <> 'complete'") == 0);
    CHECK(count(database, "response") == count(database, "plan"));
}

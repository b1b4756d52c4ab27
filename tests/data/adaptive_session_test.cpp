#include "protocols/trial/object_hash.hpp"
#include "data/store/people.hpp"
#include "data/sync/merge.hpp"
#include "tests/support/adaptive.hpp"
#include "tests/support/catch.hpp"

using namespace palpate::data;
using protocols::TrialId;

namespace {

/// Dies in the call that it is asked to.
class Killer : public protocols::Recorder {
public:
    struct Killed {};

    Killer(protocols::Recorder& recorder, int at) : recorder_(recorder), left_(at) {}

    TrialId begin_trial(const protocols::PlannedTrial& planned) override {
        step();
        return recorder_.begin_trial(planned);
    }
    void begin_interval(TrialId trial,
                        const protocols::Presentation& felt,
                        const protocols::SceneConstants& scene) override {
        step();
        recorder_.begin_interval(trial, felt, scene);
    }
    void append(TrialId trial, std::span<const engine::TickRecord> ticks) override {
        recorder_.append(trial, ticks);
    }
    void end_trial(TrialId trial, const protocols::TrialResult& result) override {
        step();
        recorder_.end_trial(trial, result);
        step();
    }
    void event(const protocols::Event& event) override { recorder_.event(event); }
    void finish_session() override { recorder_.finish_session(); }

private:
    void step() {
        if (--left_ == 0) {
            throw Killed{};
        }
    }

    protocols::Recorder& recorder_;
    int left_;
};

/// Runs it up to that call of the recorder.
void dies_in(Database& database, const data::SessionSpec& spec, int call) {
    const auto dying = [call](protocols::Recorder& recorder) {
        return Killer(recorder, call);
    };
    REQUIRE_THROWS_AS(run_simulated(database, spec, dying), Killer::Killed);
}

}  // namespace

TEST_CASE("a changed stimulus, outcome or state of a rule lets nothing run") {
    const data::SessionSpec spec = session_spec(adaptive_protocol());
    const char* edit = GENERATE(
        "UPDATE presentation SET stimulus = stimulus + 2 WHERE trial_id = 6 AND stimulus IS NOT "
        "NULL",
        "UPDATE adaptive_step SET rule_outcome = 1 - rule_outcome WHERE trial_id = 5",
        "UPDATE adaptive_step SET state_sha256 = replace(state_sha256, substr(state_sha256, 9, 1), "
        "'x') WHERE trial_id = 4",
        "UPDATE adaptive_plan SET run_number = 1 - run_number WHERE plan_position = 4",
        "DELETE FROM adaptive_step WHERE trial_id = 5");
    NewDatabase database;
    dies_in(database, spec, 50);
    REQUIRE(count(database, "adaptive_step") > 6);
    const std::int64_t trials = count(database, "trial");
    CAPTURE(edit);
    database.execute(edit);
    CHECK_FALSE(differences(database).empty());
    CHECK_THROWS_WITH(run_simulated(database, spec), Has("nothing was run"));
    CHECK(count(database, "trial") == trials);
}

TEST_CASE("a trial that does not count leaves the rule as it was, and its stimulus comes again") {
    protocols::Protocol protocol = adaptive_protocol();
    protocol.invalid.path_min = 0.025;  // some hands are slower than that
    const data::SessionSpec spec = session_spec(protocol);
    NewDatabase database;
    REQUIRE(run_simulated(database, spec).why == protocols::SessionEnd::Why::finished);
    const std::int64_t invalid = count(database,
                                       "trial JOIN plan USING (session_id, plan_position) WHERE "
                                       "phase = 'main' AND invalid_reason IS NOT NULL");
    CAPTURE(invalid);
    CHECK(invalid > 3);
    CHECK(count(database,
                "adaptive_step JOIN trial USING (trial_id) WHERE invalid_reason IS NOT NULL") == 0);
    CHECK(differences(database).empty());
}

TEST_CASE("what a trial says of two intervals is of both together") {
    NewDatabase database;
    REQUIRE(run_simulated(database, session_spec(adaptive_protocol())).why ==
            protocols::SessionEnd::Why::finished);
    const std::int64_t felt = count(database, "presentation WHERE interval = 2");
    CHECK(felt > 10);
    CHECK(count(database,
                "(SELECT trial_id, sum(done_s) AS done FROM presentation "
                "GROUP BY trial_id) JOIN analysis_trial USING (trial_id) JOIN trial USING "
                "(trial_id) WHERE abs(done - trial.done_s) < 1e-9 AND contact_s <= done + 1e-9") ==
          count(database, "trial"));
    database.execute(
        "UPDATE trial SET done_s = (SELECT done_s FROM presentation AS last WHERE "
        "last.trial_id = trial.trial_id AND interval = 2) WHERE trial_id = 4");
    CHECK_THAT(differences(database), Has("done_s"));
}

TEST_CASE("an answer marked after a break is forgotten by the rule, and verify knows") {
    const data::SessionSpec spec = session_spec(adaptive_protocol());
    NewDatabase database;
    dies_in(database, spec, 40);
    CHECK_FALSE(data::mark_invalid(database, 5, {"the phone rang"}).finished);
    REQUIRE(run_simulated(database, spec).why == protocols::SessionEnd::Why::finished);
    CHECK(count(database, "analysis_trial WHERE run_trial_number IS NOT NULL AND counts") == 14);
    CHECK(count(database, "analysis_trial WHERE run_trial_number IS NOT NULL AND NOT counts") == 1);
    CHECK(differences(database) == "");
}

TEST_CASE("a part that is begun again keeps its answers apart, and the rest goes as planned") {
    const bool adaptive = GENERATE(true, false);
    const auto how = GENERATE(data::Resume::redo_block, data::Resume::redo_practice);
    const int at = GENERATE(3, 25, 44);
    CAPTURE(adaptive, static_cast<int>(how), at);
    const TemporaryFolder folder;
    protocols::Protocol protocol = adaptive_protocol();
    if (!adaptive) {
        protocol.procedure.reset();
        protocol.runs.clear();
        protocol.response = {};
        protocol.objects = small_protocol().objects;
        protocol.design = {.repetitions = 2, .catch_trials = 0, .blocks = 2};
    }
    data::SessionSpec spec = session_spec(protocol);
    spec.kind = data::RunKind::simulated;
    // As of a present palpate: verify computes the answers again, each from its trial's number.
    spec.provenance = {{"build id", "test"}};
    for (const auto& [key, hash] : protocols::object_hashes(protocol)) {
        spec.provenance.emplace_back(key, hash);
    }
    Database database(folder.file("a.sqlite"), Access::write);
    dies_in(database, spec, at);
    const std::int64_t answered = count(database, "response");
    spec.resume = how;
    CHECK(std::ranges::is_sorted(data::open_session(database, spec).progress.pending().order()));
    const std::int64_t marked = count(database, "trial WHERE invalid_reason IS NOT NULL");
    CHECK((marked > 0) == (count(database, "event WHERE event_kind = 'redo'") == 1));
    CHECK(marked == count(database, "event WHERE event_kind = 'mark'"));
    CHECK(count(database, "response") == answered);
    spec.resume = data::Resume::go_on;
    REQUIRE(run_simulated(database, spec).why == protocols::SessionEnd::Why::finished);
    CHECK(count(database,
                "(SELECT DISTINCT plan_position FROM trial JOIN response USING (trial_id) WHERE "
                "invalid_reason IS NULL)") == static_cast<std::int64_t>(spec.plan.trials.size()));
    CHECK(count(database, "trial JOIN response USING (trial_id) WHERE invalid_reason IS NULL") ==
          static_cast<std::int64_t>(spec.plan.trials.size()));
    CHECK(differences(database) == "");
    if (at == 25) {  // in a file where its trials have other numbers
        Database other(folder.file("b.sqlite"), Access::write);
        dies_in(other, session_spec(protocol, "P2"), at);
        const std::string all = folder.file("all.sqlite");
        REQUIRE(data::merge_files(all, {folder.file("b.sqlite")}).conflicts.empty());
        REQUIRE(data::merge_files(all, {folder.file("a.sqlite")}).conflicts.empty());
        Database merged(all, Access::read);
        CHECK(count(merged, "session") == 2);
        CHECK(differences(merged) == "");
    }
}

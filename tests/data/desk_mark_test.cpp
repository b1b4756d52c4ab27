#include "protocols/observer/simulated_observer.hpp"
#include "protocols/session/session.hpp"
#include "protocols/trial/servo_apparatus.hpp"
#include "data/store/session_store.hpp"
#include "data/store/sqlite_recorder.hpp"
#include "data/verify/verify.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/faulty.hpp"
#include "tests/support/process.hpp"
#include "tests/support/studies.hpp"

using namespace palpate;
using namespace palpate::data;
using namespace palpate::protocols;
using tests::lines;

namespace {

/// Tells where a session is.
class Placed : public tests::FaultyApparatus {
public:
    using FaultyApparatus::FaultyApparatus;
    void begin(const engine::SceneView& scene,
               const PlannedTrial& planned,
               std::size_t interval) override {
        position = planned.position;
        ++attempts[position];
        FaultyApparatus::begin(scene, planned, interval);
    }
    std::size_t position = 0;
    std::map<std::size_t, int> attempts;  ///< begun, by position
};

/// An experimenter who marks an attempt while it is felt, by its position and number, and a session
/// that is stopped at the gap after every `stop_every`-th attempt.
class Marking : public tests::Patient {
public:
    Marking(std::uint64_t seed, Placed& apparatus, OperatorDesk& desk, int stop_every)
        : seed_(seed), apparatus_(apparatus), desk_(desk), stop_every_(stop_every) {}

    ExplorationStep explore(const TrialView& trial, double elapsed_s) override {
        if (elapsed_s >= 0.1 && !decided_) {
            decided_ = true;
            felt = {trial.practice, trial.number, trial.total};
            const auto attempt =
                static_cast<std::uint64_t>(apparatus_.attempts[apparatus_.position]);
            tests::Random random(seed_ * 7919 + apparatus_.position * 31 + attempt);
            if (random.below(3) == 0) {
                desk_.mark();
            }
            if (random.below(4) == 0) {
                desk_.pause();
            }
        }
        return Patient::explore(trial, elapsed_s);
    }
    Signal ready(const TrialView& trial) override {
        decided_ = false;
        return Patient::ready(trial);
    }
    Signal gap(double seconds) override {
        ++gaps_;
        return stop_every_ > 0 && gaps_ % stop_every_ == 0 ? Signal::abort : Patient::gap(seconds);
    }
    Signal pause(const TrialView& /*next*/) override {
        ++pauses;
        return Signal::go_on;
    }
    int pauses = 0;
    TrialNumber felt{};  ///< as its screen said

private:
    std::uint64_t seed_;
    Placed& apparatus_;
    OperatorDesk& desk_;
    int stop_every_;
    int gaps_ = 0;
    bool decided_ = false;
};

/// The attempts of a whole session, whatever stops it on the way.
std::string attempts(std::uint64_t seed, int stop_every) {
    const tests::TemporaryFolder folder;
    Database database(folder.file("a.sqlite"), Access::write);
    const data::SessionSpec spec = tests::session_spec(tests::short_protocol());
    tests::World world{.seed = seed, .fault_share = 0.1, .max_faults = 1};
    Placed apparatus(world);
    int pauses = 0;
    for (int run = 0; run < 200; ++run) {
        const data::OpenedSession opened = data::open_session(database, spec);
        if (opened.finished) {
            break;
        }
        data::SqliteRecorder recorder(database, spec.protocol, opened.id);
        OperatorDesk desk;
        Marking observer(seed, apparatus, desk, stop_every);
        static_cast<void>(run_session(spec.protocol, spec.plan, {}, opened.progress,
                                      {.apparatus = apparatus,
                                       .observer = observer,
                                       .recorder = recorder,
                                       .pause = [](double) {},
                                       .desk = &desk}));
        pauses += observer.pauses;
    }
    CHECK(lines(database, "SELECT count(*) FROM event WHERE event_kind = 'mark'") ==
          lines(database, "SELECT count(*) FROM trial WHERE invalid_reason IS NOT NULL"));
    CHECK(lines(database, "SELECT count(*) FROM event WHERE event_kind = 'pause'") ==
          std::to_string(pauses) + " \n");
    CHECK(lines(database, "SELECT finished FROM session") == "1 \n");
    CHECK(lines(database, "SELECT count(*) FROM response JOIN trial USING (trial_id)") !=
          lines(database, "SELECT count(*) FROM plan"));  // something was marked, its answer kept
    CHECK(lines(database,
                "SELECT count(DISTINCT plan_position) FROM trial WHERE invalid_reason IS NULL AND "
                "outcome = 'complete'") == lines(database, "SELECT count(*) FROM plan"));
    return lines(database,
                 "SELECT plan_position, outcome, coalesce(invalid_reason, '-') FROM trial ORDER BY "
                 "trial_id");
}

/// A simulated participant, and an experimenter at the desk on every screen.
class AtTheDesk : public SimulatedObserver {
public:
    AtTheDesk(const data::SessionSpec& spec,
              std::uint64_t seed,
              OperatorDesk& desk,
              std::function<bool()> done)
        : SimulatedObserver(
              spec.protocol, session_stream(spec), spec.plan.picture_order, std::move(done)),
          random_(seed),
          desk_(desk) {}
    Signal ready(const TrialView& trial) override {
        maybe(6);
        return SimulatedObserver::ready(trial);
    }
    Choice choose(const TrialView& trial, const Question& question) override {
        maybe(5);
        return SimulatedObserver::choose(trial, question);
    }
    Signal gap(double seconds) override {
        maybe(6);
        return SimulatedObserver::gap(seconds);
    }
    Signal rest(double seconds, const TrialView& next) override {
        maybe(2);
        return SimulatedObserver::rest(seconds, next);
    }

private:
    void maybe(int one_in) {
        if (random_.below(one_in) == 0) {
            desk_.mark();
        }
        if (random_.below(8) == 0) {
            desk_.pause();
        }
    }
    tests::Random random_;
    OperatorDesk& desk_;
};

}  // namespace

TEST_CASE("with marks at the desk a session that is resumed runs the order of an unbroken one",
          "[session][desk][law]") {
    const auto seed = GENERATE(palpate::tests::seeds(2ULL));
    CAPTURE(seed);
    const std::string unbroken = attempts(seed, 0);
    CHECK(unbroken.find(kMarkedAtDesk) != std::string::npos);
    for (const int stop_every : {1, 4}) {
        CAPTURE(stop_every);
        CHECK(attempts(seed, stop_every) == unbroken);
    }
}

TEST_CASE("verify finds nothing wrong in a session with marks and pauses on every screen",
          "[session][desk][law]") {
    const auto seed = GENERATE(palpate::tests::seeds(2ULL));
    CAPTURE(seed);
    const tests::TemporaryFolder folder;
    Database database(folder.file("a.sqlite"), Access::write);
    Protocol protocol = tests::short_protocol();
    protocol.timing.explore_prompt = 3.0;
    protocol.timing.explore_timeout = 3.0;
    const data::SessionSpec spec = tests::session_spec(protocol);
    SimulatedApparatus apparatus(protocol, {protocol, spec.protocol_hash, spec.key, spec.seed});
    double waited_s = 0.0;
    {
        const data::OpenedSession opened = data::open_session(database, spec);
        data::SqliteRecorder recorder(database, spec.protocol, opened.id);
        OperatorDesk desk;
        AtTheDesk observer(spec, seed, desk, [&] { return apparatus.hand_is_done(); });
        SessionView view;
        view.trials = spec.plan.trials.size();
        view.simulated = true;
        const SessionEnd end =
            run_session(spec.protocol, spec.plan, view, opened.progress,
                        {.apparatus = apparatus,
                         .observer = observer,
                         .recorder = recorder,
                         .progress = [&](const Progress& one) { waited_s += one.waited_s; },
                         .pause = [](double) {},
                         .desk = &desk});
        CHECK(end.why == SessionEnd::Why::finished);
    }
    CHECK(waited_s > 0.0);
    CHECK(waited_s == Approx(std::stod(lines(database,
                                             "SELECT sum(duration_s) FROM event WHERE "
                                             "event_kind = 'go on'"))));
    CHECK(lines(database, "SELECT count(*) > 2 FROM event WHERE event_kind = 'mark'") == "1 \n");
    CHECK(lines(database, "SELECT count(*) > 1 FROM event WHERE event_kind = 'pause'") == "1 \n");
    const data::Verification found = data::verify(database);
    for (const auto& session : found.sessions) {
        for (const auto& finding : session.findings) {
            CAPTURE(finding.what, finding.stored, finding.recomputed);
            CHECK(finding.kind != data::FindingKind::differs);
        }
    }
    CHECK(found.count(data::FindingKind::differs) == 0);
}

TEST_CASE("a mark is answered with the trial that does not count, or that there is none to mark",
          "[session][desk][law]") {
    const auto seed = GENERATE(palpate::tests::seeds(4ULL));
    CAPTURE(seed);
    const tests::TemporaryFolder folder;
    Database database(folder.file("a.sqlite"), Access::write);
    Protocol protocol = tests::short_protocol();
    protocol.invalid.max_requeues = seed % 2;  // 0: what is marked is not run again
    const data::SessionSpec spec = tests::session_spec(protocol);
    tests::World world{.seed = seed, .fault_share = 0.3};
    Placed apparatus(world);
    const data::OpenedSession opened = data::open_session(database, spec);
    data::SqliteRecorder recorder(database, spec.protocol, opened.id);
    OperatorDesk desk;
    Marking observer(seed, apparatus, desk, 0);
    std::vector<MarkReply> replies;
    const auto answered = [&](const MarkReply& said) {
        replies.push_back(said);
        const std::optional<MarkReply> shown = desk.take_reply();
        REQUIRE(shown.has_value());
        CHECK(shown->found == said.found);
        CHECK(shown->trial == said.trial);
        CHECK(said.found == (lines(database,
                                   "SELECT outcome FROM trial ORDER BY trial_id DESC "
                                   "LIMIT 1") == "complete \n"));
        CHECK(said.number == (said.found ? observer.felt : TrialNumber{}));
    };
    static_cast<void>(run_session(spec.protocol, spec.plan, {}, opened.progress,
                                  {.apparatus = apparatus,
                                   .observer = observer,
                                   .recorder = recorder,
                                   .marked = answered,
                                   .pause = [](double) {},
                                   .desk = &desk}));
    CHECK(replies.size() > 3);
    std::string marked;
    for (const MarkReply& one : replies) {
        if (one.found) {
            marked += fmt::format("{} {} \n", one.trial, one.runs_again ? 1 : 0);
        }
    }
    CHECK(lines(database,
                "SELECT trial_id, EXISTS (SELECT 1 FROM trial AS later WHERE later.plan_position = "
                "trial.plan_position AND later.trial_id > trial.trial_id) FROM trial WHERE "
                "invalid_reason IS NOT NULL ORDER BY trial_id") == marked);
}

namespace {

/// Marks in the first break.
class InABreak : public tests::Patient {
public:
    InABreak(Database& database, OperatorDesk& desk) : database_(database), desk_(desk) {}
    Signal rest(double /*seconds*/, const TrialView& /*next*/) override {
        if (kept.empty()) {
            desk_.mark();
            kept = lines(database_, "SELECT count(*) FROM event WHERE event_kind = 'mark'");
            reply = desk_.take_reply();
        }
        return Signal::go_on;
    }
    std::string kept;  ///< marks in the database before the break was over
    std::optional<MarkReply> reply;

private:
    Database& database_;
    OperatorDesk& desk_;
};

}  // namespace

TEST_CASE("a mark in a break is kept and answered in the break", "[session][desk][law]") {
    const tests::TemporaryFolder folder;
    Database database(folder.file("a.sqlite"), Access::write);
    const data::SessionSpec spec = tests::session_spec(tests::short_protocol());
    const data::OpenedSession opened = data::open_session(database, spec);
    data::SqliteRecorder recorder(database, spec.protocol, opened.id);
    tests::World world;
    Placed apparatus(world);
    OperatorDesk desk;
    InABreak observer(database, desk);
    static_cast<void>(run_session(spec.protocol, spec.plan, {}, opened.progress,
                                  {.apparatus = apparatus,
                                   .observer = observer,
                                   .recorder = recorder,
                                   .pause = [](double) {},
                                   .desk = &desk}));
    CHECK(observer.kept == "1 \n");
    REQUIRE(observer.reply);
    CHECK(observer.reply->found);
    CHECK(lines(database,
                "SELECT count(*) FROM trial JOIN response USING (trial_id) WHERE invalid_reason IS "
                "NULL AND trial_id = " +
                    std::to_string(observer.reply->trial)) == "0 \n");
}

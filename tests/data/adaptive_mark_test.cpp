#include "protocols/observer/simulated_observer.hpp"
#include "protocols/trial/servo_apparatus.hpp"
#include "data/store/people.hpp"
#include "data/store/sqlite_recorder.hpp"
#include "tests/support/adaptive.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/process.hpp"
#include "tests/support/studies.hpp"

using namespace palpate;
using namespace palpate::data;
using namespace palpate::tests;
using namespace palpate::protocols;

namespace {

/// An experimenter at the desk who marks about every third attempt: while the first or the second
/// interval is felt, at the question, at the gap after it, or when the next trial is ready.
class Marking : public SimulatedObserver {
public:
    Marking(const data::SessionSpec& spec,
            std::uint64_t seed,
            OperatorDesk& desk,
            std::function<bool()> done)
        : SimulatedObserver(
              spec.protocol, session_stream(spec), spec.plan.picture_order, std::move(done)),
          seed_(seed),
          desk_(desk) {}

    Signal ready(const TrialView& trial) override {
        if (trial.interval == 1) {
            at(Place::next, attempt_);
        }
        return SimulatedObserver::ready(trial);
    }
    ExplorationStep explore(const TrialView& trial, double elapsed_s) override {
        feels_ = true;
        at(trial.interval == 1 ? Place::first : Place::second, attempt_ + 1);
        return SimulatedObserver::explore(trial, elapsed_s);
    }
    Choice choose(const TrialView& trial, const Question& question) override {
        at(Place::question, ++attempt_);
        feels_ = false;
        return SimulatedObserver::choose(trial, question);
    }
    Signal gap(double seconds) override {
        if (!feels_) {
            at(Place::gap, attempt_);
        }
        return SimulatedObserver::gap(seconds);
    }

private:
    enum class Place : std::uint8_t { first, second, question, gap, next };

    void at(Place place, int attempt) {
        Random random(seed_ * 7919 + static_cast<std::uint64_t>(attempt));
        if (random.below(3) == 0 && random.below(5) == static_cast<int>(place) &&
            marked_.insert(attempt).second) {
            desk_.mark();
        }
    }

    std::uint64_t seed_;
    OperatorDesk& desk_;
    std::set<int> marked_;  ///< once each
    int attempt_ = 0;       ///< answered so far
    bool feels_ = false;
};

/// Dies when a trial has been stored whose number is among those to be marked.
class Dying : public data::SqliteRecorder {
public:
    struct Died {
        TrialId trial = 0;
    };
    Dying(Database& database, const Protocol& protocol, std::int64_t session, std::set<TrialId>& at)
        : SqliteRecorder(database, protocol, session), at_(at) {}
    void end_trial(TrialId trial, const TrialResult& result) override {
        SqliteRecorder::end_trial(trial, result);
        if (at_.erase(trial) > 0) {
            throw Died{trial};
        }
    }

private:
    std::set<TrialId>& at_;
};

/// Opens or resumes; marks of the desk where a seed is given.
SessionEnd run(Database& database,
               const data::SessionSpec& spec,
               std::optional<std::uint64_t> seed,
               std::set<TrialId>& die_at) {
    const data::OpenedSession opened = data::open_session(database, spec);
    SimulatedApparatus apparatus(spec.protocol,
                                 DrawnHand(spec.protocol, spec.protocol_hash, spec.key, spec.seed));
    OperatorDesk desk;
    const auto done = [&] {
        return apparatus.hand_is_done();
    };
    SimulatedObserver plain(spec.protocol, session_stream(spec), spec.plan.picture_order, done);
    Marking marking(spec, seed.value_or(0), desk, done);
    Dying recorder(database, spec.protocol, opened.id, die_at);
    return run_session(spec.protocol, spec.plan,
                       {.title = spec.protocol.title,
                        .participant = spec.key.participant,
                        .trials = spec.plan.trials.size(),
                        .next = opened.progress.pending().answered(),
                        .simulated = true,
                        .device = "test"},
                       opened.progress,
                       {.apparatus = apparatus,
                        .observer = seed ? marking : plain,
                        .recorder = recorder,
                        .pause = [](double) {},
                        .desk = &desk});
}

/// Every attempt in its order: what was felt, answered and taken in by the rule, and what was
/// marked when.
std::string attempts(Database& database) {
    std::string text;
    for (const char* sql : {"SELECT trial_id, plan_position, outcome, invalid_reason, ticks, "
                            "path_length_m FROM trial ORDER BY trial_id",
                            "SELECT * FROM presentation ORDER BY trial_id, interval",
                            "SELECT * FROM response ORDER BY trial_id",
                            "SELECT * FROM adaptive_step ORDER BY trial_id",
                            "SELECT trial_id, event_kind, text FROM event WHERE event_kind = "
                            "'mark' ORDER BY event_id"}) {
        for (const data::Statement& row : database.prepare(sql)) {
            for (int column = 0; column < row.columns(); ++column) {
                text += row.null(column)      ? "-"
                      : row.type(column) == 2 ? fmt::format("{:a} ", row.real(column))
                                              : row.text(column) + ' ';
            }
            text += '\n';
        }
    }
    return text;
}

std::set<TrialId> marked(Database& database) {
    std::set<TrialId> ids;
    for (const auto& row :
         database.prepare("SELECT trial_id FROM trial WHERE invalid_reason = ?1 ORDER BY trial_id",
                          kMarkedAtDesk)) {
        ids.insert(row.integer(0));
    }
    return ids;
}

}  // namespace

TEST_CASE("a mark at the desk does to a rule what the same mark from outside and a resume do",
          "[adaptive][desk][law]") {
    const bool staircase = GENERATE(false, true);
    const std::string& rule = staircase ? kStaircaseRule : kQuestPlusRule;
    const char* kind = staircase ? "two_interval" : "yes_no";
    std::size_t marks = 0;
    std::int64_t of_the_rule = 0;
    std::int64_t ruled_out = 0;
    for (std::uint64_t seed = 0; seed < 2; ++seed) {
        CAPTURE(kind, seed);
        const TemporaryFolder folder;
        Protocol protocol = adaptive_protocol(rule, kind);
        protocol.timing.explore_min = 0.1;
        protocol.timing.explore_prompt = 0.3;
        protocol.timing.explore_timeout = 0.4;
        protocol.invalid.path_min = seed % 2 == 0 ? 0.0 : 0.03;  // some hands are slower than that
        const data::SessionSpec spec = session_spec(protocol, fmt::format("P{:02}", seed + 1));
        Database inside(folder.file("inside.sqlite"), Access::write);
        inside.execute("PRAGMA synchronous = OFF");
        std::set<TrialId> never;
        REQUIRE(run(inside, spec, seed, never).why == SessionEnd::Why::finished);
        const std::set<TrialId> ids = marked(inside);
        marks += ids.size();
        of_the_rule +=
            count(inside, "analysis_trial WHERE run_trial_number IS NOT NULL AND NOT counts");
        ruled_out += count(inside, "trial WHERE invalid_reason IS NOT NULL") -
                     static_cast<std::int64_t>(ids.size());

        Database outside(folder.file("outside.sqlite"), Access::write);
        outside.execute("PRAGMA synchronous = OFF");
        std::set<TrialId> left = ids;
        std::optional<SessionEnd> end;
        while (!end) {
            try {
                end = run(outside, spec, std::nullopt, left);
            } catch (const Dying::Died& died) {
                CHECK_FALSE(data::mark_invalid(outside, died.trial, {kMarkedAtDesk}).finished);
            }
        }
        REQUIRE(end->why == SessionEnd::Why::finished);
        REQUIRE(attempts(inside) == attempts(outside));
        CHECK(differences(inside) == "");
        CHECK(differences(outside) == "");
    }
    CHECK(marks >= 3);
    CHECK(of_the_rule >= 1);  // the others in practice
    CHECK(ruled_out >= 1);
}

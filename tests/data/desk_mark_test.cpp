#include "tests/support/catch.hpp"
#include "tests/support/faulty.hpp"

using namespace palpate::data;
using namespace palpate::protocols;

namespace {

/// An experimenter who marks and pauses while an attempt is felt, now and then.
class Marking : public tests::Patient {
public:
    Marking(std::uint64_t seed, OperatorDesk& desk) : random_(seed), desk_(desk) {}

    ExplorationStep explore(const TrialView& trial, double elapsed_s) override {
        if (elapsed_s >= 0.1 && !decided_) {
            decided_ = true;
            felt = {trial.practice, trial.number, trial.total};
            if (random_.below(3) == 0) {
                desk_.mark();
            }
            if (random_.below(4) == 0) {
                desk_.pause();
            }
        }
        return Patient::explore(trial, elapsed_s);
    }
    Signal ready(const TrialView& trial) override {
        decided_ = false;
        return Patient::ready(trial);
    }
    Signal pause(const TrialView& /*next*/) override { return Signal::go_on; }
    TrialNumber felt{};  ///< as its screen said

private:
    tests::Random random_;
    OperatorDesk& desk_;
    bool decided_ = false;
};

}  // namespace

TEST_CASE("a mark is answered with the trial that does not count, or that there is none to mark",
          "[session][desk][law]") {
    SEED(4ULL);
    Protocol protocol = tests::short_protocol();
    protocol.invalid.max_requeues = seed % 2;  // 0: what is marked is not run again
    tests::SmallSession session(protocol);
    Database& database = session.database;
    tests::World world{.seed = seed, .fault_share = 0.3};
    tests::FaultyApparatus apparatus(world);
    OperatorDesk desk;
    Marking observer(seed, desk);
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
    static_cast<void>(run_session(session.spec.protocol, session.spec.plan, {},
                                  session.opened.progress,
                                  {.apparatus = apparatus,
                                   .observer = observer,
                                   .recorder = session.recorder,
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
    tests::SmallSession session(tests::short_protocol());
    Database& database = session.database;
    tests::World world;
    tests::FaultyApparatus apparatus(world);
    OperatorDesk desk;
    InABreak observer(database, desk);
    static_cast<void>(run_session(session.spec.protocol, session.spec.plan, {},
                                  session.opened.progress,
                                  {.apparatus = apparatus,
                                   .observer = observer,
                                   .recorder = session.recorder,
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

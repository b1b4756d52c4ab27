#include "protocols/trial/servo_apparatus.hpp"
#include "data/store/reader.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/faulty.hpp"

using namespace palpate::data;
using namespace palpate::protocols;

namespace {

/// Explores for a second; in its first trial it does something at 0.4 s.
class Acting : public Patient {
public:
    explicit Acting(std::function<void()> act) : act_(std::move(act)) {}

    Signal ready(const TrialView& trial) override {
        before_trial();
        return Patient::ready(trial);
    }
    ExplorationStep explore(const TrialView& trial, double elapsed_s) override {
        static_cast<void>(trial);
        if (elapsed_s >= 0.4 && act_) {
            std::exchange(act_, nullptr)();
        }
        return {.signal = elapsed_s >= 1.0 ? Signal::done : Signal::go_on, .at_s = elapsed_s};
    }

    std::function<void()> before_trial = [] {
    };

private:
    std::function<void()> act_;
};

Protocol held_protocol() {
    Protocol protocol = small_protocol();
    protocol.timing.explore_min = 0.0;
    protocol.safety.dead_man = true;
    protocol.invalid = {.late_share = 1.0, .contact_min = 0.0, .path_min = 0.0};
    return protocol;
}

SessionEnd felt_by(
    SmallSession& session,
    Apparatus& apparatus,
    Observer& observer,
    OperatorDesk* desk = nullptr,
    const std::function<void(const MarkReply&)>& marked = [](const MarkReply&) {}) {
    return run_session(session.spec.protocol, session.spec.plan, {}, session.progress,
                       {.apparatus = apparatus,
                        .observer = observer,
                        .recorder = session.recorder,
                        .marked = marked,
                        .pause = [](double) {},
                        .desk = desk});
}

/// A session on the simulated pantograph, through the safety chain, into a file.
struct FeltRun : SmallSession {
    explicit FeltRun(const Protocol& protocol)
        : SmallSession(protocol),
          apparatus(protocol, {protocol, spec.protocol_hash, spec.key, spec.seed}) {}

    SessionEnd with(Observer& observer) { return felt_by(*this, apparatus, observer); }
    std::string lines(const std::string& sql) { return tests::lines(database, sql); }

    SimulatedApparatus apparatus;
};

/// Attempts in order, with outcome and cause.
constexpr const char* kAttempts =
    "SELECT trial.plan_position, outcome, coalesce(trial.fault_cause, '-') FROM trial LEFT JOIN "
    "fault ON fault.trial_id = trial.trial_id ORDER BY trial.trial_id";

/// The first trial faulted by `cause` and came again where its key says; all others went well.
std::string one_fault(const data::SessionSpec& spec, const std::string& cause) {
    std::string text = "0 faulted " + cause + " \n";
    PendingTrials pending(spec.plan, RequeueRule{.key = session_stream(spec),
                                                 .max = spec.protocol.invalid.max_requeues});
    for (pending.note(0, Outcome::faulted); !pending.empty();) {
        text += std::to_string(pending.next()) + " complete - \n";
        pending.note(pending.next(), Outcome::complete);
    }
    return text;
}

/// What the database keeps of a trial that faulted: its trace and its last ticks end with the trip.
void check_last_ticks(FeltRun& run) {
    auto row = run.database.prepare("SELECT trial_id FROM fault ORDER BY trial_id");
    std::size_t faults = 0;
    while (row.step()) {
        ++faults;
        const std::int64_t trial = row.integer(0);
        const auto trace = data::TraceReader(run.database).read(trial);
        REQUIRE_FALSE(trace.empty());
        const std::size_t last = std::min<std::size_t>(trace.size(), 100);
        CHECK((trace.back().flags & engine::tick_fault) != 0);
        CHECK(trace.back().command == engine::Vec3{});
        CHECK(std::none_of(trace.begin(), trace.end() - 1, [](const engine::TickRecord& tick) {
            return (tick.flags & engine::tick_fault) != 0;
        }));
        auto kept = run.database.prepare(
            "SELECT tick, hip_x_m, rendered_y_n, flags FROM fault_tick WHERE trial_id = ?1 ORDER "
            "BY tick",
            trial);
        for (std::size_t i = trace.size() - last; i < trace.size(); ++i) {
            REQUIRE(kept.step());
            CHECK(kept.integer(0) == trace[i].tick);
            CHECK(kept.real(1) == trace[i].hip.x);
            CHECK(kept.real(2) == trace[i].force.y);
            CHECK(kept.integer(3) == trace[i].flags);
        }
        CHECK_FALSE(kept.step());
    }
    CHECK(faults > 0);
}

/// An experimenter who marks and pauses while an attempt is felt, now and then.
class Marking : public Patient {
public:
    Marking(std::uint64_t seed, OperatorDesk& desk) : random_(seed), desk_(desk) {}

    ExplorationStep explore(const TrialView& trial, double elapsed_s) override {
        if (elapsed_s >= 0.1 && !decided_) {
            decided_ = true;
            felt = {trial.practice, trial.number, trial.total};
            if (random_.below(3) == 0) {
                desk_.mark("a sneeze");
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
    Random random_;
    OperatorDesk& desk_;
    bool decided_ = false;
};

/// Marks in the first break.
class InABreak : public Patient {
public:
    InABreak(Database& database, OperatorDesk& desk) : database_(database), desk_(desk) {}
    Signal rest(double /*seconds*/, const TrialView& next) override {
        if (kept.empty()) {
            desk_.mark();
            comes = {next.practice, next.number, next.total};
            kept = lines(database_, "SELECT count(*) FROM event WHERE event_kind = 'mark'");
            reply = desk_.take_reply();
        }
        return Signal::go_on;
    }
    std::string kept;  ///< marks in the database before the break was over
    TrialNumber comes{};
    std::optional<MarkReply> reply;

private:
    Database& database_;
    OperatorDesk& desk_;
};

}  // namespace

TEST_CASE(
    "Escape in a trial: force off at that tick, cause stopped, kept, and answered at the end") {
    FeltRun run(held_protocol());
    class Watching : public Acting {
    public:
        using Acting::Acting;
        std::optional<Signal> trouble(const TroubleView& view) override {
            by_hand = view.by_hand;
            return Acting::trouble(view);
        }
        bool by_hand = false;  ///< a screen then waits for the experimenter
    } observer([&] { run.apparatus.stop(); });
    CHECK(run.with(observer).why == SessionEnd::Why::finished);
    CHECK(observer.by_hand);
    CHECK(run.lines(kAttempts) == one_fault(run.spec, "stopped"));
    check_last_ticks(run);
    // In the slice after the key, and the force was on before.
    CHECK(run.lines("SELECT count(*), max(tick) FROM fault_tick") == "100 400 \n");
    CHECK(run.lines("SELECT count(*) FROM response") ==
          std::to_string(run.spec.plan.trials.size()) + " \n");
    CHECK(run.lines(
              "SELECT event_kind, text FROM event WHERE event_kind <> 'start' ORDER BY rowid") ==
          "fault position 0: stopped: somebody stopped the force: the experimenter's chord for "
          "pauses goes on \n"
          "reconnect the device works, after 0 tries in vain \n"
          "go on after stopped \n");
}

TEST_CASE("letting go where a dead-man key is wanted ends the force, until it is held again") {
    FeltRun run(held_protocol());
    Acting observer([&] { run.apparatus.hold(false); });
    observer.before_trial = [&] {
        run.apparatus.hold(true);
    };
    CHECK(run.with(observer).why == SessionEnd::Why::finished);
    CHECK(run.lines(kAttempts) == one_fault(run.spec, "let_go"));
    check_last_ticks(run);
    CHECK(run.lines("SELECT count(*), max(tick) FROM fault_tick") == "100 400 \n");
}

TEST_CASE("whoever does not hold the key again gets no force at all, trial after trial") {
    FeltRun run(held_protocol());
    class Headless : public Acting {
    public:
        using Acting::Acting;
        std::optional<Signal> trouble(const TroubleView& view) override {
            return Observer::trouble(view);
        }
    } observer([&] { run.apparatus.hold(false); });
    const SessionEnd end = run.with(observer);
    CHECK(end.why == SessionEnd::Why::faulted);
    CHECK(end.in_a_row == 3);
    CHECK(end.fault == "the participant let go: hold the handle, and the dead-man key, until done");
    CHECK(run.lines("SELECT fault_cause, ticks_kept FROM fault ORDER BY trial_id") ==
          "let_go 100 \nlet_go 1 \nlet_go 1 \n");
}

TEST_CASE("without a dead-man key nobody has to hold anything") {
    Protocol protocol = held_protocol();
    protocol.safety.dead_man = false;
    FeltRun run(protocol);
    Acting observer([&] { run.apparatus.hold(false); });
    CHECK(run.with(observer).why == SessionEnd::Why::finished);
    CHECK(run.lines("SELECT count(*) FROM fault") == "0 \n");
}

TEST_CASE("in real time an event tells how late the ticks were, at each fault and at the end") {
    class Still : public engine::Device {
    public:
        engine::Reading read() noexcept override { return {.hip = {0.0, 0.06, 0.0}}; }
        engine::AppliedForce write(const engine::Vec3& /*force*/) noexcept override { return {}; }
        [[nodiscard]] std::string name() const override { return "still"; }
        [[nodiscard]] engine::DeviceTraits traits() const noexcept override {
            return {.gives_force = false};
        }
    };
    Protocol protocol = held_protocol();
    protocol.apparatus.force_ramp = 0.0;
    FeltRun run(protocol);
    DeviceApparatus apparatus(protocol, std::make_unique<Still>());
    CHECK(apparatus.timing().empty());  // no tick yet
    class Brief : public Patient {
    public:
        explicit Brief(Apparatus& apparatus) : apparatus_(apparatus) {}
        ExplorationStep explore(const TrialView& /*trial*/, double elapsed_s) override {
            if (!std::exchange(stopped_, true)) {
                apparatus_.stop();
            }
            return {.signal = elapsed_s >= 0.02 ? Signal::done : Signal::go_on, .at_s = elapsed_s};
        }

    private:
        Apparatus& apparatus_;
        bool stopped_ = false;
    } observer(apparatus);
    CHECK(run_session(protocol, run.spec.plan, {}, run.progress,
                      {.apparatus = apparatus, .observer = observer, .recorder = run.recorder})
              .why == SessionEnd::Why::finished);
    CHECK(run.lines("SELECT count(*) FROM event WHERE event_kind = 'timing' AND text LIKE '% "
                    "ticks, late by % (half of them), % (99 %), % (worst); %'") == "2 \n");
    CHECK(run.lines("SELECT event_kind FROM event WHERE event_kind <> 'start' ORDER BY rowid") ==
          "fault \ntiming \nreconnect \ngo on \ntiming \n");
}

TEST_CASE("a mark is answered with the trial that does not count, or that there is none to mark") {
    SEED(4ULL);
    Protocol protocol = short_protocol();
    protocol.invalid.max_requeues = seed % 2;  // 0: what is marked is not run again
    SmallSession session(protocol);
    Database& database = session.database;
    World world{.seed = seed, .fault_share = 0.3};
    FaultyApparatus apparatus(world);
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
    static_cast<void>(felt_by(session, apparatus, observer, &desk, answered));
    CHECK(replies.size() > 3);
    CHECK(lines(database,
                "SELECT count(*) FROM event WHERE event_kind IN ('mark', 'note') AND text "
                "LIKE '%: a sneeze'") == fmt::format("{} \n", replies.size()));
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

TEST_CASE("a mark in a break is kept and answered in the break") {
    SmallSession session(short_protocol());
    Database& database = session.database;
    World world;
    FaultyApparatus apparatus(world);
    OperatorDesk desk;
    InABreak observer(database, desk);
    static_cast<void>(felt_by(session, apparatus, observer, &desk));
    CHECK(observer.kept == "1 \n");
    REQUIRE(observer.reply);
    CHECK((observer.comes == observer.reply->number && observer.comes == observer.reply->next));
    CHECK(observer.reply->found);
    CHECK(lines(database,
                "SELECT count(*) FROM trial JOIN response USING (trial_id) WHERE invalid_reason IS "
                "NULL AND trial_id = " +
                    std::to_string(observer.reply->trial)) == "0 \n");
}

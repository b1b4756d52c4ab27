#include "protocols/session/trouble.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/faulty.hpp"

using namespace palpate::protocols;
using Why = SessionEnd::Why;

namespace {

const Protocol kShortProtocol = short_protocol();
const Plan kShortPlan = plan_of(kShortProtocol);

struct Made {
    std::size_t position = 0;
    bool running = true;
    Outcome outcome = Outcome::interrupted;
    TrialResult result{};
};

/// Keeps everything, and ends the program at a given call.
class Ledger : public protocols::Recorder {
public:
    TrialId begin_trial(const PlannedTrial& planned) override {
        call();
        attempts.push_back({.position = planned.position});
        return static_cast<TrialId>(attempts.size());
    }
    void append(TrialId /*trial*/, std::span<const engine::TickRecord> /*ticks*/) override {
        call();
    }
    void end_trial(TrialId trial, const TrialResult& result) override {
        call();
        Made& attempt = attempts.at(static_cast<std::size_t>(trial) - 1);
        attempt.running = false;
        attempt.outcome = result.outcome;
        attempt.result = result;
    }
    void event(const Event& event) override {
        call();
        events.push_back(std::string(to_string(event.kind)) + ": " + event.text);
    }
    void finish_session() override { finished = true; }

    [[nodiscard]] SessionProgress progress() const {
        SessionProgress progress(kShortProtocol, kShortPlan, {});
        for (const Made& made : attempts) {
            progress = apply(std::move(progress), {.position = made.position,
                                                   .outcome = made.outcome,
                                                   .counts = made.result.response.has_value()});
        }
        return progress;
    }
    [[nodiscard]] std::size_t count(const std::string& kind) const {
        return static_cast<std::size_t>(std::count_if(
            events.begin(), events.end(),
            [&](const std::string& event) { return event.starts_with(kind + ": "); }));
    }

    std::vector<Made> attempts;
    std::vector<std::string> events;
    bool finished = false;
    std::size_t pauses = 0;
    int calls_left = -1;  ///< < 0: never killed

private:
    void call() {
        if (calls_left >= 0 && calls_left-- == 0) {
            throw Killed{};
        }
    }
};

SessionEnd run(World& world, Observer& observer, Ledger& ledger) {
    FaultyApparatus apparatus(world);
    const SessionEnd end = run_session(kShortProtocol, kShortPlan, {}, ledger.progress(),
                                       {.apparatus = apparatus,
                                        .observer = observer,
                                        .recorder = ledger,
                                        .pause = [&](double seconds) {
                                            CHECK(seconds == kTroubleSlice);
                                            CHECK_FALSE(apparatus.force_on);
                                            ++ledger.pauses;
                                        }});
    CHECK_FALSE(apparatus.force_on);
    return end;
}

/// Positions and outcomes in order, without what a kill cut off.
std::vector<std::pair<std::size_t, Outcome>> felt(const Ledger& ledger) {
    std::vector<std::pair<std::size_t, Outcome>> all;
    for (const Made& attempt : ledger.attempts) {
        if (!attempt.running) {
            all.emplace_back(attempt.position, attempt.outcome);
        }
    }
    return all;
}

/// Who stops at the first trouble.
class Stopping : public Patient {
public:
    std::optional<Signal> trouble(const TroubleView& /*view*/) override { return Signal::abort; }
};

/// What an unbroken session of the same world felt.
std::vector<std::pair<std::size_t, Outcome>> unbroken(World world) {
    Patient observer;
    Ledger ledger;
    CHECK(run(world, observer, ledger).why == Why::finished);
    return felt(ledger);
}

}  // namespace

TEST_CASE(
    "whatever faults, each position is answered once, and faulted ones come again later in their "
    "part") {
    SEED(std::uint64_t{40});
    World world{.seed = seed, .fault_share = 0.1 * static_cast<double>(seed % 8)};
    Patient observer;
    Ledger ledger;
    const SessionEnd end = run(world, observer, ledger);
    CHECK(end.why == Why::finished);
    CHECK(end.next == kShortPlan.trials.size());
    CHECK(ledger.finished);
    std::multiset<std::size_t> answered;
    std::set<std::size_t> repeated_at_once;
    for (std::size_t i = 0; i < ledger.attempts.size(); ++i) {
        const std::size_t at = ledger.attempts[i].position;
        if (i > 0) {  // practice first
            CHECK((kShortPlan.trials[at].phase == Phase::practice ||
                   kShortPlan.trials[ledger.attempts[i - 1].position].phase != Phase::practice ||
                   answered.size() == 6));
        }
        if (is_answered(ledger.attempts[i].outcome)) {
            answered.insert(ledger.attempts[i].position);
        }
        if (i > 0 && ledger.attempts[i].position == ledger.attempts[i - 1].position) {
            repeated_at_once.insert(ledger.attempts[i].position);
        }
    }
    CHECK(answered.size() == kShortPlan.trials.size());
    CHECK(std::set(answered.begin(), answered.end()).size() == kShortPlan.trials.size());
    CHECK(repeated_at_once.size() <= 2);  // only the last one of practice, and of the session
    // Breaks after as many answers as planned, and the numbers on the screen never tell a
    // repetition: practice is counted to its end, then the others.
    constexpr std::size_t kPractice = 6;
    std::vector<std::size_t> rests;
    for (const PlannedTrial& planned : kShortPlan.trials) {
        if (planned.break_before && planned.position > 0) {
            rests.push_back(planned.position + 1 - kPractice);
        }
    }
    CHECK(observer.rests == rests);
    CHECK(std::is_sorted(observer.numbers.begin(), observer.numbers.end()));
    CHECK(observer.numbers.back() == kShortPlan.trials.size());
    CHECK(observer.in_range);
}

TEST_CASE("killed at any moment, any number of times, a session goes on as the unbroken one") {
    SEED(std::uint64_t{40});
    World world{.seed = seed, .fault_share = 0.3};
    const auto expected = unbroken(world);
    Random random(seed);
    Ledger ledger;
    Patient observer;
    std::size_t kills = 0;
    for (bool finished = false; !finished;) {
        ledger.calls_left = random.below(kills < 20 ? 300 : 1'000'000);
        try {
            finished = run(world, observer, ledger).why == Why::finished;
        } catch (const Killed&) {
            ++kills;
            // A fault that no one wrote down before the kill happens to the same trial again.
            world.faults.clear();
            for (const auto& [position, outcome] : felt(ledger)) {
                world.faults[position] += outcome == Outcome::faulted ? 1U : 0U;
            }
        }
    }
    CHECK(kills > 0);
    CHECK(felt(ledger) == expected);
}

TEST_CASE(
    "a fault reaches the recorder with cause, sentence and the last ticks, and is no answer") {
    World world{.fault_share = 1.0, .max_faults = 1, .away = 2};
    Patient observer;
    Ledger ledger;
    CHECK(run(world, observer, ledger).why == Why::finished);
    CHECK(ledger.attempts.size() == 2 * kShortPlan.trials.size());
    for (const Made& attempt : ledger.attempts) {
        if (attempt.outcome != Outcome::faulted) {
            CHECK_FALSE(attempt.result.fault.has_value());
            CHECK(attempt.result.response.has_value());
            CHECK(attempt.result.summary.slewed_ticks == attempt.result.summary.ticks);
            CHECK(attempt.result.summary.stale_ticks == attempt.result.summary.ticks);
            continue;
        }
        REQUIRE(attempt.result.fault.has_value());
        CHECK_FALSE(attempt.result.response.has_value());
        const Fault& fault = *attempt.result.fault;
        CHECK(fault.cause == engine::Trip::over_speed);
        CHECK(fault.text ==
              "the cable is out: put it in");  // the device knows better than the chain
        REQUIRE(fault.last.size() == 100);
        CHECK((fault.last.back().flags & engine::tick_fault) != 0);
        CHECK((fault.last[98].flags & engine::tick_fault) == 0);
    }
    CHECK(ledger.count("fault") == kShortPlan.trials.size());
    CHECK(ledger.count("reconnect") == kShortPlan.trials.size());
    CHECK(ledger.count("go on") == kShortPlan.trials.size());
    CHECK(ledger.count("gave up") == 0);
}

TEST_CASE("the device is asked at once, then at every tenth question, until it is back") {
    World world{.fault_share = 1.0, .max_faults = 1, .away = 3};
    Patient observer;
    Ledger ledger;
    CHECK(run(world, observer, ledger).why == Why::finished);
    const std::size_t faults = kShortPlan.trials.size();
    CHECK(world.asked == 4 * faults);
    CHECK(ledger.pauses == 3 * kSlicesPerTry * faults);
    CHECK(kTroubleSlice * static_cast<double>(kSlicesPerTry) >= 0.5);
    CHECK(observer.troubles.front() ==
          TroubleView{.sentence = "the cable is still out: put it in", .tries = 1});
    // Solved: what was wrong with the device is so no longer.
    CHECK(observer.troubles[30] ==
          TroubleView{.sentence = "the device works again", .solved = true, .tries = 3});
}

TEST_CASE("with nobody there a session gives up after ten tries, or three faults in a row") {
    class Headless : public Patient {
    public:
        std::optional<Signal> trouble(const TroubleView& view) override {
            return Observer::trouble(view);
        }
    };
    {
        World world{.fault_share = 1.0, .max_faults = 1, .away = 1000};
        Headless observer;
        Ledger ledger;
        const SessionEnd end = run(world, observer, ledger);
        CHECK(end.why == Why::faulted);
        CHECK(end.next == 1);  // the first one has been set back
        CHECK(world.asked == 10);
        CHECK(ledger.count("gave up") == 1);
        CHECK(ledger.attempts.size() == 1);
    }
    {
        World world{.fault_share = 1.0, .max_faults = 99};
        Headless observer;
        Ledger ledger;
        CHECK(run(world, observer, ledger).why == Why::faulted);
        CHECK(ledger.attempts.size() == 3);
    }
    {  // a good trial in between starts the count again
        World world{.seed = 3, .fault_share = 0.3};
        Headless observer;
        Ledger ledger;
        CHECK(run(world, observer, ledger).why == Why::finished);
        CHECK(ledger.count("fault") > 3);
    }
}

TEST_CASE("no session goes on before the device works, however often it is asked to") {
    class Hasty : public Patient {
    public:
        std::optional<Signal> trouble(const TroubleView& view) override {
            static_cast<void>(Patient::trouble(view));
            return Signal::go_on;
        }
    };
    World world{.fault_share = 0.4, .away = 5};
    Hasty observer;
    Ledger ledger;
    CHECK(run(world, observer, ledger).why == Why::finished);
    CHECK(world.asked == 6 * ledger.count("fault"));
}

TEST_CASE("a stop or a signal ends a session in trouble as aborted") {
    World world{.fault_share = 1.0, .away = 5};
    Stopping observer;
    Ledger ledger;
    CHECK(run(world, observer, ledger).why == Why::aborted);
    CHECK(ledger.progress().pending().next() == 1);

    FaultyApparatus apparatus(world);
    Patient patient;
    bool arrived = false;
    const SessionEnd end =
        run_session(kShortProtocol, kShortPlan, {}, SessionProgress(kShortProtocol, kShortPlan, {}),
                    {.apparatus = apparatus,
                     .observer = patient,
                     .recorder = ledger,
                     .interrupted = [&] { return arrived; },
                     .pause =
                         [&](double) {
                             arrived = true;
                         }});
    CHECK(end.why == Why::aborted);
}

TEST_CASE(
    "a trip before done spoils the trial although it was seen later, one in the ramp out does "
    "not") {
    Plan plan = kShortPlan;
    plan.trials.resize(1);
    Ledger ledger;
    const auto runs = [&](FaultyApparatus& apparatus) {
        Stopping observer;
        const SessionEnd end =
            run_session(kShortProtocol, plan, {}, SessionProgress(kShortProtocol, plan, {}),
                        {apparatus, observer, ledger});
        REQUIRE(ledger.attempts.size() == 1);
        const bool spoilt = ledger.attempts[0].outcome == Outcome::faulted;
        CHECK((end.why == (spoilt ? Why::aborted : Why::finished)));
        CHECK(ledger.attempts[0].result.fault.has_value() == spoilt);
        return ledger.attempts[0].outcome;
    };
    World world;
    FaultyApparatus apparatus(world);
    SECTION("in the ramp out") {
        apparatus.trips_in_ramp = true;
        CHECK(runs(apparatus) == Outcome::complete);
        REQUIRE(ledger.events.size() == 1);
        CHECK_THAT(ledger.events[0], Has("had ended: late"));
    }
    SECTION("there, told from the strokes before done") {
        apparatus.trips_in_ramp = true;
        apparatus.ramp_trip = engine::Trip::stuck_encoder;
        CHECK(runs(apparatus) == Outcome::faulted);
    }
    SECTION("in the slice in which done is pressed") {
        apparatus.hidden_trip_ms = 300;
        CHECK(runs(apparatus) == Outcome::faulted);
        CHECK(ledger.attempts[0].result.fault->cause == engine::Trip::energy);
    }
}

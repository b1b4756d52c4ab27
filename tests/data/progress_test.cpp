#include "data/store/people.hpp"
#include "tests/support/adaptive.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/faulty.hpp"

using namespace palpate::data;
using namespace palpate::protocols;

namespace {

/// Answers at random, marks, pauses, breaks off, and comes back.
class Fickle : public Patient {
public:
    Fickle(Random& random, OperatorDesk& desk) : random_(random), desk_(desk) {}

    Signal ready(const TrialView& trial) override {
        maybe();
        return random_.below(40) == 0 ? Signal::abort : Patient::ready(trial);
    }
    Choice choose(const TrialView& /*trial*/, const Question& question) override {
        maybe();
        return {.place = random_.index(question.answers)};
    }
    Signal gap(double /*seconds*/) override {
        maybe();
        return random_.below(20) == 0 ? Signal::abort : Signal::go_on;
    }

private:
    void maybe() {
        if (random_.below(8) == 0) {
            desk_.mark();
        }
        if (random_.below(20) == 0) {
            desk_.pause();
        }
    }
    Random& random_;
    OperatorDesk& desk_;
};

/// What a session knew when the file had so many attempts and events.
struct Instant {
    std::size_t attempts = 0;
    std::size_t events = 0;
    SessionProgress known;
};

/// What is known after the first attempts and events of a session, gone through from the beginning
/// with the answers that count then: no step builds on the one before.
struct Oracle {
    PendingTrials pending;
    AdaptiveRuns runs;
    std::set<TrialId> counting;
};

Oracle recomputed(const data::SessionSpec& spec,
                  std::span<const data::StoredAttempt> attempts,
                  std::span<const data::StoredEvent> events) {
    Oracle all{.pending = PendingTrials(spec.plan, {.key = session_stream(spec),
                                                    .max = spec.protocol.invalid.max_requeues}),
               .runs = AdaptiveRuns(spec.protocol, session_stream(spec)),
               .counting = {}};
    std::set<TrialId> marked;
    std::set<std::pair<std::size_t, std::int64_t>> redone;  // part, attempts by then
    for (const data::StoredEvent& stored : events) {
        if (stored.event.kind == EventKind::mark) {
            marked.insert(stored.event.trial.value());
        }
        if (stored.event.kind == EventKind::redo) {
            redone.insert({stored.event.part.value(), stored.trials_begun});
        }
    }
    const auto begin_again = [&](std::int64_t trials) {
        for (const auto& [part, by_then] : redone) {
            if (by_then == trials) {
                all.pending.begin_again(part);
            }
        }
    };
    begin_again(0);
    for (std::size_t i = 0; i < attempts.size(); ++i) {
        const Attempt& attempt = attempts[i].attempt;
        const bool gone = std::ranges::any_of(redone, [&](const auto& redo) {
            return redo.first == all.pending.part_of(attempt.position) &&
                   redo.second > static_cast<std::int64_t>(i);
        });
        const bool counts = attempt.counts && !marked.contains(attempt.trial) && !gone;
        all.pending.note(attempt.position, attempt.outcome, counts);
        if (counts) {
            all.counting.insert(attempt.trial);
            if (attempt.answer) {
                all.runs.update(*attempt.answer);
            }
        }
        begin_again(static_cast<std::int64_t>(i) + 1);
    }
    return all;
}

void check_same(const SessionProgress& known,
                const Oracle& oracle,
                std::span<const data::StoredAttempt> attempts) {
    CHECK(known.pending() == oracle.pending);
    REQUIRE(known.runs().size() == oracle.runs.size());
    for (std::size_t run = 0; run < oracle.runs.size(); ++run) {
        CHECK(known.runs().of(run).state_hash() == oracle.runs.of(run).state_hash());
    }
    std::map<std::size_t, std::size_t> made;
    for (const data::StoredAttempt& stored : attempts) {
        ++made[stored.attempt.position];
        CHECK(known.counts(stored.attempt.trial) == oracle.counting.contains(stored.attempt.trial));
    }
    CHECK(known.attempts() == made);
}

/// One sitting of a session: from its opening to its end, a break-off or a kill.
/// @param moments  what it knew when it was opened and after every attempt
/// @return whether it is finished
bool sit(Database& database,
         data::SessionSpec spec,
         World& world,
         Random& random,
         std::vector<Instant>& moments) {
    constexpr data::Resume kHow[] = {data::Resume::go_on, data::Resume::go_on,
                                     data::Resume::redo_block, data::Resume::redo_practice};
    spec.resume = kHow[random.below(4)];
    const data::OpenedSession opened = data::open_session(database, spec);
    const auto note = [&](const SessionProgress& known) {
        moments.push_back({static_cast<std::size_t>(count(database, "trial")),
                           static_cast<std::size_t>(count(database, "event")), known});
    };
    note(opened.progress);
    if (opened.finished) {
        return true;
    }
    data::SqliteRecorder recorder(database, spec.protocol, opened.id);
    FaultyApparatus apparatus(world);
    OperatorDesk desk;
    Fickle observer(random, desk);
    int left = random.below(12);  // then the program is killed
    try {
        const SessionEnd end = run_session(
            spec.protocol, spec.plan,
            {.title = {}, .participant = {}, .simulated = true, .device = {}}, opened.progress,
            {.apparatus = apparatus,
             .observer = observer,
             .recorder = recorder,
             .progress =
                 [&](const Progress& progress) {
                     note(progress.known);
                     if (--left == 0) {
                         static_cast<void>(recorder.begin_trial(
                             spec.plan.trials[progress.known.pending().empty()
                                                  ? 0
                                                  : progress.known.pending().next()]));
                         throw Killed{};
                     }
                 },
             .pause = [](double) {},
             .desk = &desk});
        return end.why == SessionEnd::Why::finished;
    } catch (const Killed&) {
        return false;
    }
}

Protocol protocol_of(int design) {
    if (design == 0) {
        return short_protocol();
    }
    Protocol protocol = adaptive_protocol(design == 1 ? kQuestPlusRule : kStaircaseRule,
                                          design == 1 ? "two_interval" : "yes_no");
    protocol.timing.explore_min = 0.0;
    protocol.invalid = {.late_share = 1.0, .contact_min = 0.0, .path_min = 0.0};
    return protocol;
}

}  // namespace

TEST_CASE("attempts and events up to any moment, gone through, are what the session knew then") {
    const int design = GENERATE(0, 1, 2);
    std::map<EventKind, int> kinds;
    std::size_t looked = 0;
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
        CAPTURE(design, seed);
        NewDatabase database;
        database.execute("PRAGMA synchronous = OFF");
        const data::SessionSpec spec = session_spec(protocol_of(design));
        World world{.seed = seed, .fault_share = 0.15, .max_faults = 2};
        Random random(seed * 31 + 7);
        std::vector<Instant> moments;
        for (int sitting = 0; sitting < 12; ++sitting) {
            if (sit(database, spec, world, random, moments)) {
                break;
            }
            // Between two sittings somebody marks an answer, perhaps one of long ago.
            if (const auto ids = moments.back().known.counting(1);
                !ids.empty() && sitting % 2 == 0) {
                const TrialId trial = ids[random.index(ids.size())];
                if (count(database,
                          fmt::format("trial WHERE trial_id = {} AND invalid_reason IS NULL",
                                      trial)) == 1) {
                    static_cast<void>(data::mark_invalid(database, trial, {"part 1: position 3"}));
                }
            }
        }
        const auto attempts = data::stored_attempts(database, 1);
        const auto events = data::stored_events(database, 1);
        for (const data::StoredEvent& stored : events) {
            ++kinds[stored.event.kind];
        }
        for (const Instant& moment : moments) {
            CAPTURE(moment.attempts, moment.events);
            const auto until = std::span(attempts).first(moment.attempts);
            check_same(moment.known,
                       recomputed(spec, until, std::span(events).first(moment.events)), until);
            ++looked;
        }
        check_same(
            data::stored_progress(database, 1,
                                  SessionProgress(spec.protocol, spec.plan, session_stream(spec))),
            recomputed(spec, attempts, events), attempts);
    }
    CHECK(looked > 50);
    for (const EventKind kind :
         {EventKind::mark, EventKind::redo, EventKind::pause, EventKind::go_on, EventKind::fault,
          EventKind::abort, EventKind::interrupted}) {
        CAPTURE(to_string(kind));
        CHECK(kinds[kind] > 0);
    }
}

TEST_CASE("every kind of event has a word, and comes back from it") {
    std::set<std::string_view> words;
    for (std::size_t i = 0; i < kEventKinds; ++i) {
        const auto kind = static_cast<EventKind>(i);
        CHECK(event_kind(to_string(kind)) == kind);
        words.insert(to_string(kind));
    }
    CHECK(words.size() == kEventKinds);
    CHECK_THROWS_AS(event_kind("breaks"), std::invalid_argument);
}

TEST_CASE("a trial's device is the last one that was meant before it, or the session's first") {
    SEEDED(random, std::uint64_t{50});
    const TrialDevice first{.name = "first", .calibration = "0"};
    DeviceProgress device{.begun = first};
    std::vector<Event> events;
    for (int i = 0; i < 40; ++i) {
        const std::string word = std::to_string(i);
        const std::array<Event, 6> choice{
            Event{.kind = EventKind::device, .value = word},
            Event{.kind = EventKind::provenance, .key = "calibration sha256", .value = word},
            Event{.kind = EventKind::provenance, .key = "calibration", .value = word},
            Event{.kind = EventKind::reconnect, .value = word},
            Event{.kind = EventKind::note, .text = word, .value = word},
            Event{.kind = random.below(4) == 0 ? EventKind::planned_again : EventKind::rest}};
        events.push_back(choice[random.index(6)]);
        device = apply(std::move(device), events.back());
        // The law, said backwards: what the newest event said, unless all was planned again since.
        TrialDevice expected;
        for (auto event = events.rbegin(); event != events.rend(); ++event) {
            if (event->kind == EventKind::planned_again) {
                break;
            }
            if (event->kind == EventKind::device && expected.name.empty()) {
                expected.name = event->value;
            }
            if (event->key == "calibration sha256" && expected.calibration.empty()) {
                expected.calibration = event->value;
            }
        }
        REQUIRE(device.now.name == (expected.name.empty() ? first.name : expected.name));
        REQUIRE(device.now.calibration ==
                (expected.calibration.empty() ? first.calibration : expected.calibration));
        REQUIRE(device.begun.name == first.name);
    }
}

TEST_CASE("another port is the same rig, another calibration or machine is not") {
    const TrialDevice rig{.name = "Haply gen3 at /dev/ttyACM0", .calibration = "1a"};
    CHECK(same_rig(rig, {.name = "Haply gen3 at /dev/ttyACM1", .calibration = "1a"}));
    CHECK_FALSE(same_rig(rig, {.name = "Haply gen3 at /dev/ttyACM0", .calibration = "1b"}));
    CHECK_FALSE(same_rig(rig, {.name = "Haply gen2 at /dev/ttyACM0", .calibration = "1a"}));
    CHECK_FALSE(same_rig(rig, {.name = "mouse", .calibration = {}}));
}

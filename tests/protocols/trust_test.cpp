#include "tests/support/adaptive.hpp"
#include "tests/support/changing_rig.hpp"

using namespace palpate::protocols;
using engine::Trip;

namespace {

Event proof(std::string_view key) {
    return {.kind = EventKind::provenance, .key = std::string(key), .value = "found"};
}

}  // namespace

TEST_CASE("trust is no more than what was proved since the rig could last have changed") {
    // The law, said without the fold: what of place and pulses was proved after the last event that
    // could have changed it.
    SEEDED(random, std::uint64_t{300});
    RigTrust trust;
    bool answers = false;
    bool placed = false;
    bool pulsed = false;
    for (int i = 0; i < 60; ++i) {
        switch (random.below(6)) {
            case 0:
                trust = apply(trust, {.kind = EventKind::reconnect});
                answers = true;
                break;
            case 1:
                trust = apply(trust, proof(kStartPose));
                answers = placed = true;
                pulsed = false;
                break;
            case 2:
                trust = apply(trust, proof(kRigCheck));
                pulsed = pulsed || placed;
                break;
            case 3: {
                const bool away = random.coin();
                const Trip cause = away ? Trip::device_silent : Trip::jump;
                trust = apply(trust,
                              {.kind = EventKind::fault, .value = std::string(to_string(cause))});
                answers = answers && !away;
                placed = pulsed = false;
                break;
            }
            case 4:
                trust = apply(trust, {.kind = random.coin() ? EventKind::rest : EventKind::pause});
                placed = pulsed = false;
                break;
            default:
                trust = apply(trust, {.kind = EventKind::fault,
                                      .value = std::string(to_string(Trip::let_go))});
                trust = apply(trust, {.kind = EventKind::note, .text = "proved"});
        }
        REQUIRE((trust.state == Trust::proved) == (placed && pulsed));
        REQUIRE((trust.state >= Trust::at_home) == placed);
        REQUIRE((trust.state >= Trust::answers) == answers);
    }
}

TEST_CASE("each cause of a fault takes as much trust as it could have changed of the rig") {
    const RigTrust proved{.state = Trust::proved};
    int kept = 0;
    int place = 0;
    int all = 0;
    for (int i = 0; i < 64; ++i) {
        const auto cause = static_cast<Trip>(i);
        if (cause != Trip::none && to_string(cause) == "none") {
            break;
        }
        const Trust left =
            apply(proved, {.kind = EventKind::fault, .value = std::string(to_string(cause))}).state;
        kept += left == Trust::proved ? 1 : 0;
        place += left == Trust::answers ? 1 : 0;
        all += left == Trust::unknown ? 1 : 0;
        if (cause == Trip::stuck_encoder || cause == Trip::runaway || cause == Trip::over_speed) {
            CHECK((left == Trust::answers));
        }
    }
    CHECK(all == 4);  // lost, silent, stopped, garbage
    CHECK(kept == 8);
    CHECK(place >= 10);
    CHECK((apply(proved, {.kind = EventKind::fault, .value = "a new cause"}).state < proved.state));
}

TEST_CASE("no force is felt on a rig that was not proved since it could have changed") {
    const auto cause = GENERATE(Trip::device_lost, Trip::device_silent, Trip::device_stopped,
                                Trip::device_garbage, Trip::jump, Trip::runaway);
    const int wrong = GENERATE(0, 1, 3);
    const std::uint64_t seed = GENERATE(0U, 1U, 2U);
    CAPTURE(to_string(cause), wrong, seed);
    World world{.seed = seed, .fault_share = 0.3};
    ChangingRig rig(world, wrong, cause);
    Meddler observer(rig);
    FinishedRun kept(short_protocol(), rig, observer);
    REQUIRE(observer.rests.size() >= 2);
    CHECK(kept.count[EventKind::fault] > 0);
    CHECK(kept.count_of_key["rig check"] >= observer.rests.size() + kept.count[EventKind::fault]);
    for (const TroubleView& view :
         observer.troubles) {  // who may be another asks for the experimenter
        const bool away = cause != Trip::jump && cause != Trip::runaway;
        CHECK((!view.by_hand || away || view.in_a_row == 1));
    }
}

TEST_CASE(
    "a device that began anew is another one, whatever ended the force or stopped the session") {
    // Nothing but that it began anew says so: the cause lies with people, screen or machine.
    const auto cause = GENERATE(Trip::late, Trip::delayed, Trip::screen_silent, Trip::let_go,
                                Trip::overheated, Trip::focus_lost);
    const bool in_breaks = GENERATE(false, true);
    const int wrong = GENERATE(0, 2);
    CAPTURE(to_string(cause), in_breaks, wrong);
    World world{.seed = 5, .fault_share = in_breaks ? 0.0 : 0.3};
    ChangingRig rig(world, wrong, cause);
    rig.begins_anew = true;
    Meddler meddler(rig);
    Patient patient;
    Patient& observer = in_breaks ? static_cast<Patient&>(meddler) : patient;
    FinishedRun kept(short_protocol(), rig, observer);
    const std::size_t changes = in_breaks ? observer.rests.size() : kept.count[EventKind::fault];
    REQUIRE(changes >= 2);
    CHECK(kept.anew >= changes);
    CHECK((kept.count_of_key["board"] == kept.anew && kept.board == rig.identity()));
    CHECK(kept.count[EventKind::go_on] >= changes);
    for (const TroubleView& view : observer.troubles) {
        CHECK((!view.solved || view.by_hand));
    }
}

TEST_CASE("a rig that begins anew while pulses move it is looked at from its place on") {
    World world;
    class AnewInPulses : public ChangingRig {
    public:
        using ChangingRig::ChangingRig;
        [[nodiscard]] engine::ShortForm prove_motors() override {
            const engine::ShortForm form = ChangingRig::prove_motors();
            if (times_-- > 0) {  // and still the pulses were right
                change();
            }
            return form;
        }

    private:
        int times_ = 2;
    } rig(world, 0, Trip::none);
    rig.begins_anew = true;
    Patient observer;
    FinishedRun kept(short_protocol(), rig, observer);
    CHECK(kept.anew == 2);
    REQUIRE_FALSE(observer.troubles.empty());
    CHECK(observer.troubles.back().by_hand);
}

TEST_CASE("what stands against every force is said while it does, and nothing goes on meanwhile") {
    // A button is pressed before each of the first trials, held for some looks, and let go.
    const int held = GENERATE(1, 7, 40);
    CAPTURE(held);
    constexpr const char* kHeld = "the button is pressed";
    OperatorDesk desk;
    class Holder : public Patient {
    public:
        Holder(OperatorDesk& desk, int held) : desk_(&desk), held_(held) {}
        Signal gap(double seconds) override {
            if (released < 3) {
                desk_->stop("button");
                desk_->bar(kHeld);
            }
            return Patient::gap(seconds);
        }
        std::optional<Signal> trouble(const TroubleView& view) override {
            const bool barred = desk_->barred() != nullptr;
            CHECK(barred == (view.sentence == kHeld));
            CHECK(view.solved != barred);
            CHECK(view.by_hand);
            if (!barred) {
                ++released;
                looks_ = 0;
            } else if (++looks_ == held_) {
                desk_->bar(nullptr);
            }
            return Signal::go_on;  // asked for at every look
        }
        int released = 0;

    private:
        OperatorDesk* desk_;
        int held_;
        int looks_ = 0;
    } observer(desk, held);
    World world;
    FaultyApparatus apparatus(world);
    FinishedRun kept(short_protocol(), apparatus, observer, &desk);
    CHECK(observer.released == 3);
    CHECK(kept.count[EventKind::go_on] == 3);
}

TEST_CASE(
    "after a stop no pulse moves the rig before the experimenter goes on, and then before a "
    "force") {
    // It is stopped; or while a fault is mended, and of one that cost nothing the rig is changed
    // then.
    const auto cause = GENERATE(Trip::stopped, Trip::jump, Trip::focus_lost);
    const bool in_trouble = cause != Trip::stopped;
    World world{.seed = 5, .fault_share = 0.3};
    const int wrong = GENERATE(0, 2);
    ChangingRig rig(world, wrong, cause);
    rig.changes_at_faults = cause != Trip::focus_lost;
    OperatorDesk desk;
    class Stopper : public Patient {
    public:
        Stopper(ChangingRig& rig, OperatorDesk* desk) : rig_(&rig), desk_(desk) {}
        std::optional<Signal> trouble(const TroubleView& view) override {
            if (looks_++ == 0) {
                pulses_ = rig_->pulses;
                const bool stops_now = desk_ != nullptr && opened_ && stops < 3;
                stopped_ = stops_now || (desk_ == nullptr && opened_ && view.by_hand);
                if (stops_now) {
                    desk_->stop("Escape");
                    rig_->change();
                }
            }
            CHECK((!stopped_ || rig_->pulses == pulses_));
            if (!view.solved || looks_ < 30) {  // three tries
                return std::nullopt;
            }
            CHECK((!stopped_ || view.by_hand));
            stops += stopped_ ? 1 : 0;
            opened_ = true;
            looks_ = 0;
            return Signal::go_on;
        }
        int stops = 0;

    private:
        ChangingRig* rig_;
        OperatorDesk* desk_;
        bool opened_ = false;
        bool stopped_ = false;
        int looks_ = 0;
        int pulses_ = 0;
    } observer(rig, in_trouble ? &desk : nullptr);
    FinishedRun kept(short_protocol(), rig, observer, &desk);
    CHECK(observer.stops >= 2);
}

TEST_CASE("a long trouble is a break: the rig is proved once it is over") {
    const auto seconds = GENERATE(0.0, 9.0, 11.0, 600.0);
    const RigTrust left =
        apply(RigTrust{.state = Trust::proved}, {.kind = EventKind::go_on, .duration_s = seconds});
    CHECK((left.state == Trust::proved) == (seconds < 10.0));
}

TEST_CASE("a trip in the ramp out of the first interval lets no second one be felt") {
    const Protocol protocol = adaptive_protocol();
    World world;
    class InRamp : public ChangingRig {
    public:
        using ChangingRig::ChangingRig;
        void begin(const engine::SceneView& scene,
                   std::size_t position,
                   std::size_t interval) override {
            CHECK((interval == 1 || !tripped));
            trips_in_ramp = tripped = interval == 1 && trips-- > 0;
            ChangingRig::begin(scene, position, interval);
        }
        void end() override {
            ChangingRig::end();
            if (tripped) {
                change();
            }
        }
        [[nodiscard]] Trip trip() const override {
            return tripped ? Trip::jump : ChangingRig::trip();
        }
        int trips = 3;
        bool tripped = false;
    } rig(world, 0, Trip::none);
    Patient observer;
    FinishedRun kept(protocol, rig, observer);
    CHECK(rig.trips < 0);
    CHECK(kept.count[EventKind::fault] == 3);
}

TEST_CASE(
    "a device that goes while somebody is at the start is lost there, and proved before a force") {
    const std::uint64_t seed = GENERATE(seeds(12U));
    CAPTURE(seed);
    const Protocol protocol = adaptive_protocol();  // of two intervals
    World world;
    /// Nobody's torque reaches a device that is gone: an interval that begins there ends at once.
    class Leaves : public ChangingRig {
    public:
        using ChangingRig::ChangingRig;
        void stop(Trip cause) noexcept override { stopped = cause; }
        void begin(const engine::SceneView& scene,
                   std::size_t position,
                   std::size_t interval) override {
            left = gone;
            if (!gone) {
                ChangingRig::begin(scene, position, interval);
            }
        }
        engine::ServoStatus advance() override {
            if (left) {
                change();
                gone = false;
                return engine::ServoStatus::faulted;
            }
            return ChangingRig::advance();
        }
        [[nodiscard]] Trip trip() const override {
            return left ? std::exchange(stopped, Trip::none) : ChangingRig::trip();
        }
        mutable Trip stopped = Trip::none;
        bool gone = false;
        bool left = false;
    } rig(world, 0, Trip::none);
    /// At some starts the device leaves.
    class Waits : public Patient {
    public:
        Waits(Leaves& rig, std::uint64_t seed) : rig_(&rig), random_(seed) {}
        Signal ready(const TrialView& trial) override {
            if (random_.in(0.0, 1.0) < 0.2) {
                rig_->gone = trial.interval > 1;
                ++(trial.interval > 1 ? later : first);
                if (trial.interval == 1) {
                    rig_->change();
                }
                return Signal::no_place;
            }
            return Patient::ready(trial);
        }
        std::size_t first = 0;
        std::size_t later = 0;

    private:
        Leaves* rig_;
        Random random_;
    } observer(rig, seed);
    FinishedRun kept(protocol, rig, observer);
    REQUIRE(observer.first + observer.later > 0);
    CHECK(kept.count[EventKind::fault] == observer.first + observer.later);
    CHECK(kept.causes[std::string(to_string(Trip::device_silent))] == kept.count[EventKind::fault]);
}

TEST_CASE("a protocol without breaks has its rig proved anew after thirty attempts") {
    Protocol protocol = short_protocol();
    protocol.design.break_every = 0;
    protocol.design.repetitions = 12;
    World world;
    ChangingRig rig(world, 0, Trip::none);
    Patient observer;
    const Plan plan = plan_of(protocol);
    REQUIRE(plan.trials.size() > 2 * kMaxTrialsOfAProof);
    FinishedRun kept(protocol, rig, observer);
    const std::size_t expected = (plan.trials.size() - 1) / kMaxTrialsOfAProof;
    CHECK(observer.rests.size() >= expected);
    CHECK(kept.count_of_key["rig check"] >= expected + 1);
}

TEST_CASE("pulses that are refused are kept with the attempts begun since they were right") {
    const bool at_faults = GENERATE(false, true);  // or in breaks
    World world{.seed = 3, .fault_share = at_faults ? 0.3 : 0.0};
    ChangingRig rig(world, 1, Trip::device_lost);  // first its place is refused, then its pulses
    Doubts kept(rig);
    Protocol protocol = short_protocol();
    protocol.design.break_every = 3;
    Meddler meddler(rig);
    Patient patient;
    run_on(protocol, rig, at_faults ? patient : meddler, kept);
    CHECK(std::ranges::count_if(kept.counts, [](std::size_t n) { return n > 0; }) >= 2);
}

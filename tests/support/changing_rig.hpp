#pragma once

#include "protocols/session/trust.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/faulty.hpp"

/// A rig that changes while it is not looked at, and what a session keeps of it.
namespace palpate::tests {

using namespace protocols;
using engine::Trip;

/// Keeps the kinds of events, and what trust they leave: written by hand beside the fold.
class Kinds : public protocols::Recorder {
public:
    TrialId begin_trial(const PlannedTrial& /*planned*/) override { return ++trial_; }
    void event(const Event& event) override {
        ++count[event.kind];
        count_of_key[event.key] += event.value.starts_with(kRefused) ? 0U : 1U;
        causes[event.value] += event.kind == EventKind::fault ? 1U : 0U;
        anew += event.value == kAnew ? 1U : 0U;
        board = event.key == kBoard ? event.value : board;
    }

    std::map<EventKind, std::size_t> count;
    std::map<std::string, std::size_t> count_of_key;
    std::map<std::string, std::size_t> causes;  ///< of faults
    std::size_t anew = 0;                       ///< reconnections of a device that began anew
    std::string board{};                        ///< the last that was said to be another one

private:
    TrialId trial_ = 0;
};

/// A rig with the truth beside what is believed: it changes at faults and in breaks, and is proved
/// by steps that fail for the first tries after each change. No force may be felt on one that was
/// not looked at since.
class ChangingRig : public FaultyApparatus {
public:
    ChangingRig(World& world, int wrong, Trip cause)
        : FaultyApparatus(world), wrong_(wrong), cause_(cause) {}

    void begin(const engine::SceneView& scene,
               std::size_t position,
               std::size_t interval) override {
        CHECK(placed);
        CHECK(placed_again);
        CHECK(pulsed);
        CHECK(plugs_known);
        CHECK(since++ < kMaxTrialsOfAProof);
        FaultyApparatus::begin(scene, position, interval);
    }
    engine::ServoStatus advance() override {
        const auto status = FaultyApparatus::advance();
        if (status == engine::ServoStatus::faulted && changes_at_faults) {
            change();
            const bool away = trip() == Trip::device_lost || trip() == Trip::device_silent ||
                              trip() == Trip::device_stopped || trip() == Trip::device_garbage;
            plugs_known = plugs_known && !away;
        }
        return status;
    }
    [[nodiscard]] Trip trip() const override {
        return FaultyApparatus::trip() == Trip::over_speed ? cause_ : FaultyApparatus::trip();
    }
    [[nodiscard]] bool has_proof() const noexcept override { return true; }
    [[nodiscard]] std::string identity() const override { return fmt::format("id {}", board_); }
    [[nodiscard]] bool began_anew() override { return std::exchange(anew_, false); }
    [[nodiscard]] engine::ShortForm prove_place() override {
        CHECK_FALSE(force_on);
        const auto form = step(places_left_, placed, "the handle is elsewhere");
        plugs_known = plugs_known || (placed && std::exchange(asks_mark_, false));
        placed_again = placed_again || placed;
        return form;
    }
    void doubt_plugs() override { asks_mark_ = true; }
    [[nodiscard]] engine::ShortForm prove_motors() override {
        CHECK_FALSE(force_on);
        CHECK(placed);  // a force at a wrong place proves nothing
        ++pulses;
        const auto form = step(pulses_left_, pulsed, "a motor is too strong");
        since = pulsed ? 0 : since;
        placed_again = placed_again && pulsed;  // who mends a motor may move an encoder
        return form;
    }
    void change() {
        placed = pulsed = false;
        anew_ = begins_anew;
        board_ += begins_anew ? 1 : 0;
        places_left_ = pulses_left_ = wrong_;
    }

    bool begins_anew = false;  ///< at each change
    bool changes_at_faults = true;
    int pulses = 0;
    bool placed = false;
    bool placed_again = true;  ///< since pulses were refused
    bool pulsed = false;
    bool plugs_known = true;  ///< none was away since the second mark was met
    std::size_t since = 0;    ///< trials since pulses were right

private:
    static engine::ShortForm step(int& left, bool& right, const char* why) {
        right = left == 0;
        left -= left > 0 ? 1 : 0;
        return right ? engine::ShortForm{.refused = {}, .found = "as it should be"}
                     : engine::ShortForm{.refused = why, .found = {}};
    }
    bool anew_ = false;
    int board_ = 0;
    bool asks_mark_ = false;
    int wrong_;
    Trip cause_;
    int places_left_ = 0;
    int pulses_left_ = 0;
};

/// What a session keeps of refused proofs: each counts the trials since pulses were right.
class Doubts : public Kinds {
public:
    explicit Doubts(const ChangingRig& rig) : rig_(&rig) {}
    void event(const Event& event) override {
        Kinds::event(event);
        if (event.value.starts_with(kRefused)) {
            CHECK(event.count == static_cast<std::int64_t>(rig_->since));
            counts.push_back(rig_->since);
        }
    }
    std::vector<std::size_t> counts;

private:
    const ChangingRig* rig_;
};

/// Somebody in whose breaks the rig changes.
class Meddler : public Patient {
public:
    explicit Meddler(ChangingRig& rig) : rig_(&rig) {}
    Signal rest(double seconds, const TrialView& next) override {
        rig_->change();
        return Patient::rest(seconds, next);
    }

private:
    ChangingRig* rig_;
};

inline SessionEnd run_on(const Protocol& protocol,
                         Apparatus& rig,
                         Patient& observer,
                         Kinds& kept,
                         OperatorDesk* desk = nullptr) {
    const Plan plan = plan_of(protocol);
    return run_session(protocol, plan, {}, SessionProgress(protocol, plan, {}),
                       {.apparatus = rig,
                        .observer = observer,
                        .recorder = kept,
                        .pause = [](double) {},
                        .desk = desk});
}

/// What is kept of a session that must finish.
struct FinishedRun : Kinds {
    FinishedRun(const Protocol& protocol,
                Apparatus& rig,
                Patient& observer,
                OperatorDesk* desk = nullptr) {
        const SessionEnd end = run_on(protocol, rig, observer, *this, desk);
        CHECK((end.why == SessionEnd::Why::finished));
    }
};

}  // namespace palpate::tests

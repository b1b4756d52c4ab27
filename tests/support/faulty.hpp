#pragma once

#include "protocols/design/session_plan.hpp"
#include "protocols/file/protocol_file.hpp"
#include "protocols/session/session.hpp"
#include "tests/support/studies.hpp"

/// A device that fails by a plan, somebody who answers, and a program that is killed.
namespace palpate::tests {

/// The program ends here, without a word.
struct Killed {};

/// What happens to a participant, whatever program runs: it lives on when a program is killed.
struct World {
    std::uint64_t seed = 0;
    double fault_share = 0.0;
    std::size_t max_faults = 3;                   ///< of one position
    std::map<std::size_t, std::size_t> faults{};  ///< had so far, by position
    std::size_t away = 0;                         ///< reconnects that fail after each fault
    std::size_t asked = 0;                        ///< reconnects in all

    [[nodiscard]] bool faults_now(std::size_t position) {
        const std::size_t before = faults[position];
        Random random(seed * 1000003 + position * 101 + before);
        return before < max_faults && random.in(0.0, 1.0) < fault_share;
    }
};

class FaultyApparatus : public protocols::Apparatus {
public:
    explicit FaultyApparatus(World& world) : world_(world) {}

    void begin(const engine::SceneView& /*scene*/,
               std::size_t position,
               std::size_t /*interval*/) override {
        position_ = position;
        faults_ = world_.faults_now(position_);
        trip_ = engine::Trip::none;
        last_.clear();
        time_ms_ = 0;
        force_on = true;
        ring_.clear();
    }
    engine::ServoStatus advance() override {
        for (int i = 0; i < 10; ++i) {
            push(false);
        }
        if (faults_ && time_ms_ >= fault_after_ms) {
            trip(engine::Trip::over_speed);
            ++world_.faults[position_];
            away_ = world_.away;
            lost_ = away_ > 0;
            return engine::ServoStatus::faulted;
        }
        if (hidden_trip_ms > 0 && time_ms_ >= hidden_trip_ms) {  // the next advance() would tell
            trip(engine::Trip::energy);
        }
        return engine::ServoStatus::running;
    }
    void end() override {
        if (trip_ == engine::Trip::none) {  // as the servos: nothing moves after a trip
            push(false);
        }
        if (trips_in_ramp) {
            trip(ramp_trip);
        }
        force_on = false;
    }
    [[nodiscard]] engine::TickRing& ring() noexcept override { return ring_; }
    [[nodiscard]] double elapsed_s() const noexcept override { return 1e-3 * time_ms_; }
    [[nodiscard]] std::int64_t dropped() const noexcept override { return 0; }
    [[nodiscard]] std::string device_name() const override { return "faulty"; }
    [[nodiscard]] engine::Trip trip() const override { return trip_; }
    [[nodiscard]] std::vector<engine::TickRecord> last_ticks() const override { return last_; }
    [[nodiscard]] bool reconnect() override {
        ++world_.asked;
        if (away_ == 0) {
            lost_ = false;
            return true;
        }
        --away_;
        return false;
    }
    [[nodiscard]] std::string trouble() const override {
        return !lost_               ? ""
             : away_ == world_.away ? "the cable is out: put it in"
                                    : "the cable is still out: put it in";
    }

    bool force_on = false;
    int fault_after_ms = 150;
    int hidden_trip_ms = 0;      ///< a trip that advance() did not see any more, 0: none
    bool trips_in_ramp = false;  ///< when it no longer matters
    engine::Trip ramp_trip = engine::Trip::late;

private:
    void push(bool fault) {
        engine::TickRecord tick;
        tick.tick = time_ms_;
        tick.time_ns = std::int64_t{time_ms_} * 1'000'000;
        tick.hip = {0.001 * time_ms_, 0.06, 0.0};
        tick.flags = fault ? engine::tick_fault : engine::tick_force_slew | engine::tick_stale;
        ++time_ms_;
        ring_.push(tick);
        last_.push_back(tick);
        if (last_.size() > 100) {
            last_.erase(last_.begin());
        }
    }
    void trip(engine::Trip cause) {
        trip_ = cause;
        push(true);
    }

    World& world_;
    engine::TickRing ring_{1024};
    std::vector<engine::TickRecord> last_;
    engine::Trip trip_ = engine::Trip::none;
    std::size_t position_ = 0;
    std::size_t away_ = 0;
    bool lost_ = false;
    int time_ms_ = 0;
    bool faults_ = false;
};

/// Explores for 0.3 s, answers with the first picture, and waits for the experimenter for ever.
class Patient : public protocols::Observer {
public:
    protocols::Signal welcome(const protocols::SessionView& /*session*/) override {
        return protocols::Signal::go_on;
    }
    protocols::Signal ready(const protocols::TrialView& trial) override {
        constexpr std::size_t kPractice = 6;
        numbers.push_back(trial.practice ? trial.number : trial.number + kPractice);
        in_range = in_range && trial.number >= 1 && trial.number <= trial.total;
        return protocols::Signal::go_on;
    }
    protocols::ExplorationStep explore(const protocols::TrialView& /*trial*/,
                                       double elapsed_s) override {
        return {.signal = elapsed_s >= 0.3 ? protocols::Signal::done : protocols::Signal::go_on,
                .at_s = elapsed_s};
    }
    protocols::Choice choose(const protocols::TrialView& /*trial*/,
                             const protocols::Question& /*question*/) override {
        return {};
    }
    protocols::Signal gap(double /*seconds*/) override { return protocols::Signal::go_on; }
    protocols::Signal rest(double /*seconds*/, const protocols::TrialView& next) override {
        rests.push_back(next.number);
        return protocols::Signal::go_on;
    }
    std::optional<protocols::Signal> trouble(const protocols::TroubleView& view) override {
        troubles.push_back(view);
        return view.solved ? std::optional(protocols::Signal::go_on) : std::nullopt;
    }
    void finish(const protocols::SessionView& /*session*/) override {}

    std::vector<std::size_t>
        numbers;           ///< of the trials as shown, those after practice going on with it
    bool in_range = true;  ///< of all of them: 1 to their total
    std::vector<std::size_t> rests;  ///< number of the trial after each break
    std::vector<protocols::TroubleView> troubles;
};

/// The default study's phases in small: practice, catch trials and breaks.
inline protocols::Protocol short_protocol() {
    protocols::Protocol protocol = small_protocol(2);
    protocol.objects.push_back({"catch", 15.0, false});
    protocol.design.practice_repetitions = 1;
    protocol.design.catch_trials = 2;
    protocol.design.break_every = 5;
    protocol.timing.explore_min = 0.0;
    protocol.invalid = {.late_share = 1.0, .contact_min = 0.0, .path_min = 0.0};
    return protocol;
}

inline protocols::Plan plan_of(const protocols::Protocol& protocol) {
    return protocols::make_plan(protocol, protocols::protocol_hash(protocol), {"P01", 1},
                                protocol.seed);
}

}  // namespace palpate::tests

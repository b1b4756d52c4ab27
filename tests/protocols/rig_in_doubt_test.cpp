#include "protocols/trial/servo_apparatus.hpp"
#include "tests/support/changing_rig.hpp"

// What takes a rig away from its session while nothing is felt: a handle that jumps, and another
// device where the session's was.

using namespace palpate::protocols;
using engine::Trip;

TEST_CASE(
    "a handle that jumps while nothing is felt is a fault before the next trial, and proved") {
    // At a question, in a break or at Ready: whoever asks last.
    class Jumping : public ChangingRig {
    public:
        using ChangingRig::ChangingRig;
        [[nodiscard]] Trip moved() const override { return moved_; }
        void forget_move() override { moved_ = Trip::none; }
        void jump(Trip cause) {
            moved_ = cause;
            change();
            ++jumps;
        }
        std::size_t jumps = 0;

    private:
        Trip moved_ = Trip::none;
    };
    class Bystander : public Patient {
    public:
        Bystander(Jumping& rig, int where, Trip cause) : rig_(rig), where_(where), cause_(cause) {}
        Signal ready(const TrialView& trial) override { return jumps(0, Patient::ready(trial)); }
        Choice choose(const TrialView& trial, const Question& question) override {
            static_cast<void>(jumps(1, Signal::go_on));
            return Patient::choose(trial, question);
        }
        Signal rest(double seconds, const TrialView& next) override {
            return jumps(2, Patient::rest(seconds, next));
        }

    private:
        Signal jumps(int where, Signal signal) {
            if (where == where_ && ++calls_ % 3 == 1) {
                rig_.jump(cause_);
            }
            return signal;
        }
        Jumping& rig_;
        int where_;
        Trip cause_;
        int calls_ = 0;
    };
    const int where = GENERATE(0, 1, 2);
    const Trip cause = GENERATE(Trip::jump, Trip::over_speed);
    CAPTURE(where, to_string(cause));
    World world;
    Jumping rig(world, 1, Trip::late);
    Bystander observer(rig, where, cause);
    FinishedRun kept(short_protocol(), rig, observer);
    REQUIRE(rig.jumps >= 1);
    CHECK(kept.causes[std::string(to_string(cause))] == rig.jumps);
    CHECK(kept.count_of_key["rig check"] >= rig.jumps);  // begin() looks that it was before force
}

TEST_CASE("whether it is the session's device is asked wherever one began anew or went away") {
    class Replugged : public engine::Device {
    public:
        explicit Replugged(std::size_t& times) : times_(times) {}
        engine::Reading read() noexcept override { return {}; }
        engine::AppliedForce write(const engine::Vec3& /*force*/) noexcept override { return {}; }
        [[nodiscard]] std::string name() const override { return "replugged"; }
        [[nodiscard]] std::size_t homings() const noexcept override { return times_; }

    private:
        std::size_t& times_;
    };
    std::size_t plugged = 0;
    std::size_t asked = 0;
    std::string why;
    DeviceApparatus rig(short_protocol(), std::make_unique<Replugged>(plugged));
    rig.ask_by([&] {
        ++asked;
        return why;
    });
    CHECK(rig.reconnect());
    CHECK(asked == 0);  // it is the one that was opened
    ++plugged;
    CHECK(rig.reconnect());
    CHECK(rig.reconnect());
    CHECK(asked == 1);
    rig.doubt_plugs();  // it was silent
    why = "another one";
    for (int tries = 0; tries < 3; ++tries) {
        const ProofStep step = prove_step(rig, Trust::unknown);
        CHECK_FALSE(step.event);
        CHECK(step.refused == "another one");
    }
    CHECK(asked == 4);
    why.clear();
    CHECK(prove_step(rig, Trust::unknown).event);
    CHECK(rig.trouble().empty());
}

TEST_CASE("a device that goes away while a trouble waits to be left is waited for again",
          "[session][trust][fault][law]") {
    World world;
    world.fault_share = 1.0;
    world.max_faults = 1;
    class Unplugged : public ChangingRig {
    public:
        using ChangingRig::ChangingRig;
        [[nodiscard]] bool reconnect() override {
            ++asked;
            out = out && asked < 3;  // somebody puts it in again
            return !out && ChangingRig::reconnect();
        }
        [[nodiscard]] std::string trouble() const override { return out ? "the cable is out" : ""; }
        [[nodiscard]] std::optional<engine::Vec3> place() override {
            return out ? engine::Vec3(std::numeric_limits<double>::infinity()) : engine::Vec3(0.0);
        }
        [[nodiscard]] Trip place_fault() const override { return Trip::device_lost; }
        bool out = false;
        int asked = 0;
    } rig(world, 0, Trip::over_speed);
    class Slow : public Patient {  // lets the cable be pulled before going on for the first time
    public:
        explicit Slow(Unplugged& pulled) : rig_(&pulled) {}
        std::optional<Signal> trouble(const TroubleView& view) override {
            troubles.push_back(view);
            if (troubles.size() > 1000) {
                return Signal::abort;
            }
            if (view.solved && !pulled_) {
                pulled_ = rig_->out = true;
                rig_->asked = 0;
            }
            const bool again = !rig_->out && rig_->asked > 0;
            return view.solved && again ? std::optional(Signal::go_on) : std::nullopt;
        }

    private:
        Unplugged* rig_;
        bool pulled_ = false;
    } observer(rig);
    FinishedRun kept(short_protocol(), rig, observer);
    CHECK(std::ranges::any_of(observer.troubles, [](const TroubleView& view) {
        return !view.solved && view.sentence == "the cable is out";
    }));
    CHECK(kept.causes["device_lost"] > 0);
}

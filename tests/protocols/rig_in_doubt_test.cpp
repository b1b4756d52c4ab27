#include "tests/support/changing_rig.hpp"

// What takes a rig away from its session while nothing is felt: a handle that jumps.

using namespace palpate::protocols;
using engine::Trip;

TEST_CASE("a handle that jumps while nothing is felt is a fault before the next trial, and proved",
          "[session][trust][fault][law]") {
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
    Kinds kept;
    const SessionEnd end = run_on(short_protocol(), rig, observer, kept);
    CHECK((end.why == SessionEnd::Why::finished));
    REQUIRE(rig.jumps >= 1);
    CHECK(kept.causes[std::string(to_string(cause))] == rig.jumps);
    CHECK(kept.count_of_key["rig check"] >= rig.jumps);  // begin() looks that it was before force
}

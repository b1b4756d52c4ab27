#include "tests/support/catch.hpp"
#include "tests/support/daq_bench.hpp"
#include "tests/support/miswired_machine.hpp"

using namespace palpate::engine;

namespace {

/// A free handle whose encoders and motors hang on a card's counters and outputs, on a virtual
/// clock.
class RigOnCard {
public:
    RigOnCard(const Connection& encoders, const Connection& motors)
        : handle(how, encoders, motors), home_{handle.angle(0), handle.angle(1)} {
        count();
    }

    void bring(const Vec2& place) {
        handle.bring(place);
        count();
    }
    /// A millisecond with what stands at the outputs.
    void pass() {
        Vec3 asked{};
        for (std::size_t i = 0; i < 2; ++i) {
            asked[static_cast<int>(i)] = volts_of(bench, i) / how.comedi->volts_per_newton_metre[i];
        }
        handle.set_torque(asked);
        handle.advance(1e-3);
        count();
    }

    Calibration how = daq_calibration();
    DaqBench bench;
    MiswiredHandle handle;

private:
    void count() {
        for (std::size_t i = 0; i < 2; ++i) {
            const double turned =
                (handle.angle(i) - home_[i]) / how.pantograph.axes[i].count_angle();
            const auto counts = static_cast<std::int64_t>(std::floor(turned + 0.5));
            bench.counter[i] = static_cast<std::uint32_t>(
                static_cast<std::uint64_t>(how.comedi->counter_clockwise[i] ? -counts : counts) &
                bench.counter_top);
        }
    }

    JointAngles home_;
};

CommissioningResult commissioned_on_card(RigOnCard& rig) {
    static const std::vector<Vec3> places = places_to_commission(rig.how, *rig.how.home);
    const auto device = plug(rig.bench, rig.how);
    return commission(
        *device, rig.how, places, Vec3(PlantModel{}.handle_mass),
        attended([&](const Vec3& place) { rig.bring(Vec2(place)); }, [&] { rig.pass(); }));
}

}  // namespace

TEST_CASE("a rig on a card is commissioned, and every miswiring of it is found and named") {
    for (const Connection& wrong : all_connections()) {
        if (std::fabs(wrong.factor[0]) != 1.0 || std::fabs(wrong.factor[1]) != 1.0) {
            continue;  // how strong a motor is no wire tells: commissioning_test.cpp
        }
        CAPTURE(wrong.swapped, wrong.factor[0], wrong.factor[1]);
        RigOnCard encoders(wrong, {.swapped = true, .factor = {-2.0, 0.5}});
        if (!(wrong == Connection{})) {
            CHECK_THAT(commissioned_on_card(encoders).refused, Has("encoder"));
            CHECK(encoders.handle.asked < 1e-4);  // half a code
        }
        RigOnCard motors({}, wrong);
        const CommissioningResult done = commissioned_on_card(motors);
        CAPTURE(done.refused);
        CHECK(at_zero(motors.bench));
        if (wrong == Connection{}) {
            CHECK(done.refused.empty());
            CHECK(done.record.dynamics.handle_mass ==
                  Approx(PlantModel{}.handle_mass).epsilon(0.1));
            CHECK(done.record.round_trip == 0.0);
            continue;
        }
        CHECK(misnamed(done.refused, wrong) == "");
        CHECK_FALSE(done.refused.empty());
    }
}

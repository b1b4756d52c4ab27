#include "engine/device/simulated_pantograph.hpp"
#include "engine/realtime/servo.hpp"
#include "engine/rendering/scene.hpp"
#include "stimuli/two_curve.hpp"
#include "protocols/trial/servo_apparatus.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

namespace {

/// The simulated hand on a device whose readings fail, go stale or are no numbers.
class Unsteady : public Device {
public:
    Unsteady(std::uint64_t seed, double stale_share, int breaks_at)
        : random_(seed), stale_share_(stale_share), breaks_at_(breaks_at) {
        constexpr std::array kFaults{DeviceFault::lost,        DeviceFault::silent,
                                     DeviceFault::garbage,     DeviceFault::ended,
                                     DeviceFault::unreachable, DeviceFault::unguarded,
                                     DeviceFault::none};
        fault_ = kFaults[random_.index(7)];
    }

    void begin(const Exploration& plan) {
        plant_.begin(plan);
        reads_ = 0;
    }
    Reading read() noexcept override {
        Reading reading = plant_.read();
        if (reads_ > 0 && random_.in(0.0, 1.0) < stale_share_) {
            reading = last_;
            reading.fresh = false;
        }
        last_ = reading;
        if (reads_++ == breaks_at_) {
            reading.fault = fault_;
            reading.hip = bad();
        }
        good = reading.ok() && std::isfinite(reading.hip.x) ? reading.hip : good;
        return reading;
    }
    AppliedForce write(const Vec3& force) noexcept override { return plant_.write(force); }
    [[nodiscard]] std::string name() const override { return "unsteady"; }
    [[nodiscard]] DeviceTraits traits() const noexcept override { return plant_.traits(); }

    Vec3 good{};  ///< the last HIP that may be used

private:
    /// What a broken device may leave in hip.
    Vec3 bad() noexcept {
        const int kind = fault_ == DeviceFault::none ? 0 : random_.below(3);
        return kind == 0 ? Vec3{std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0}
             : kind == 1 ? Vec3{1e300, -1e300, 0.0}
                         : Vec3{0.0, 0.03, 0.0};
    }

    Random random_;
    SimulatedPantograph plant_{{}, 1e-3};
    double stale_share_;
    int breaks_at_;
    DeviceFault fault_ = DeviceFault::none;
    int reads_ = 0;
    Reading last_{};
};

std::vector<TickRecord> ticks_of(Servo& servo) {
    std::vector<TickRecord> all;
    std::array<TickRecord, 128> buffer;
    while (const std::size_t n = servo.ring().pop(buffer)) {
        all.insert(all.end(), buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(n));
    }
    return all;
}

bool same(const Vec2& a, const Vec2& b) {
    return std::memcmp(&a, &b, sizeof a) == 0;
}

}  // namespace

TEST_CASE("whatever fails, every recorded force comes back to the bit from the recorded HIP",
          "[safety]") {
    int tripped = 0;
    int stale = 0;
    int pressed = 0;
    for (std::uint64_t seed = 0; seed < 400; ++seed) {
        CAPTURE(seed);
        Random random(seed);
        protocols::Protocol protocol;
        if (random.coin()) {
            protocol.safety.speed_limit = random.in(0.02, 0.2);  // some hands are too fast
        }
        const int breaks_at = random.below(1500);
        Unsteady device(seed, random.coin() ? random.in(0.0, 0.7) : 0.0, breaks_at);
        VirtualServo servo(device, protocols::servo_spec(protocol, device));
        const Scene felt(stimuli::make_outline({.curvature = random.in(-10.0, 10.0)}),
                         {.stiffness = 1000.0,
                          .friction = {.mu_s = 0.7, .mu_d = 0.5, .tau_slip = 0.02, .tau_heal = 0.1},
                          .slew = {.speed = 0.2, .radius = 0.003}});
        const int stop_at = random.below(4) == 0 ? random.below(100) : 1000;
        for (int trial = 0; trial < 2; ++trial) {
            device.begin({.start = Vec2{-0.02, 0.026}, .speed = random.in(0.05, 0.2)});
            servo.allow();
            servo.begin(felt);
            for (int slice = 0; servo.advance() == ServoStatus::running && slice < 150; ++slice) {
                if (slice == stop_at) {
                    servo.stop();
                }
            }
            servo.end();
            ContactState state;
            const std::vector<TickRecord> all = ticks_of(servo);
            REQUIRE_FALSE(all.empty());
            for (const TickRecord& tick : all) {
                REQUIRE(std::isfinite(tick.hip.x + tick.hip.y));
                const Contact again = felt.tick(state, Vec2(tick.hip));
                REQUIRE(same(again.force, Vec2(tick.force)));
                REQUIRE(same(again.go, Vec2(tick.go)));
                REQUIRE(again.mode == tick.mode);
                const bool fault = (tick.flags & tick_fault) != 0;
                REQUIRE(fault == (&tick == &all.back() && servo.trip() != Trip::none));
                REQUIRE((!fault || tick.command == Vec3{}));
                stale += (tick.flags & tick_stale) != 0 ? 1 : 0;
                pressed += tick.mode != Mode::free ? 1 : 0;
            }
            CHECK(all.back().hip == device.good);  // a faulted tick has the last good HIP
            if (servo.trip() != Trip::none) {
                ++tripped;
                const auto flight = servo.last_ticks();
                CHECK(flight.size() == std::min<std::size_t>(all.size(), 100));
                CHECK((flight.back().tick == all.back().tick));
            }
        }
    }
    CHECK(tripped > 400);
    CHECK(stale > 10'000);
    CHECK(pressed > 10'000);
}

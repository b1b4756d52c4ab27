#include "engine/realtime/thread_servo.hpp"
#include "engine/rendering/scene.hpp"
#include "stimuli/two_curve.hpp"
#include "tests/support/allocations.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/child.hpp"

using namespace palpate::engine;

namespace {

/// What a test asks of a real-time servo: no rights, so that it runs alike for everybody.
ServoSpec modest(double ramp_s = 0.005) {
    return {.limits = {.ramp_step = ramp_step(ramp_s, 1e-3)}, .realtime = RealtimeWish::nothing()};
}

Scene scene(double curvature, double stiffness = 1000.0) {
    return {stimuli::make_outline({.curvature = curvature}),
            {.stiffness = stiffness,
             .friction = {.mu_s = 0.7, .mu_d = 0.5, .tau_slip = 0.02, .tau_heal = 0.1},
             .slew = {.speed = 0.2, .radius = 0.003}}};
}

/// A hand that goes to and fro inside the object, and counts who touches the device.
class Stroking : public Device {
public:
    Reading read() noexcept override {
        const std::int64_t k = reads_.fetch_add(1);
        const double share = static_cast<double>(k % 200) / 200.0;
        const double along = k / 200 % 2 == 0 ? share : 1.0 - share;
        Reading reading{.hip = {-0.025 + 0.01 * along, 0.010 + 0.01 * along, 0.0}};
        if (fails_after_ >= 0 && k >= fails_after_) {
            reading.fault = fault_;
        }
        return reading;
    }
    AppliedForce write(const Vec3& force) noexcept override {
        writes_.fetch_add(1);
        forces_.fetch_add(force == Vec3{} ? 0 : 1);
        zero_.store(force == Vec3{});
        return {};
    }
    std::string name() const override { return "stroking"; }

    [[nodiscard]] std::int64_t touches() const { return reads_.load() + writes_.load(); }
    [[nodiscard]] bool zero_was_last() const { return zero_.load(); }
    [[nodiscard]] std::int64_t forces() const { return forces_.load(); }
    /// From that read on; only while the servo is parked.
    void fail_after(std::int64_t reads, DeviceFault fault) {
        fails_after_ = reads;
        fault_ = fault;
    }

private:
    std::atomic<std::int64_t> reads_{0};
    std::atomic<std::int64_t> writes_{0};
    std::atomic<std::int64_t> forces_{0};
    std::atomic<bool> zero_{true};
    std::int64_t fails_after_ = -1;
    DeviceFault fault_ = DeviceFault::lost;
};

void nap(int milliseconds) {
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
}

/// Lets a trial run until it has so many ticks, then ends it; gives all of them.
std::vector<TickRecord> run_trial(ThreadServo& servo, const Scene& felt, std::size_t ticks) {
    servo.begin(felt);
    std::vector<TickRecord> all;
    std::array<TickRecord, 64> buffer;
    const auto take = [&] {
        while (const std::size_t n = servo.ring().pop(buffer)) {
            all.insert(all.end(), buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(n));
        }
    };
    while (all.size() < ticks && servo.advance() == ServoStatus::running) {
        nap(1);
        take();
    }
    servo.end();
    take();
    return all;
}

}  // namespace

TEST_CASE("trials on one thread: ticks without a gap, true time, force out and zero written last") {
    Stroking device;
    ThreadServo servo(device, modest());
    const Scene felt = scene(5.0);
    for (int trial = 0; trial < 5; ++trial) {
        CAPTURE(trial);
        const std::vector<TickRecord> all = run_trial(servo, felt, 30);
        REQUIRE(all.size() >= 30);
        std::int64_t last_deadline = -1'000'000;
        for (std::size_t i = 0; i < all.size(); ++i) {
            REQUIRE(all[i].tick == static_cast<std::int64_t>(i));
            // Time less lateness is a deadline: a point of the grid, later than the last one.
            const auto late = static_cast<double>(all[i].lateness_us) * 1e3;
            const double deadline = static_cast<double>(all[i].time_ns) - late;
            const double nearest = std::floor(deadline / 1e6 + 0.5) * 1e6;
            REQUIRE(std::fabs(deadline - nearest) <= 1.0 + 1e-6 * late);
            REQUIRE(static_cast<std::int64_t>(nearest) > last_deadline);
            last_deadline = static_cast<std::int64_t>(nearest);
        }
        CHECK(static_cast<double>(all.front().time_ns) <
              static_cast<double>(all.front().lateness_us) * 1e3 + 1000.0);
        CHECK(glm::length(all.back().command) < 1e-12);
        CHECK(device.zero_was_last());
        CHECK(servo.trip() == Trip::none);
    }
    CHECK(device.forces() > 0);
    CHECK(servo.dropped() == 0);
}

TEST_CASE(
    "a trial never mixes two scenes: its own scene gives all its forces from a fresh contact") {
    Stroking device;
    ThreadServo servo(device, modest());
    const std::array<Scene, 3> scenes{scene(5.0), scene(-5.0, 700.0), scene(0.0, 400.0)};
    std::mt19937 random(11);
    for (std::size_t trial = 0; trial < 12; ++trial) {
        const Scene& felt = scenes[random() % scenes.size()];
        const std::vector<TickRecord> all = run_trial(servo, felt, 5 + random() % 60);
        ContactState state;
        for (const TickRecord& tick : all) {
            const Contact expected = felt.tick(state, Vec2(tick.hip));
            REQUIRE(std::memcmp(&expected.force, &tick.force, sizeof(Vec2)) == 0);
            REQUIRE(std::memcmp(&expected.go, &tick.go, sizeof(Vec2)) == 0);
        }
    }
}

TEST_CASE("a parked device is never touched: before the first trial, after park, after a fault") {
    Stroking device;
    ThreadServo servo(device, modest());
    const auto untouched = [&] {
        const std::int64_t before = device.touches();
        nap(30);
        return device.touches() == before;
    };
    CHECK(untouched());
    CHECK(device.touches() == 0);
    CHECK_FALSE(servo.resting().has_value());

    const Scene felt = scene(5.0);
    REQUIRE(run_trial(servo, felt, 10).size() >= 10);
    const std::int64_t resting = device.touches();
    CHECK(
        eventually([&] { return device.touches() > resting + 20; }));  // between trials it is read
    CHECK(device.zero_was_last());
    servo.park();
    CHECK(untouched());
    CHECK(device.zero_was_last());
    servo.park();
    CHECK(untouched());
    servo.unpark();
    const std::int64_t before = device.touches();
    CHECK(eventually([&] { return device.touches() > before + 20; }));
    CHECK(servo.resting()->at_ns > 0);

    servo.park();
    device.fail_after(0, DeviceFault::garbage);
    servo.begin(felt);
    CHECK(eventually([&] { return servo.advance() == ServoStatus::faulted; }));
    CHECK(servo.resting()->at_ns == 0);  // where the handle was before a trial is no place after it
    CHECK(untouched());
    servo.end();
    CHECK(untouched());
    CHECK(servo.advance() == ServoStatus::faulted);
    CHECK(device.zero_was_last());

    device.fail_after(-1, DeviceFault::none);  // as reconnect() does
    CHECK(run_trial(servo, felt, 10).size() >= 10);
    CHECK(servo.advance() == ServoStatus::running);
}

TEST_CASE(
    "a fault at any tick writes zero, latches its cause, and is the last tick in ring and flight") {
    const std::pair<DeviceFault, Trip> faults[] = {
        {DeviceFault::lost, Trip::device_lost},
        {DeviceFault::silent, Trip::device_silent},
        {DeviceFault::garbage, Trip::device_garbage},
        {DeviceFault::unreachable, Trip::out_of_workspace}};
    std::mt19937 random(5);
    for (const auto& [fault, trip] : faults) {
        for (int round = 0; round < 3; ++round) {
            Stroking device;
            const auto good = static_cast<std::int64_t>(random() % 40);
            device.fail_after(good, fault);
            ThreadServo servo(device, modest(0.02));
            const Scene felt = scene(5.0);
            const std::vector<TickRecord> all = run_trial(servo, felt, 1000);
            CAPTURE(good, to_string(trip));
            REQUIRE(static_cast<std::int64_t>(all.size()) == good + 1);
            CHECK((all.back().flags & tick_fault) != 0);
            CHECK(all.back().command == Vec3{});
            CHECK(device.zero_was_last());
            CHECK(servo.trip() == trip);
            REQUIRE_FALSE(servo.last_ticks().empty());
            CHECK(servo.last_ticks().back().tick == good);
        }
    }
}

TEST_CASE(
    "a device that fails while the force ramps out does not keep end() waiting, and gets zero") {
    for (const std::int64_t good : {12, 20, 60, 110}) {
        CAPTURE(good);
        Stroking device;
        device.fail_after(good, DeviceFault::silent);
        ThreadServo servo(device, modest(0.1));
        const Scene felt = scene(5.0);
        const std::vector<TickRecord> all = run_trial(servo, felt, 10);
        REQUIRE(static_cast<std::int64_t>(all.size()) <= good + 1);
        CHECK(device.zero_was_last());
        if (servo.trip() != Trip::none) {
            const std::int64_t before = device.touches();
            nap(5);
            CHECK(device.touches() == before);
            CHECK(servo.advance() == ServoStatus::faulted);
        }
    }
}

TEST_CASE("the force is out when a caller's exception takes the servo with it, on both clocks") {
    const Scene felt = scene(5.0);
    Stroking device;
    const auto thrown_over_a_thread = [&] {
        ThreadServo servo(device, modest());
        servo.begin(felt);
        if (eventually([&] { return device.forces() > 3; })) {
            throw std::runtime_error("the disk is full");
        }
    };
    CHECK_THROWS_WITH(thrown_over_a_thread(), "the disk is full");
    CHECK(device.zero_was_last());
    const std::int64_t after = device.touches();
    nap(5);
    CHECK(device.touches() == after);

    const auto thrown_over_a_virtual_clock = [&] {
        VirtualServo servo(device, modest());
        servo.begin(felt);
        static_cast<void>(servo.advance());
        static_cast<void>(servo.advance());
        CHECK_FALSE(device.zero_was_last());
        throw std::runtime_error("the disk is full");
    };
    CHECK_THROWS_WITH(thrown_over_a_virtual_clock(), "the disk is full");
    CHECK(device.zero_was_last());
}

TEST_CASE("between trials a device that is gone is left alone, and the next trial says so") {
    Stroking device;
    device.fail_after(60, DeviceFault::lost);
    ThreadServo servo(device, modest());
    const Scene felt = scene(5.0);
    REQUIRE(run_trial(servo, felt, 10).size() >= 10);
    REQUIRE(eventually([&] {
        const auto last = servo.resting();
        return last && last->fault == DeviceFault::lost;
    }));
    nap(5);
    const std::int64_t before = device.touches();
    nap(20);
    CHECK(device.touches() == before);
    CHECK(device.zero_was_last());
    const std::vector<TickRecord> next = run_trial(servo, felt, 10);
    REQUIRE(next.size() == 1);
    CHECK(servo.trip() == Trip::device_lost);
}

TEST_CASE("the real-time tick allocates nothing, in a trial and between trials") {
    Stroking device;
    ServoSpec spec = modest();
    spec.spin_share = 0.3;
    ThreadServo servo(device, spec);
    const Scene felt = scene(5.0);
    servo.begin(felt);
    const std::size_t before = tests::allocations();
    const std::int64_t running = device.touches();
    while (device.touches() < running + 400) {
        nap(1);
    }
    servo.end();
    const std::int64_t resting = device.touches();
    while (device.touches() < resting + 100) {
        nap(1);
    }
    CHECK(tests::allocations() == before);
}

TEST_CASE("the virtual servo allocates nothing between begin and end") {
    Stroking device;
    VirtualServo servo(device, modest());
    const Scene felt = scene(5.0);
    const std::size_t before = tests::allocations();
    servo.begin(felt);
    for (int i = 0; i < 100; ++i) {
        static_cast<void>(servo.advance());
    }
    servo.end();
    CHECK(tests::allocations() == before);
}

TEST_CASE(
    "a reading that is no number trips, and every recorded force still follows from its HIP") {
    class Broken : public Stroking {
    public:
        Reading read() noexcept override {
            Reading reading = Stroking::read();
            if (++reads_ == 25) {
                reading.hip.x = std::numeric_limits<double>::quiet_NaN();
            }
            return reading;
        }

    private:
        int reads_ = 0;
    } device;
    VirtualServo servo(device, modest());
    const Scene felt = scene(5.0);
    servo.begin(felt);
    ServoStatus status = ServoStatus::running;
    for (int i = 0; i < 10 && status == ServoStatus::running; ++i) {
        status = servo.advance();
    }
    CHECK(status == ServoStatus::faulted);
    CHECK(servo.trip() == Trip::device_garbage);
    const std::vector<TickRecord> last = servo.last_ticks();
    REQUIRE(last.size() == 25);
    CHECK(last[24].hip == last[23].hip);
    ContactState state;
    for (const TickRecord& tick : last) {
        const Contact expected = felt.tick(state, Vec2(tick.hip));
        REQUIRE(std::memcmp(&expected.force, &tick.force, sizeof(Vec2)) == 0);
    }
}

TEST_CASE("lateness is counted for every tick of every trial and for no other") {
    Stroking device;
    ThreadServo servo(device, modest());
    const Scene felt = scene(5.0);
    std::int64_t ticks = 0;
    std::int64_t late = 0;
    std::int64_t missed = 0;
    for (int trial = 0; trial < 3; ++trial) {
        std::int64_t last = -1;
        for (const TickRecord& tick : run_trial(servo, felt, 50)) {
            ++ticks;
            late += (tick.flags & tick_late) != 0 ? 1 : 0;
            const auto deadline = static_cast<std::int64_t>(std::floor(
                (static_cast<double>(tick.time_ns) - static_cast<double>(tick.lateness_us) * 1e3) /
                    1e6 +
                0.5));
            missed += deadline - last - 1;
            last = deadline;
        }
        nap(10);
    }
    CHECK(servo.lateness().count() == ticks);
    CHECK(servo.lateness().late() == late);
    // Deadlines missed after a trial's last tick lie between trials, or just in the ramp's end.
    CHECK(servo.lateness().missed() >= missed);
}

TEST_CASE("a share of spinning outside 0 to 0.5 is refused with the value") {
    Stroking device;
    ServoSpec spec = modest();
    spec.spin_share = 0.75;
    CHECK_THROWS_WITH(ThreadServo(device, spec), Has("0.75") && Has("0 to 0.5"));
}

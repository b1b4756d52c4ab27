#include "engine/device/drivers/comedi_card.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/daq_bench.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

namespace {

/// Counters of the handle at `hip` on a card that stood at `start` with the handle at home.
std::array<std::uint32_t, 2> counters(const Calibration& how,
                                      const std::array<std::uint32_t, 2>& start,
                                      std::uint32_t top,
                                      const Vec2& hip) {
    const Pantograph pantograph(how.pantograph);
    const auto home = pantograph.counts(*pantograph.reach(*how.home));
    const auto there = pantograph.counts(*pantograph.reach(hip));
    std::array<std::uint32_t, 2> values{};
    for (std::size_t i = 0; i < 2; ++i) {
        const std::int64_t turned = std::int64_t{there[i]} - home[i];
        const std::int64_t sum =
            std::int64_t{start[i]} + (how.comedi->counter_clockwise[i] ? -turned : turned);
        values[i] = static_cast<std::uint32_t>(static_cast<std::uint64_t>(sum) & top);
    }
    return values;
}

Vec2 somewhere(Random& random) {
    return {random.in(-0.03, 0.03), random.in(0.03, 0.07)};
}

}  // namespace

TEST_CASE("counters are followed around their ends, from 16 to 32 bits, in both directions") {
    SEEDED(random, std::uint64_t{60});
    Calibration how = daq_calibration();
    how.comedi->counter_clockwise = {random.coin(), random.coin()};
    DaqBench bench;
    EACH(bits, 16, 24, 32);
    bench.counter_top = static_cast<std::uint32_t>((std::uint64_t{1} << bits) - 1);
    // Near an end, so that every path crosses it.
    const auto near_an_end = [&] {
        const auto off = static_cast<std::uint32_t>(random.below(200));
        return random.coin() ? off : bench.counter_top - off;
    };
    const std::array<std::uint32_t, 2> start{near_an_end(), near_an_end()};
    bench.counter = start;
    const auto device = plug(bench, how);
    const Pantograph pantograph(how.pantograph);
    Vec2 at = *how.home;
    for (int i = 0; i < 50; ++i) {
        at = at + 0.2 * (somewhere(random) - at);
        bench.counter = counters(how, start, bench.counter_top, at);
        const Reading reading = device->read();
        REQUIRE(reading.ok());
        CHECK(reading.counts == pantograph.counts(*pantograph.reach(at)));
        CHECK(glm::length(Vec2(reading.hip) - at) < 1e-4);  // a few encoder counts
    }
}

TEST_CASE("without a home the counters' own values count, as signed numbers") {
    Calibration how = daq_calibration();
    how.home.reset();
    how.comedi->counter_clockwise = {false, false};
    const Pantograph pantograph(how.pantograph);
    const auto there = pantograph.counts(*pantograph.reach({0.0, 0.05}));
    DaqBench bench;
    bench.counter = {static_cast<std::uint32_t>(there[0]) & 0xFFFFFFU,
                     static_cast<std::uint32_t>(there[1]) & 0xFFFFFFU};
    CHECK(plug(bench, how)->read().counts == there);
}

TEST_CASE("outputs give the torques of the pantograph's arithmetic, within half a code") {
    SEEDED(random, std::uint64_t{300});
    const Calibration how = daq_calibration();
    DaqBench bench;
    const bool narrow = random.coin();  // 2 V: the card limits before the motor
    bench.output = {.min = narrow ? -2.0 : -10.0,
                    .max = narrow ? 3.0 : 10.0,
                    .top = random.coin() ? 4095U : 65535U};
    const auto device = plug(bench, how);
    CHECK(at_zero(bench));
    const std::array<std::uint32_t, 2> start = bench.counter;
    PantographSpec spec = how.pantograph;
    if (narrow) {
        spec.axes[0].torque_limit = 2.0 / 10.0;
        spec.axes[1].torque_limit = 2.0 / 8.0;
        for (Axis& axis : spec.axes) {
            axis.torque_forever = std::fmin(axis.torque_forever, axis.torque_limit);
        }
    }
    const Pantograph pantograph(spec);
    for (int i = 0; i < 20; ++i) {
        bench.counter = counters(how, start, bench.counter_top, somewhere(random));
        const Reading reading = device->read();
        REQUIRE(reading.ok());
        const double max = random.coin() ? 3.0 : 60.0;
        const Vec2 force{random.in(-max, max), random.in(-max, max)};
        const AppliedForce applied = device->write(Vec3(force, 0.0));

        const auto fix = *pantograph.locate(pantograph.angles(reading.counts));
        const MotorDrive drive = pantograph.drive(fix, force);
        const double code = (bench.output.max - bench.output.min) / bench.output.top;
        CHECK(std::fabs(volts_of(bench, 0) - 10.0 * drive.torque.x) <= 0.500001 * code);
        CHECK(std::fabs(volts_of(bench, 1) + 8.0 * drive.torque.y) <= 0.500001 * code);
        CHECK(applied.saturated == drive.saturated);
        CHECK(applied.load == drive.load);
        CHECK(applied.codes[0] == static_cast<std::int32_t>(bench.code[0]));
        CHECK(applied.codes[1] == static_cast<std::int32_t>(bench.code[1]));
        CHECK(device->weakest_force(reading.hip) == pantograph.weakest_force(Vec2(reading.hip)));
    }
    for (const std::uint32_t range : bench.range_used) {
        REQUIRE(range == 3);
    }
}

TEST_CASE("zero volts is the middle of the range and never code 0") {
    DaqBench bench;
    {
        const auto device = plug(bench);
        CHECK(bench.code[0] == 32768);  // (0 + 10) / 20 * 65535 = 32767.5
        CHECK(bench.code[1] == 32768);
    }
    bench.output = {.min = -5.0, .max = 10.0, .top = 3000};
    const auto device = plug(bench);
    CHECK(bench.code[0] == 1000);
}

TEST_CASE("a force that is not a number, or beyond all numbers, gives zero volts") {
    DaqBench bench;
    const auto device = plug(bench);
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    constexpr double kInf = std::numeric_limits<double>::infinity();
    constexpr double kMax = std::numeric_limits<double>::max();
    for (const Vec3 force : {Vec3{kNan, 0.0, 0.0}, Vec3{0.0, kNan, 0.0}, Vec3{kInf, 1.0, 0.0},
                             Vec3{1.0, -kInf, 0.0}}) {
        static_cast<void>(device->read());
        device->write({2.0, 2.0, 0.0});
        REQUIRE_FALSE(at_zero(bench));
        CHECK_FALSE(device->write(force).saturated);
        CHECK(at_zero(bench));
    }
    // Finite, but its torque may not be: within the range either way.
    device->write({kMax, kMax, 0.0});
    const auto& [one, two] = daq_calibration().pantograph.axes;  // 10 and 8 V per N m
    CHECK(std::fabs(volts_of(bench, 0)) <= 10.0 * one.torque_limit + 1e-3);
    CHECK(std::fabs(volts_of(bench, 1)) <= 8.0 * two.torque_limit + 1e-3);
}

TEST_CASE("zero volts is the last thing written, whichever call fails and however it ends") {
    SEEDED(random, std::uint64_t{300});
    const Calibration how = daq_calibration();
    DaqBench bench;
    auto device = plug(bench, how);
    const std::array<std::uint32_t, 2> start = bench.counter;
    bench.failing_call = bench.calls + random.below(60);
    constexpr std::array kErrors{ENODEV, EIO, ETIMEDOUT, EAGAIN, EINVAL};
    bench.error = kErrors[random.index(5)];
    const bool silent = bench.error == ETIMEDOUT || bench.error == EAGAIN;
    DeviceFault seen = DeviceFault::none;
    for (int i = 0; i < 30; ++i) {
        bench.counter = counters(how, start, bench.counter_top, somewhere(random));
        const Reading reading = device->read();
        const bool was_failing = bench.calls > bench.failing_call;
        device->write({random.in(-3.0, 3.0), random.in(1.0, 3.0), 0.0});
        if (seen != DeviceFault::none) {
            CHECK(reading.fault == seen);  // until reconnect()
        }
        if (was_failing || reading.fault != DeviceFault::none) {
            CHECK(at_zero(bench));
        }
        seen = reading.fault;
    }
    const bool met = bench.failing_call < bench.calls;
    if (met && seen != DeviceFault::none) {
        CHECK(seen == (silent ? DeviceFault::silent : DeviceFault::lost));
        CHECK_THAT(device->trouble(), Has("/dev/comedi7", "bring the handle to its rest pose"));
        bench.counter = start;
        CHECK(device->reconnect());
        CHECK(device->trouble().empty());
        CHECK(device->read().ok());
        device->write({1.0, 1.0, 0.0});
    }
    device.reset();
    CHECK(at_zero(bench));
    CHECK_FALSE(bench.is_open);
}

TEST_CASE("zero is never said of a card that does not take it") {
    const int failing = GENERATE(0, 1, 2);  // of the two writes; 2: neither
    const Calibration how = daq_calibration();
    DaqBench bench;
    auto device = plug(bench, how);
    REQUIRE(device->read().ok());
    device->write({1.0, 2.0, 0.0});
    bench.failing_call = failing < 2 ? bench.calls + failing : -1;
    bench.error = EIO;
    CHECK(device->prove_zero() == (failing == 2));
    CHECK(device->read().ok() == (failing == 2));
}

TEST_CASE("a counter that jumps, or reads beyond its bits, is garbage and stops the force") {
    for (const std::uint32_t value : {0x600000U, 0x1000000U}) {
        DaqBench bench;
        const auto device = plug(bench);
        REQUIRE(device->read().ok());
        device->write({2.0, 1.0, 0.0});
        bench.counter[1] = value;
        CHECK(device->read().fault == DeviceFault::garbage);
        CHECK(at_zero(bench));
        CHECK_THAT(device->trouble(), Has("a counter jumped"));
    }
}

TEST_CASE("a handle beyond the linkage gives no force, and comes back by itself") {
    DaqBench bench;
    const auto device = plug(bench);
    static_cast<void>(device->read());
    device->write({2.0, 1.0, 0.0});
    // Driven links flat and apart: the elbows are 151 mm from each other, the free links reach 150.
    const Pantograph pantograph(daq_calibration().pantograph);
    const auto rest = pantograph.counts(*pantograph.reach(*daq_calibration().home));
    const auto flat = pantograph.counts({3.14159265, 0.0});
    const auto home = bench.counter;
    bench.counter = {static_cast<std::uint32_t>(flat[0] - rest[0]) & 0xFFFFFFU,
                     static_cast<std::uint32_t>(rest[1] - flat[1]) & 0xFFFFFFU};
    CHECK(device->read().fault == DeviceFault::unreachable);
    device->write({2.0, 1.0, 0.0});
    CHECK(at_zero(bench));
    bench.counter = home;
    CHECK(device->read().ok());
    CHECK(device->trouble().empty());
}

TEST_CASE("a card that stays away is asked again, and says each time what is wrong") {
    DaqBench bench;
    const auto device = plug(bench);
    bench.failing_call = bench.calls;
    bench.failing_calls = 1000;
    CHECK(device->read().fault == DeviceFault::lost);
    for (int i = 0; i < 3; ++i) {
        bench.open_error = i == 1 ? EBUSY : ENODEV;
        CHECK_FALSE(device->reconnect());
        CHECK_THAT(device->trouble(),
                   Has(i == 1 ? "another program uses it" : "its driver loaded"));
        CHECK(device->read().fault == DeviceFault::lost);
        device->write({1.0, 1.0, 0.0});
    }
    bench.open_error = 0;
    bench.failing_call = -1;
    bench.counter = {77, 88};  // the driver was loaded anew; the handle rests at home
    CHECK(device->reconnect());
    const Reading reading = device->read();
    CHECK(reading.ok());
    CHECK(glm::length(Vec2(reading.hip) - Vec2{0.0, 0.060}) < 1e-4);
    CHECK(bench.opened == 5);
}

TEST_CASE("a card or a calibration that does not fit is refused with the remedy, at zero volts") {
    const auto said = [](DaqBench& bench, const Calibration& how) {
        const std::string why = refusal_of<std::exception>([&] { return plug(bench, how); });
        CHECK_FALSE(bench.is_open);
        return why;
    };
    Calibration how = daq_calibration();
    DaqBench bench;
    bench.open_error = EACCES;
    CHECK_THAT(said(bench, how), Has("join the group"));
    bench.open_error = 0;
    bench.output.min = 0.0;
    CHECK_THAT(said(bench, how), Has("range 3 of output 2 goes from 0 V to 10 V", "both signs"));
    bench.output.min = -10.0;
    bench.counter_top = 255;
    CHECK_THAT(said(bench, how), Has("16 to 32 bits"));
    CHECK(bench.code[0] == 32768);  // the output was reached: zero
    bench.counter_top = 0xFFFFFF;
    how.comedi->counter = {0, 5};
    CHECK_THAT(said(bench, how), Has("check subdevices, channels and range"));
    CHECK(at_zero(bench));
    how = daq_calibration();
    how.comedi->volts_per_newton_metre[1] = 0.0;
    CHECK_THAT(said(bench, how), Has("volts_per_newton_metre is 0"));
    how = daq_calibration();
    how.home = Vec2{0.0, 1.0};
    CHECK_THAT(said(bench, how), Has("calibrate again"));
    how.comedi.reset();
    CHECK_THAT(said(bench, how), Has("[comedi]"));
}

TEST_CASE("a card that is not there is a sentence, also in a build without Comedi") {
    CHECK_THROWS_WITH(open_comedi("/nowhere/comedi0", daq_calibration()),
                      Has("/nowhere/comedi0: ") || Has("install libcomedi-dev and build again"));
}

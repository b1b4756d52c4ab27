#include "engine/commissioning/short_form.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/emulated_machine.hpp"
#include "tests/support/miswired_machine.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

// Three straight axes are proved: by an independent simulation of each axis, on a virtual clock.

namespace {

using Axes = std::array<AxisDynamics, 3>;

constexpr double kPulseTick = 1e-3;
constexpr std::array<const char*, 3> kAxisName{"x", "y", "z"};

Axes right_axes() {
    Axes axes{};
    axes[0] = {.mass = 0.30, .damping = 4.0, .friction = 0.05, .pull = 0.0};
    axes[1] = {.mass = 0.20, .damping = 3.0, .friction = 0.02, .pull = 0.0};
    axes[2] = {.mass = 0.12, .damping = 3.0, .friction = 0.06, .pull = 0.04};
    return axes;
}

Vec3 mass_of(const Axes& axes) {
    return {axes[0].mass, axes[1].mass, axes[2].mass};
}

/// @param after_marks  what happens once the handle is at the last mark, before a motor turns
CommissioningResult commissioned(
    MiswiredGantry& device, const Vec3& mass, const std::function<void()>& after_marks = [] {}) {
    const Calibration machine = gantry_machine();
    int brought = 0;
    return commission(device, machine, places_to_commission(machine, {}), mass,
                      attended(
                          [&](const Vec3& place) {
                              device.bring(place);
                              ++brought;
                          },
                          [&, still = 0]() mutable {
                              still = brought == 4 ? still + 1 : 0;
                              if (still == 251) {  // a quarter of a second at the last mark
                                  after_marks();
                              }
                          },
                          kPulseTick));
}

/// As an opening proves it at home.
ShortForm proved_again(MiswiredGantry& device, const RigRecord& record) {
    const Calibration machine = gantry_machine();
    device.bring(machine.gantry->home());
    PulseRunner runner(device, palpate::engine::Machine(machine), kPulseTick, [] { return true; });
    return prove_again(runner, machine, record, kPulseTick);
}

/// Order, signs and gains at random; `dead` may have one that says nothing.
Cables drawn(Random& random, bool dead) {
    Cables cables;
    for (std::size_t i = 0; i < 3; ++i) {
        std::swap(cables.axis[i], cables.axis[i + random.index(3 - i)]);
        cables.factor[i] = std::array{1.0, -1.0, 0.5, -0.5, 2.0, -2.0}.at(random.index(6));
    }
    if (dead && random.coin()) {
        cables.factor[random.index(3)] = 0.0;
    }
    return cables;
}

/// What is wrong with one of three alone, then all kinds at random.
Cables wrong_cables(unsigned seed) {
    Cables cables;
    if (seed < 12) {
        cables.factor[seed % 3] = std::array{-1.0, 0.0, 2.0, 0.5}[seed / 3];
    } else if (seed < 15) {
        std::swap(cables.axis[seed % 3], cables.axis[(seed + 1) % 3]);
    } else {
        Random random(seed);
        while (cables == Cables{}) {
            cables = drawn(random, true);
        }
    }
    return cables;
}

bool says(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("right axes of many kinds pass with their numbers, by pulses that end by themselves") {
    SEEDED(random, 12U);
    Axes axes{};
    for (AxisDynamics& axis : axes) {
        axis.mass = random.decade(-1.2, -0.1);
        axis.damping = random.in(1.0, 8.0);
        axis.friction = random.coin() ? random.in(0.0, 0.25) : 0.0;
    }
    axes[2].pull = random.in(-0.8, 0.8) * axes[2].friction;
    MiswiredGantry device(gantry_machine(), axes, {}, {});
    const CommissioningResult done = commissioned(device, mass_of(axes));
    CAPTURE(done.refused, axes[0].friction, axes[1].friction, axes[2].friction, axes[2].pull);
    REQUIRE(done.refused.empty());
    for (std::size_t i = 0; i < 3; ++i) {
        const AxisDynamics& found = done.record.axes[i];
        CAPTURE(i);
        CHECK(found.mass == Approx(axes[i].mass).epsilon(0.06));
        CHECK(found.damping == Approx(axes[i].damping).epsilon(0.1).margin(0.2));
        CHECK(found.friction == Approx(axes[i].friction).margin(0.012));
        CHECK(found.pull == Approx(axes[i].pull).margin(0.015));
    }
    const double damping = std::min(
        {done.record.axes[0].damping, done.record.axes[1].damping, done.record.axes[2].damping});
    CHECK(done.record.damping == Approx(0.8 * damping).epsilon(1e-12));
    CHECK(done.record.stiffness == Approx(done.record.damping / (kPulseTick * 1.5)).epsilon(1e-9));
    REQUIRE(done.record.mark);
    CHECK(glm::length(*done.record.mark - Vec3(0.016, 0.028, 0.0)) < 1e-15);
    CHECK(device.last == Vec3{});
    CHECK(device.strongest <= 1.0 + 1e-12);
    CHECK(device.furthest < 0.030);  // of all pulses together, to and fro
}

TEST_CASE("every wrong encoder of three is found and named, and no motor turns meanwhile") {
    for (unsigned seed = 0; seed < 120; ++seed) {
        const Cables encoders = wrong_cables(seed);
        CAPTURE(seed, encoders.axis, encoders.factor);
        MiswiredGantry device(gantry_machine(), right_axes(), encoders,
                              {.axis = {1, 2, 0}, .factor = {-2.0, 0.5, 0.0}});
        const CommissioningResult done = commissioned(device, mass_of(right_axes()));
        CAPTURE(done.refused);
        CHECK(device.strongest == 0.0);
        CHECK_FALSE(done.refused.empty());
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t axis = encoders.axis[i];
            const std::string own = std::string("encoder ") + kAxisName[axis];
            const double factor = encoders.factor[i];
            const bool same = axis == i;
            CHECK(says(done.refused, own + " did not count") == (factor == 0.0));
            CHECK(says(done.refused, std::string("encoder ") + kAxisName[i] +
                                         " counts what moves along " + kAxisName[axis]) ==
                  (!same && factor != 0.0));
            CHECK(says(done.refused, own + " is reversed: write encoder_" + kAxisName[axis] +
                                         " = \"backward\"") == (same && factor < 0.0));
            const std::string times =
                std::fabs(factor) > 1.0 ? " counts 2 times" : " counts 0.5 times";
            CHECK(says(done.refused, own + times) ==
                  (same && factor != 0.0 && std::fabs(factor) != 1.0));
        }
    }
}

TEST_CASE("every wrong motor of three is found and named, by 1 N at most") {
    for (unsigned seed = 0; seed < 60; ++seed) {
        const Cables motors = wrong_cables(seed);
        CAPTURE(seed, motors.axis, motors.factor);
        MiswiredGantry device(gantry_machine(), right_axes(), {}, motors);
        const CommissioningResult done = commissioned(device, mass_of(right_axes()));
        CAPTURE(done.refused);
        CHECK(device.strongest <= 1.0 + 1e-12);
        CHECK(device.last == Vec3{});
        CHECK_FALSE(done.refused.empty());
        bool turned = false;
        for (std::size_t i = 0; i < 3; ++i) {
            turned = turned || motors.axis[i] != i || motors.factor[i] <= 0.0;
        }
        for (std::size_t i = 0; i < 3; ++i) {
            const std::string motor = std::string("motor ") + kAxisName[i];
            const double factor = motors.factor[i];
            const bool same = motors.axis[i] == i;
            CHECK(says(done.refused, "nothing counts when " + motor + " pushes") ==
                  (factor == 0.0));
            CHECK(says(done.refused, motor + " moves axis " + kAxisName[motors.axis[i]] +
                                         (factor < 0.0 ? " backward: swap" : ": swap")) ==
                  (!same && factor != 0.0));
            CHECK(says(done.refused,
                       motor + " is reversed: turn its two wires round, or write motor_" +
                           kAxisName[i] + " = \"backward\"") == (same && factor < 0.0));
            CHECK(says(done.refused, motor + " gives ") == (!turned && std::fabs(factor) != 1.0));
        }
    }
}

TEST_CASE(
    "an encoder that dies before the pulses is found, and its axis ends within 40 mm unseen") {
    const std::size_t dead = GENERATE(0U, 1U, 2U);
    const bool slides = GENERATE(false, true);  // nothing brakes it
    CAPTURE(dead, slides);
    Axes axes = right_axes();
    if (slides) {
        axes[dead] = {.mass = 0.10, .damping = 0.0, .friction = 0.0, .pull = 0.0};
    }
    MiswiredGantry device(gantry_machine(), axes, {}, {});
    const CommissioningResult done =
        commissioned(device, mass_of(axes), [&] { device.encoders.factor[dead] = 0.0; });
    CHECK_THAT(done.refused,
               Has(std::string("nothing counts when motor ") + kAxisName[dead] + " pushes by 1 N",
                   std::string("the cable of encoder ") + kAxisName[dead]));
    CHECK(device.furthest < 0.040);
    CHECK(device.last == Vec3{});
}

TEST_CASE("a pulse is reversed once the handle has gone 3 mm, however strong the motor is") {
    const Calibration machine = gantry_machine();
    int reversed = 0;
    int ended = 0;
    for (unsigned seed = 0; seed < 60; ++seed) {
        CAPTURE(seed);
        Random random(seed);
        const auto axis = random.index(3);
        Cables motors;
        motors.factor[axis] = (random.coin() ? 1.0 : -1.0) * random.decade(0.0, 1.5);
        MiswiredGantry device(machine, right_axes(), {}, motors);
        device.bring(Vec3(0.0));
        PulseRunner runner(device, palpate::engine::Machine(machine), kPulseTick,
                           [] { return true; });
        const Pulse pulse = runner.give(pulse_directions(3)[2 * axis], {.force = 1.0});
        CHECK(device.last == Vec3{});
        if (pulse.trip != Trip::none) {  // it ran away before it could be reversed, or then
            ++ended;
            CHECK(pulse.trip == Trip::over_speed);
        }
        const Vec3 quantum = Gantry(*machine.gantry).quantum();
        for (std::size_t k = 0; k < pulse.samples.size(); ++k) {
            const auto& counts = pulse.samples[k].counts;
            const double way =
                quantum.x * std::abs(counts[axis] - pulse.samples.front().counts[axis]);
            const bool before = pulse.turn == 0 || k + 1 < pulse.turn;
            CHECK((!before || way < 0.003 || pulse.trip != Trip::none));
            reversed += k + 1 == pulse.turn && way >= 0.003 ? 1 : 0;
        }
        CHECK(device.furthest < 0.080);
    }
    CHECK(reversed > 20);
    CHECK(ended > 0);
}

TEST_CASE("a fault at any tick of the pulses ends the force at once, and no rig is proved") {
    int ticks = 0;
    {
        MiswiredGantry device(gantry_machine(), right_axes(), {}, {});
        REQUIRE(commissioned(device, mass_of(right_axes())).refused.empty());
        ticks = device.ticks;
    }
    Random random(3);
    for (int i = 0; i < 25; ++i) {
        MiswiredGantry device(gantry_machine(), right_axes(), {}, {});
        device.fails_at = 1100 + random.below(ticks - 1200);
        double after = 0.0;
        const Calibration machine = gantry_machine();
        const CommissioningResult done = commission(
            device, machine, places_to_commission(machine, {}), mass_of(right_axes()),
            attended(
                [&](const Vec3& place) { device.bring(place); },
                [&] { after += device.ticks >= device.fails_at ? glm::length(device.last) : 0.0; },
                kPulseTick));
        CAPTURE(device.fails_at, done.refused);
        CHECK_FALSE(done.refused.empty());
        CHECK(after == 0.0);
        CHECK(device.last == Vec3{});
    }
}

TEST_CASE("the short form of three axes passes the rig that was commissioned, and no other") {
    const Calibration machine = gantry_machine();
    MiswiredGantry right(machine, right_axes(), {}, {});
    const RigRecord record = commissioned(right, mass_of(right_axes())).record;
    const auto opened = [&](const Axes& axes, const Cables& encoders, const Cables& motors) {
        MiswiredGantry device(machine, axes, encoders, motors);
        return proved_again(device, record);
    };
    const ShortForm passed = opened(right_axes(), {}, {});
    CHECK(passed.refused.empty());
    CHECK(std::count(passed.found.begin(), passed.found.end(), '%') == 6);
    for (unsigned seed = 0; seed < 30; ++seed) {
        const Cables wrong = wrong_cables(seed);
        CAPTURE(seed, wrong.axis, wrong.factor);
        CHECK_FALSE(opened(right_axes(), {}, wrong).refused.empty());
        CHECK_FALSE(opened(right_axes(), wrong, {}).refused.empty());
    }
    for (int axis = 0; axis < 3; ++axis) {
        const auto at = static_cast<std::size_t>(axis);
        for (const double gain : {0.5, 0.75, 0.9, 1.1, 1.25, 2.0}) {
            CAPTURE(axis, gain);
            Cables motors;
            motors.factor[at] = gain;
            CHECK(opened(right_axes(), {}, motors).refused.empty() ==
                  (std::fabs(gain - 1.0) < 0.15));
        }
        Axes rubs = right_axes();
        rubs[at].friction *= 1.3;
        rubs[at].damping *= 0.8;
        CHECK(opened(rubs, {}, {}).refused.empty());
    }
    Axes held = right_axes();
    held[2].mass += 0.3;  // a hand rests on it
    CHECK_THAT(opened(held, {}, {}).refused,
               Has("not explained by mass, damping and friction", "does somebody hold it"));
}

TEST_CASE("answers of three axes that are 5 ms late are found, and hide no stronger motor") {
    const Calibration machine = gantry_machine();
    SEEDED(random, 3U);
    Axes axes{};
    for (AxisDynamics& axis : axes) {
        axis = {.mass = random.decade(-1.2, -0.1),
                .damping = random.in(1.0, 8.0),
                .friction = random.coin() ? random.in(0.0, 0.25) : 0.0};
    }
    MiswiredGantry right(machine, axes, {}, {});
    const RigRecord record = commissioned(right, mass_of(axes)).record;
    for (const std::size_t late : {3U, 7U, 20U}) {
        for (const double gain : {1.0, 1.5, 3.0}) {
            MiswiredGantry device(machine, axes, {}, {.factor = {gain, gain, gain}});
            device.late = late;
            const std::string changed = proved_again(device, record).refused;
            const std::string refused = commissioned(device, mass_of(axes)).refused;
            CAPTURE(late, gain, changed, refused);
            CHECK(changed.empty() == (late == 3 && gain == 1.0));
            CHECK(refused.empty() == (late == 3 && gain == 1.0));
        }
    }
}

TEST_CASE("a handle that sinks, a home at an end and marks beside the axes are refused") {
    Axes axes = right_axes();
    axes[2].pull = 0.08;  // 0.06 N of friction do not hold it
    MiswiredGantry device(gantry_machine(), axes, {}, {});
    const CommissioningResult done = commissioned(device, mass_of(axes));
    CHECK_THAT(done.refused, Has("the handle did not rest at (0, 0, 40) mm", "counterweight"));
    CHECK(device.strongest == 0.0);

    Calibration machine = gantry_machine();
    const auto refused = [&](const std::vector<Vec3>& places) {
        CHECK_THROWS_WITH(commission(device, machine, places, Vec3(0.1), {}),
                          Has("marks of three axes are home and a place along each axis"));
    };
    auto places = places_to_commission(machine, {});
    places[1].y += 0.001;
    refused(places);
    places = places_to_commission(machine, {});
    places[3].z = 0.021;
    refused(places);
    places.pop_back();
    refused(places);
    machine.gantry->axes[2].home = 0.055;
    CHECK_THROWS_WITH(places_to_commission(machine, {}),
                      Has("home of axis z is less than 10 mm from its end"));
}

TEST_CASE("no exchanged or reversed encoders of three axes say that they are at the second mark") {
    Random random(7);
    for (int i = 0; i < 200; ++i) {
        Calibration machine = gantry_machine();
        for (StraightAxis& axis : machine.gantry->axes) {
            axis.low = -1e-3 * (30 + random.below(60));
            axis.high = 1e-3 * (30 + random.below(60));
            axis.home = 1e-3 * random.below(20);
            axis.motor.counts_per_turn *= i % 3 == 0 ? 1 : 1 + random.below(3);
            axis.radius *= i % 3 < 2 ? 1.0 : random.in(0.5, 2.0);
        }
        const GantrySpec& spec = *machine.gantry;
        const Gantry gantry(spec);
        Vec3 mark;
        try {
            mark = second_mark(machine, places_to_commission(machine, {}));
        } catch (const std::invalid_argument&) {
            CHECK(i % 3 != 0);  // of equal axes any that can be commissioned has one
            continue;
        }
        CAPTURE(i, mark.x, mark.y, mark.z);
        REQUIRE(gantry.weakest_force(mark));
        const Vec3 counts = (mark - spec.home()) / gantry.quantum();
        const std::array<std::array<int, 3>, 6> orders{
            {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
        for (unsigned k = 1; k < 48; ++k) {
            Gantry::Counts plugged{};
            for (unsigned axis = 0; axis < 3; ++axis) {
                const double sign = (k % 8 >> axis & 1U) != 0 ? -1.0 : 1.0;
                plugged[axis] =
                    static_cast<std::int32_t>(std::lround(sign * counts[orders[k / 8][axis]]));
            }
            const auto said = gantry.locate(plugged);
            CAPTURE(k);
            CHECK((!said || glm::length(*said - mark) > kPlaced + 0.9 * kAtPlace));
        }
    }
}

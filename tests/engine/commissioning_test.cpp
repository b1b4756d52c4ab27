#include "engine/commissioning/short_form.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/emulated_machine.hpp"
#include "tests/support/miswired_machine.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

namespace {

constexpr double kPeriod = 1e-3;
const Vec2 kHome{0.0, 0.060};

PlantModel plant_of(std::string_view preset) {
    PlantModel plant;
    plant.machine = emulated_calibration(preset).pantograph;
    return plant;
}

/// Where it is commissioned: they are looked for among thousands, once a machine.
const std::vector<Vec3>& places_of(const PlantModel& plant) {
    static std::map<std::string, std::vector<Vec3>> known;
    auto& places = known[plant.machine.name];
    if (places.empty()) {
        places = places_to_commission({.pantograph = plant.machine}, kHome);
    }
    return places;
}

CommissioningDesk desk_of(MiswiredMachine& device) {
    return attended([&device](const Vec3& place) { device.bring(Vec2(place)); }, [] {}, kPeriod);
}

CommissioningResult commissioned(const PlantModel& plant, MiswiredMachine& device) {
    return commission(device, {.pantograph = plant.machine}, places_of(plant),
                      Vec3(plant.handle_mass), desk_of(device));
}

CommissioningResult commissioned(const PlantModel& plant, const Connection& motors = {}) {
    MiswiredMachine device(plant, {}, motors);
    return commissioned(plant, device);
}

/// As an opening proves it at home.
ShortForm proved_again(const PlantModel& plant, MiswiredMachine& device, const RigRecord& record) {
    device.bring(kHome);
    const Calibration machine{.pantograph = plant.machine};
    PulseRunner runner(device, palpate::engine::Machine(machine), kPeriod, [] { return true; });
    return prove_again(runner, machine, record, kPeriod * device.traits().delay_ticks);
}

}  // namespace

TEST_CASE(
    "every wrong connection of two encoders is found and named, and no motor turns meanwhile") {
    const PlantModel plant = plant_of("gen3");
    for (const Connection& encoders : all_connections()) {
        CAPTURE(encoders.swapped, encoders.factor[0], encoders.factor[1]);
        // What the motors are does not matter then.
        MiswiredMachine device(plant, encoders, {.swapped = true, .factor = {-2.0, 0.5}});
        const CommissioningResult done = commissioned(plant, device);
        if (encoders == Connection{}) {
            CHECK(done.encoders.fits);
            CHECK(done.encoders.connection == encoders);
            CHECK(device.strongest() > 0.0);
            continue;
        }
        CHECK(done.encoders.connection.swapped == encoders.swapped);
        CHECK_THAT(done.refused, Has("encoder"));
        CHECK(device.strongest() == 0.0);
    }
}

TEST_CASE(
    "every wrong connection of two motors is found and named, by 0.3 N at most, and the right one "
    "passes with its numbers") {
    const PlantModel plant = plant_of("gen3");
    for (const Connection& motors : all_connections()) {
        CAPTURE(motors.swapped, motors.factor[0], motors.factor[1]);
        MiswiredMachine device(plant, {}, motors);
        const CommissioningResult done = commissioned(plant, device);
        const double asked = device.max_asked();
        CAPTURE(done.refused);
        CHECK(asked <= 0.3 * (1.0 + 1e-12));
        if (motors == Connection{}) {
            CHECK(done.refused.empty());
            CHECK(done.record.dynamics.handle_mass == Approx(plant.handle_mass).epsilon(0.1));
            for (int i = 0; i < 2; ++i) {
                CHECK(done.record.dynamics.inertia[i] == Approx(plant.inertia[i]).epsilon(0.2));
                CHECK(done.record.dynamics.damping[i] == Approx(plant.damping[i]).epsilon(0.1));
                CHECK(done.record.dynamics.friction[i] == Approx(plant.coulomb[i]).epsilon(0.2));
            }
            const double damping = min_handle_damping(plant);
            CHECK(done.record.damping < damping);
            CHECK(done.record.damping > 0.7 * damping);
            CHECK(done.record.stiffness ==
                  Approx(done.record.damping / (kPeriod * (0.5 + 1.15))).epsilon(1e-9));
            continue;
        }
        REQUIRE_FALSE(done.refused.empty());
        const bool turned = motors.swapped || motors.factor[0] < 0.0 || motors.factor[1] < 0.0;
        CHECK(misnamed(done.refused, motors) == "");
        if (turned) {  // before a stronger pulse, which its gain needs
            CHECK(asked <= done.record.force * (1.0 + 1e-12));
            CHECK(done.record.force < 0.3);
        } else {
            CHECK(done.motors->connection == motors);
        }
    }
}

/// A machine of one of three linkages, whose friction is in its joints, at its handle, or both.
PlantModel some_plant(unsigned seed) {
    Random random(seed);
    PlantModel plant = plant_of(seed % 3 == 0 ? "gen3" : seed % 3 == 1 ? "gen2" : "haplet");
    plant.handle_mass = random.in(0.05, 0.15);
    plant.inertia = {random.in(0.5e-4, 2e-4), random.in(0.5e-4, 2e-4)};
    const bool in_joints = seed % 4 != 3;
    plant.damping = in_joints ? Vec2{random.decade(-3.5, -2.0), random.decade(-3.5, -2.0)} : Vec2{};
    plant.coulomb = in_joints ? Vec2{random.decade(-4.0, -2.7), random.decade(-4.0, -2.7)} : Vec2{};
    if (seed % 2 == 1) {
        plant.handle_damping = random.in(0.3, 1.0);
        plant.handle_friction = random.in(0.02, 0.04);
    }
    return plant;
}

TEST_CASE(
    "right machines of many kinds pass, their friction in joints or at the handle found to a "
    "tenth, and the same twice as strong or half do not") {
    SEED(4U);
    const PlantModel plant = some_plant(seed);
    const CommissioningResult right = commissioned(plant);
    CAPTURE(right.refused);
    CHECK(right.refused.empty());
    const HandleDynamics& found = right.record.dynamics;
    CHECK(found.handle_mass == Approx(plant.handle_mass).epsilon(0.1));
    CHECK(found.handle_damping == Approx(plant.handle_damping).epsilon(0.1).margin(0.03));
    CHECK(found.handle_friction == Approx(plant.handle_friction).epsilon(0.1).margin(0.002));
    // The passivity condition reckons with the whole, less a fifth.
    CHECK(right.record.damping ==
          Approx(0.8 * min_handle_damping(plant)).epsilon(0.1).margin(0.01));
    const double gain = seed < 2 ? 0.5 : 2.0;
    const CommissioningResult wrong = commissioned(plant, {.factor = {gain, gain}});
    CHECK_THAT(wrong.refused, Has(gain < 1.0 ? "motor 1 is too weak, motor 2 is"
                                             : "motor 1 is too strong, motor 2"));
}

TEST_CASE("a motion that mass and friction do not explain blames no motor") {
    const auto [cable, seed] =  // N/m: dry friction holds the handle
        GENERATE(table<double, unsigned>({{2.0, 1U}, {4.0, 5U}, {3.0, 11U}}));
    CAPTURE(cable, seed);
    const PlantModel plant = some_plant(seed);
    MiswiredMachine device(plant, {}, {});
    device.tie(cable);
    const CommissioningResult done = commissioned(plant, device);
    CAPTURE(done.refused, done.motors->gain[0], done.motors->gain[1], done.motors->unexplained);
    CHECK_THAT(done.refused, !Has("amplifier"));
    CHECK_THAT(done.refused,
               Catch::Equals("") || (Has("not explained by mass, damping and friction",
                                         "does a cable pull at the handle")));
}

TEST_CASE(
    "a drag that grows with the square of the speed blames no motor, and air's changes nothing") {
    EACH(drag, 0.01, 5.0, 100.0);  // N s^2/m^2: ten times air's, water's, oil's
    EACH(seed, take(cases(std::size_t{2}), values({3U, 5U})));
    const PlantModel plant = some_plant(seed);
    MiswiredMachine device(plant, {}, {});
    device.dip(drag);
    const CommissioningResult done = commissioned(plant, device);
    CHECK_THAT(done.refused,
               Catch::Equals("") || Has("not explained by mass, damping and friction"));
    if (drag < 0.1) {
        CHECK(done.record.damping ==
              Approx(0.8 * min_handle_damping(plant)).epsilon(0.1).margin(0.01));
    }
}

TEST_CASE(
    "the short form finds each motor a quarter weaker or stronger, and is not misled by friction") {
    SEED(3U);
    const PlantModel plant = some_plant(seed);
    const RigRecord record = commissioned(plant).record;
    const auto opened = [&](const Vec2& gain, double friction) {
        PlantModel now = plant;
        now.damping *= friction;
        now.coulomb *= friction;
        now.handle_damping *= friction;
        now.handle_friction *= friction;
        MiswiredMachine device(now, {}, {.factor = {gain.x, gain.y}});
        return proved_again(now, device, record).refused;
    };
    for (const double friction : {0.8, 1.0, 1.2}) {
        CHECK(opened({1.0, 1.0}, friction) == "");
    }
    CHECK(opened({0.9, 1.1}, 1.0) == "");
    for (const double gain : {0.0, 0.5, 0.75, 1.25, 1.5, 2.0}) {
        CAPTURE(gain);
        CHECK(opened({gain, 1.0}, 1.0) != "");
        CHECK(opened({1.0, gain}, 1.0) != "");
        CHECK(opened({gain, gain}, 1.0) != "");
    }
    CHECK_THAT(opened({0.75, 0.75}, 1.0), Has("motor 1 gives 0.7", "wire of the motor loose"));
}

TEST_CASE("the short form passes the rig that was commissioned, and no other") {
    const PlantModel plant = plant_of("gen3");
    const RigRecord record = commissioned(plant).record;
    const auto opened = [&](const PlantModel& now, const Connection& motors) {
        MiswiredMachine device(now, {}, motors);
        return proved_again(now, device, record);
    };
    CHECK(opened(plant, {}).refused.empty());
    CHECK_THAT(opened(plant, {}).found, Has(" % at "));
    for (const Connection& motors : all_connections()) {
        CAPTURE(motors.swapped, motors.factor[0], motors.factor[1]);
        CHECK(opened(plant, motors).refused.empty() == (motors == Connection{}));
    }
    PlantModel held = plant;
    held.handle_mass += 0.3;  // a hand rests on it
    CHECK_THAT(opened(held, {}).refused, Has("is somebody holding it"));
}

TEST_CASE("answers that are 5 ms late are found, at first and later, and hide no stronger motor") {
    SEED(2U);
    const PlantModel plant = some_plant(seed);
    const RigRecord record = commissioned(plant).record;
    for (const auto& [late, gain] : {std::pair(3U, 1.0), {3U, 2.0}, {7U, 1.0}, {30U, 2.0}}) {
        CAPTURE(late, gain);
        MiswiredMachine device(plant, {}, {.factor = {gain, gain}});
        device.lag(late);
        const std::string changed = proved_again(plant, device, record).refused;
        const std::string refused = commissioned(plant, device).refused;
        CAPTURE(changed, refused);
        CHECK(changed.empty() == (late == 3 && gain == 1.0));
        CHECK(refused.empty() == (late == 3 && gain == 1.0));
    }
}

TEST_CASE("a pulse in which four ticks came late is given again, and at last refused as late") {
    MiswiredMachine device(plant_of("gen3"), {}, {});
    device.bring(kHome);
    int pulses = 0;
    int spoilt = GENERATE(0, 1, 7, 1000);
    const int late = GENERATE(3, 4);  // ticks, together or apart; three are borne
    const int apart = GENERATE(1, 9);
    int tick = 0;
    bool pushed = false;
    const PlantModel plant = plant_of("gen3");
    PulseRunner runner(
        device, palpate::engine::Machine({.pantograph = plant.machine}), kPeriod, [&] {
            const bool pushes = device.pushes();
            pulses += pushes && !pushed ? 1 : 0;
            tick = pushes ? tick + 1 : 0;
            pushed = pushes;
            const bool is_late = tick >= 20 && tick < 20 + late * apart && (tick - 20) % apart == 0;
            return !is_late || pulses > spoilt;
        });
    const Pulse pulse = runner.give({1.0, 0.0, 0.0}, {.force = 0.3});
    const bool borne = late <= 3 || spoilt < 1000;
    CHECK(pulse.trip == (borne ? Trip::none : Trip::late));
    CHECK(pulse.steady == borne);
    CHECK(pulses == (late <= 3 ? 1 : std::min(spoilt, 12) + 1));
}

TEST_CASE(
    "a device that was opened anew at a mark, and took it for home, is said to have done so") {
    EACH(at, 1, 2, 3);  // both marks, then a place of pulses
    const PlantModel plant = plant_of("gen3");
    const Calibration machine{.pantograph = plant.machine};
    MiswiredMachine device(plant, {}, {});
    int brought = -1;
    const auto bring = [&](const Vec3& place) {
        device.bring(Vec2(place));
        if (++brought == at) {
            device.fall_silent();
        }
        return true;
    };
    const CommissioningResult done =
        commission(device, machine, places_of(plant), Vec3(plant.handle_mass),
                   {.bring = bring, .wait = [] { return true; }, .period = kPeriod});
    CHECK_THAT(done.refused,
               Has("was opened anew while the handle was at (", "it took that for home"));
}

TEST_CASE("marks that do not tell the encoders apart are refused") {
    const PlantModel plant = plant_of("gen3");
    CHECK(separation(plant.machine, commissioning_places(plant.machine, kHome)) > 2.0 * kPlaced);
    MiswiredMachine device(plant, {}, {});
    CHECK_THROWS_WITH(commission(device, {.pantograph = plant.machine},
                                 {Vec3(kHome, 0.0), {0.0, 0.050, 0.0}, {0.0, 0.040, 0.0}},
                                 Vec3(0.06), desk_of(device)),
                      Has("do not tell how the encoders are connected"));
}

TEST_CASE("of the marks of a commissioning the one that tells more alone is kept for openings") {
    for (const char* name : {"gen3", "gen2", "haplet"}) {
        const Calibration machine{.pantograph = plant_of(name).machine};
        const Pantograph linkage(machine.pantograph);
        const auto home = linkage.counts(*linkage.reach(kHome));
        Random random(5);
        int told = 0;
        for (int i = 0; i < 60; ++i) {
            std::vector<Vec3> places{Vec3(kHome, 0.0)};
            while (places.size() < 3) {
                const Vec2 place{random.in(-0.04, 0.04), random.in(0.0, 0.06)};
                if (linkage.reach(place)) {
                    places.emplace_back(place, 0.0);
                }
            }
            CAPTURE(name, i);
            Vec3 mark;
            try {
                mark = second_mark(machine, places);
            } catch (const std::invalid_argument&) {
                continue;
            }
            ++told;
            const auto there = linkage.counts(*linkage.reach(Vec2(mark)));
            const std::array<int, 2> turned{there[0] - home[0], there[1] - home[1]};
            for (unsigned k = 1; k < 8; ++k) {  // exchanged, and each reversed
                Pantograph::Counts said = home;
                for (unsigned joint = 0; joint < 2; ++joint) {
                    said[joint] += ((k >> joint & 1U) != 0 ? -1 : 1) * turned[(k >> 2U) ^ joint];
                }
                const auto fix = linkage.locate(linkage.angles(said));
                CHECK((!fix || glm::length(fix->hip - Vec2(mark)) > 0.0065));
            }
        }
        CHECK(told > 20);
    }
}

#include "engine/device/pantograph.hpp"
#include "protocols/file/calibration_file.hpp"
#include "protocols/file/protocol_file.hpp"
#include "protocols/library/shipped.hpp"
#include "tests/support/placed_lines.hpp"
#include "tests/support/test_text.hpp"

using namespace palpate::protocols;
using namespace palpate::engine;

namespace {

constexpr const char* kPresets[] = {"haplet", "2diy_gen2", "2diy_gen3", "mk2"};

std::string calibration_refusal(const std::string& text) {
    return refusal_of<ProtocolError>([&] { return parse_calibrations(text, "c.toml"); });
}

std::string changed(const std::string& from, const std::string& to) {
    std::string text = to_toml(load_calibration("2diy_gen3"));
    return replaced(text, from, to);
}

Calibration any_calibration(Random& random) {
    Calibration c;
    PantographSpec& machine = c.pantograph;
    machine.name = "machine \"7\"\n";
    machine.linkage = {.driven_1 = random.in(0.03, 0.3),
                       .driven_2 = random.in(0.03, 0.3),
                       .free_1 = random.in(0.03, 0.3),
                       .free_2 = random.in(0.03, 0.3),
                       .base = random.in(0.0, 0.2),
                       .mode = {random.coin(), random.coin(), random.coin()}};
    for (palpate::engine::Axis& axis : machine.axes) {
        axis = {.counts_per_turn = random.decade(2.0, 6.0),
                .zero = random.in(-6.0, 6.0),
                .torque_limit = random.in(0.5, 0.9),
                .torque_forever = random.in(0.1, 0.5),
                .codes_full_scale = std::floor(random.in(100.0, 60000.0))};
    }
    machine.origin = random.point(-0.1, 0.1);
    machine.turn = random.in(-3.0, 3.0);
    if (random.coin()) {
        machine.damping = random.in(0.0, 3.0);
    }
    machine.motor_time = random.in(0.0, 100.0);
    machine.clearance = random.in(1e-4, 1e-2);
    if (random.coin()) {
        c.home = random.point(-0.1, 0.1);
    }
    if (random.coin()) {
        HaplyWiring& wiring = c.haply.emplace();
        wiring.id = static_cast<std::uint8_t>(1 + random.below(255));
        wiring.port = {2, 1};
        wiring.motor_clockwise = {random.coin(), random.coin()};
        wiring.encoder_clockwise = {random.coin(), random.coin()};
        if (random.coin()) {
            wiring.grip_pin = static_cast<std::uint8_t>(54 + random.below(12));
        }
        wiring.grip_threshold = random.in(0.0, 1023.0);
        for (palpate::engine::Axis& axis : machine.axes) {
            axis.torque_limit = random.in(0.1, palpate::engine::kHaplyTorque);
            axis.torque_forever = random.in(0.01, 0.1);
        }
    }
    if (random.coin()) {
        ComediWiring& wiring = c.comedi.emplace();
        wiring.counter_subdevice = static_cast<std::uint32_t>(random.below(9));
        wiring.counter = {3, 0};
        wiring.output = {0, 7};
        wiring.range = static_cast<std::uint32_t>(random.below(4));
        wiring.volts_per_newton_metre = {random.in(1.0, 20.0), random.in(-20.0, -1.0)};
        wiring.counter_clockwise = {random.coin(), random.coin()};
    }
    return c;
}

auto fields_of(const HaplyWiring& w) {
    return std::tie(w.id, w.port, w.motor_clockwise, w.encoder_clockwise, w.grip_pin,
                    w.grip_threshold);
}
auto fields_of(const ComediWiring& w) {
    return std::tie(w.counter_subdevice, w.counter, w.output_subdevice, w.output, w.range,
                    w.volts_per_newton_metre, w.counter_clockwise);
}

}  // namespace

// Link lengths, encoders and golden poses of the hAPI's examples; see pantographs.toml for the
// sources.
TEST_CASE("the machines that ship have the numbers of their makers") {
    struct Golden {
        const char* name;
        double t1, t2, x_mm, y_mm, quantum_um, newton;
    };
    const Golden golden[] = {{"haplet", 150, 30, 10.000000000, 70.375925293, 23, 2.58},
                             {"2diy_gen2", 135, 20, 22.843407242, 103.039951300, 44, 1.76},
                             {"2diy_gen3", 120, 60, 19.0, 132.621778265, 98, 1.83}};
    for (const Golden& g : golden) {
        CAPTURE(g.name);
        const PantographSpec spec = load_calibration(g.name).pantograph;
        const Pantograph machine(spec);
        const auto fix = machine.locate({g.t1 * kPi / 180.0, g.t2 * kPi / 180.0});
        REQUIRE(fix);
        const auto pose = spec.linkage.forward({g.t1 * kPi / 180.0, g.t2 * kPi / 180.0});
        CHECK(std::fabs(pose->handle.x * 1e3 - g.x_mm) < 1e-9);
        CHECK(std::fabs(pose->handle.y * 1e3 - g.y_mm) < 1e-9);
        CHECK(std::fabs(machine.quantum(*fix).largest * 1e6 - g.quantum_um) <= 0.5);
        CHECK(std::fabs(machine.weakest_force(fix->hip).value() - g.newton) <= 0.005);
    }
}

TEST_CASE("the shipped Mk-II is the machine that is simulated without a calibration") {
    Calibration mk2 = load_calibration("mk2");
    const Calibration standard;
    mk2.comedi.reset();
    CHECK(to_toml(mk2) == to_toml(standard));
}

TEST_CASE("every machine that ships reaches the study's whole area, from its rest too") {
    for (const char* name : kPresets) {
        CAPTURE(name);
        const Calibration calibration = load_calibration(name);
        const Pantograph machine(calibration.pantograph);
        // Where the tip of a hand may be: 10 mm into the sides, and the start above the vertex.
        for (int x = -40; x <= 40; x += 5) {
            for (int y = -10; y <= 60; y += 5) {
                CAPTURE(x, y);
                CHECK(machine.reach({x * 1e-3, y * 1e-3}));
            }
        }
        if (calibration.haply) {
            CHECK(calibration.pantograph.linkage.forward(machine.angles({0, 0})));
        }
    }
}

TEST_CASE("a calibration that is written and read is the same, and has the same id") {
    for (std::uint64_t seed = 0; seed < 500; ++seed) {
        Random random(seed);
        CAPTURE(seed);
        const Calibration calibration = any_calibration(random);
        const std::string text = to_toml(calibration);
        const std::vector<Calibration> back = parse_calibrations(text, "c.toml");
        REQUIRE(back.size() == 1);
        CHECK(to_toml(back.front()) == text);
        CHECK(calibration_id(back.front()) == calibration_id(calibration));
        const PantographSpec& a = calibration.pantograph;
        const PantographSpec& b = back.front().pantograph;
        CHECK(a.name == b.name);
        CHECK(a.linkage.mode == b.linkage.mode);
        CHECK(std::fabs(a.axes[0].zero - b.axes[0].zero) <= 1e-15);
        CHECK(std::fabs(a.origin.y - b.origin.y) <= 1e-16);
        CHECK(a.damping == b.damping);
        CHECK(std::fabs(a.turn - b.turn) <= 1e-15);
        CHECK(std::fabs(a.motor_time - b.motor_time) <= 1e-13);
        CHECK(std::fabs(a.linkage.free_2 - b.linkage.free_2) <= 1e-16);
        const Calibration& read = back.front();
        REQUIRE(read.home.has_value() == calibration.home.has_value());
        if (read.home) {
            CHECK(glm::length(*read.home - *calibration.home) <= 1e-16);
        }
        REQUIRE(read.haply.has_value() == calibration.haply.has_value());
        CHECK((!read.haply || fields_of(*read.haply) == fields_of(*calibration.haply)));
        REQUIRE(read.comedi.has_value() == calibration.comedi.has_value());
        CHECK((!read.comedi || fields_of(*read.comedi) == fields_of(*calibration.comedi)));
    }
    const std::string id = calibration_id(load_calibration("mk2"));
    CHECK(id.size() == 64);
    CHECK(id.find_first_not_of("0123456789abcdef") == std::string::npos);
    CHECK(id != calibration_id(load_calibration("haplet")));
}

TEST_CASE("what is wrong with a calibration is said at its place, with the remedy") {
    for (const auto& row : test_rows("calibration_problems.tsv")) {
        CAPTURE(row);
        const std::string said = calibration_refusal(changed(row.at(0), row.at(1)));
        CHECK_THAT(said, Has(row.at(2)) && StartsWith("c.toml:"));
    }
    CHECK_THAT(calibration_refusal("format = 1"), Has("add a [[pantograph]]"));
    CHECK_THAT(calibration_refusal(""), Has("c.toml:1:1:"));
    CHECK_THROWS_WITH(load_calibration("mk3"), Has("haplet, 2diy_gen2, 2diy_gen3, mk2"));
    const std::string two =
        std::string(shipped_pantographs())
            .replace(std::string(shipped_pantographs()).find("2diy_gen2"), 9, "2diy_gen3");
    CHECK_THAT(calibration_refusal(two), Has("two machines are called \"2diy_gen3\""));
}

TEST_CASE("no calibration file, however broken, does more than be refused line by line") {
    int accepted = 0;
    int refused = 0;
    for (std::uint64_t seed = 0; seed < 3000; ++seed) {
        Random random(seed);
        const std::string whole = to_toml(any_calibration(random));
        const std::string text = broken(whole, random, 20);
        CAPTURE(seed, text);
        try {
            for (const Calibration& calibration : parse_calibrations(text, "c.toml")) {
                CHECK_NOTHROW(check(calibration));
                CHECK(parse_calibrations(to_toml(calibration), "again.toml").size() == 1);
            }
            ++accepted;
        } catch (const ProtocolError& error) {
            ++refused;
            check_places(error.what());
        }
    }
    CHECK(accepted > 200);
    CHECK(refused > 1000);
}

TEST_CASE("a calibration file is read by its path, and must hold one machine") {
    const auto folder = std::filesystem::temp_directory_path() / "palpate_calibration_file_test";
    std::filesystem::create_directories(folder);
    const std::string one = (folder / "one.toml").string();
    const std::string all = (folder / "all.toml").string();
    std::ofstream(one) << to_toml(load_calibration("haplet"));
    std::ofstream(all) << shipped_pantographs();
    CHECK(calibration_id(load_calibration(one)) == calibration_id(load_calibration("haplet")));
    CHECK_THROWS_WITH(load_calibration(all), Has("holds 4 machines"));
    std::filesystem::remove_all(folder);
}

#include "engine/device/machine.hpp"
#include "engine/device/pointer_device.hpp"
#include "stimuli/two_curve.hpp"
#include "protocols/session/feasibility.hpp"
#include "protocols/trial/trial_scene.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/scenes.hpp"

using engine::Vec2;
using engine::Vec3;
using namespace palpate::protocols;

namespace {

/// A device with the traits asked for and the force of a machine, or of a disc.
class FakeDevice : public engine::Device {
public:
    engine::DeviceTraits what{};
    const engine::Machine* machine = nullptr;
    double reach = 1.0;             ///< m around the origin
    double force = 100.0;           ///< N within the reach
    std::optional<double> error{};  ///< m, of a reading

    engine::Reading read() noexcept override { return {}; }
    engine::AppliedForce write(const Vec3& /*force*/) noexcept override { return {}; }
    [[nodiscard]] std::string name() const override { return "fake"; }
    [[nodiscard]] engine::DeviceTraits traits() const noexcept override { return what; }
    [[nodiscard]] std::optional<double> weakest_force(const Vec3& hip) const noexcept override {
        if (machine != nullptr) {
            return machine->weakest_force(hip);
        }
        return glm::length(hip) < reach ? std::optional<double>(force) : std::nullopt;
    }
    [[nodiscard]] std::optional<double> reading_error(const Vec3& /*hip*/) const noexcept override {
        return error;
    }
};

Protocol felt_study(double stiffness = 1000.0, double rate_hz = 1000.0) {
    Protocol protocol;
    protocol.objects = {{.name = "concave", .curvature = -10.0},
                        {.name = "convex", .curvature = 10.0}};
    protocol.frictions = {{.name = "off"}};
    protocol.apparatus.stiffness = stiffness;
    protocol.apparatus.rate_hz = rate_hz;
    return protocol;
}

/// What is found, if it is one thing of that kind.
std::string only(Verdict verdict, const std::vector<Finding>& findings) {
    REQUIRE(findings.size() == 1);
    CHECK((findings[0].verdict == verdict));
    return findings[0].text;
}

}  // namespace

TEST_CASE("stiffness is refused just above the passivity bound") {
    // deformation-and-passivity, section 7: b / (T (1/2 + d)) at T = 1 ms.
    struct Row {
        double damping, delay, bound, rate_hz;
    };
    const Row row = GENERATE(Row{0.1, 0.0, 200.0, 1000.0}, Row{0.5, 0.0, 1000.0, 1000.0},
                             Row{2.0, 0.0, 4000.0, 1000.0}, Row{0.5, 1.0, 1000.0 / 3.0, 1000.0},
                             Row{0.125, 0.0, 1000.0, 4000.0});
    CAPTURE(row.damping, row.delay, row.rate_hz);
    FakeDevice device;
    device.what = {.damping = row.damping, .delay_ticks = row.delay};
    CHECK(check_feasibility(felt_study(row.bound, row.rate_hz), device).empty());
    CHECK(check_feasibility(felt_study(0.9 * row.bound, row.rate_hz), device).empty());
    only(Verdict::refuse, check_feasibility(felt_study(1.001 * row.bound, row.rate_hz), device));
}

TEST_CASE("a refusal names the stiffness and the rate that would do, and these are accepted") {
    FakeDevice device;
    device.what = {.damping = 0.4, .delay_ticks = 1.0};
    CHECK(only(Verdict::refuse, check_feasibility(felt_study(), device)) ==
          "the device damps 0.4 N s/m; 1000 N/m at 1000 Hz with one tick of delay needs 1.5 N s/m "
          "at the handle: lower stiffness_n_per_m to 266 or raise rate_hz to 3750");
    CHECK(check_feasibility(felt_study(266.0), device).empty());
    CHECK(check_feasibility(felt_study(1000.0, 3750.0), device).empty());
    CHECK_FALSE(check_feasibility(felt_study(267.0), device).empty());
    CHECK_FALSE(check_feasibility(felt_study(1000.0, 3749.0), device).empty());

    device.what.damping = 0.05;  // 30 kHz would do: no servo runs that
    CHECK_THAT(check_feasibility(felt_study(), device).at(0).text, !Has("rate_hz to"));
    device.what.damping = 0.0;
    CHECK_THAT(check_feasibility(felt_study(), device).at(0).text, Has("some damping"));
}

TEST_CASE("what lets a contact rest is said with the friction it takes and the speed without it") {
    FakeDevice device;
    device.what = {.damping = 1.0};
    CHECK(rest_text(margins_of(felt_study(), device)).empty());  // nobody knows its steps
    device.error = 5e-6;
    CHECK(rest_text(margins_of(felt_study(), device)) ==
          "positions are read to within 5 um: a contact comes to rest if the handle's dry friction "
          "is 0.005 N or more, with less it may creep on, at 10 mm/s at the very most");
    device.what.damping.reset();
    CHECK_THAT(rest_text(margins_of(felt_study(), device)), Catch::EndsWith("it may creep on"));
}

TEST_CASE("a damper of the contact asks as much more of the device") {
    // b >= K T (1/2 + d) + |B|: Colgate & Schenkel 1997.
    FakeDevice device;
    EACH(stiffness, 100.0, 1000.0);
    EACH(damper, 0.05, 0.4);
    EACH(delay, 0.0, 1.0);
    const double bound = stiffness * 1e-3 * (0.5 + delay) + damper;
    Protocol protocol = felt_study(stiffness);
    protocol.apparatus.damping = damper;
    CHECK(engine::Scene(make_scene(protocol, Condition{})).spec().damping == damper);
    device.what = {.damping = bound, .delay_ticks = delay};
    CHECK(check_feasibility(protocol, device).empty());
    device.what.damping = 0.999 * bound;
    only(Verdict::refuse, check_feasibility(protocol, device));
}

TEST_CASE("with a damper too, the stiffness and the rate that a refusal names are accepted") {
    FakeDevice device;
    device.what = {.damping = 0.4, .delay_ticks = 1.0};
    Protocol protocol = felt_study();
    protocol.apparatus.damping = 0.1;
    CHECK(check_feasibility(protocol, device).at(0).text ==
          "the device damps 0.4 N s/m; 1000 N/m with a damper of 0.1 N s/m at 1000 Hz with one "
          "tick of delay needs 1.6 N s/m at the handle: lower stiffness_n_per_m to 200 or raise "
          "rate_hz to 5000");
    protocol.apparatus.stiffness = 200.0;
    CHECK(check_feasibility(protocol, device).empty());
    protocol.apparatus.stiffness = 1000.0;
    protocol.apparatus.rate_hz = 5000.0;
    CHECK(check_feasibility(protocol, device).empty());
    protocol.apparatus.damping = 0.4;  // leaves nothing for a spring
    CHECK_THAT(check_feasibility(protocol, device).at(0).text,
               Has("lower damping_n_s_per_m") && !Has("rate_hz to"));
}

TEST_CASE("an unknown damping is a warning with the damping needed") {
    FakeDevice device;
    CHECK_THAT(only(Verdict::warn, check_feasibility(felt_study(), device)),
               Has("needs 0.5 N s/m"));
}

TEST_CASE("a device that gives no force can render everything") {
    const engine::PointerDevice mouse;
    CHECK(check_feasibility(felt_study(1e5), mouse).empty());
}

TEST_CASE("an object or a start pose out of reach is refused with the point") {
    FakeDevice device;
    device.what.damping = 1.0;
    device.force = 20.0;
    device.reach = 0.1;
    CHECK(check_feasibility(felt_study(), device).empty());

    device.reach = 0.05;  // the object reaches to 40 mm and a bulge, the start pose is at 60 mm
    CHECK_THAT(only(Verdict::refuse, check_feasibility(felt_study(), device)),
               Has("start pose (0.0, 60.0) mm"));

    device.reach = 0.0399;  // A, V and B are 40 mm away
    const auto findings = check_feasibility(felt_study(), device);
    REQUIRE(findings.size() == 2);
    CHECK((findings[0].verdict == Verdict::refuse));
    CHECK_THAT(findings[0].text, Has("(-40.0, 0.0) mm", "\"concave\""));
}

TEST_CASE("a machine that reaches nothing of a study is refused, in the plane and in space") {
    engine::Calibration small;  // its lengths were given in metres
    engine::FiveBar& links = small.pantograph.linkage;
    for (double* length :
         {&links.driven_1, &links.driven_2, &links.free_1, &links.free_2, &links.base}) {
        *length *= 1e-3;
    }
    engine::Calibration high;
    for (engine::StraightAxis& axis : high.gantry.emplace().axes) {
        axis.low = 0.045;
        axis.high = 0.12;
        axis.home = 0.1;
    }
    const bool space = GENERATE(false, true);
    Protocol protocol = felt_study();
    if (space) {
        protocol.surface.emplace();
    }
    const engine::Machine machine(space ? high : small);
    FakeDevice device;
    device.what.damping = 1.0;
    device.machine = &machine;
    const auto findings = check_feasibility(protocol, device);
    REQUIRE(findings.size() == 2);
    CHECK((findings[0].verdict == Verdict::refuse));
    CHECK_THAT(findings[0].text, Has("cannot reach (", space ? "home_mm" : "origin_mm"));
    CHECK((findings[1].verdict == Verdict::refuse));
    CHECK_THAT(findings[1].text, Has("cannot reach the start pose"));
}

TEST_CASE("a weak device is a warning that says from where on the force clips") {
    FakeDevice device;
    device.what.damping = 1.0;
    device.reach = 1.0;
    device.force = 4.0;
    CHECK_THAT(only(Verdict::warn, check_feasibility(felt_study(500.0), device)),
               Has("gives 4 N", "a depth of 8 mm", "force_limit_n = 10"));
    device.force = 0.001239;  // 0 would be no limit
    CHECK_THAT(only(Verdict::warn, check_feasibility(felt_study(500.0), device)),
               Has("and force_limit_n = 0.00123 would"));
    device.force = 10.0;
    CHECK(check_feasibility(felt_study(500.0), device).empty());
}

TEST_CASE("the weakest point of a pantograph is found on the outline") {
    const engine::Machine pantograph{engine::Calibration{}};
    FakeDevice device;
    device.what.damping = 1.0;
    device.machine = &pantograph;
    Protocol protocol = felt_study();
    // By hand: the least over both outlines, walked as polylines of 20 um.
    double least = 1e9;
    for (const ObjectSpec& object : protocol.objects) {
        const auto points = stimuli::silhouette({.curvature = object.curvature}, 1e-7);
        for (std::size_t i = 0; i < points.size(); ++i) {
            const Vec2 next = points[(i + 1) % points.size()];
            for (int k = 0; k < 100; ++k) {
                const auto force = pantograph.weakest_force(
                    Vec3(points[i] + (next - points[i]) * (k / 100.0), 0.0));
                REQUIRE(force.has_value());
                least = std::min(least, *force);
            }
        }
    }
    protocol.apparatus.force_limit = 0.99 * least;
    CHECK(check_feasibility(protocol, device).empty());
    protocol.apparatus.force_limit = 1.01 * least;
    only(Verdict::warn, check_feasibility(protocol, device));
}

#include "engine/contact/closest_point.hpp"
#include "protocols/design/object_outline.hpp"
#include "protocols/trial/start_gate.hpp"
#include "tests/support/random.hpp"
#include "tests/support/short_text.hpp"

using namespace palpate::protocols;

namespace {

Protocol shipped(std::string_view name) {
    return parse_protocol(tests::short_text(name, {}), name);
}

/// Within `reach` of the start, in each direction.
engine::Vec3 near(const StartGate& gate, tests::Random& random, double reach) {
    const auto off = [&] {
        return random.in(-reach, reach);
    };
    const double x = off();
    const double y = off();
    return gate.start() + engine::Vec3{x, y, gate.in_space() ? off() : 0.0};
}

}  // namespace

TEST_CASE("a trial begins within the radius of the start, and nowhere without a place",
          "[gate][law]") {
    const StartGate gate(shipped(GENERATE("shape_friction", "patch_friction")));
    CHECK(gate.lets_begin(gate.start()));
    tests::Random random(3);
    for (int i = 0; i < 400; ++i) {
        const engine::Vec3 place = near(gate, random, 2.0 * gate.radius());
        if (glm::length(place - gate.start()) > gate.radius()) {
            CHECK_FALSE(gate.lets_begin(place));
        }
    }
    for (const double none : {std::nan(""), std::numeric_limits<double>::infinity()}) {
        CHECK_FALSE(gate.lets_begin({none, gate.start().y, gate.start().z}));
    }
}

TEST_CASE("inside of any object of the study no trial begins, however wide the gate",
          "[gate][law]") {
    Protocol protocol = shipped(GENERATE("shape_friction", "patch_friction"));
    protocol.apparatus.start_radius = 0.060;
    const StartGate gate(protocol);
    tests::Random random(5);
    int inside = 0;
    for (std::size_t i = 0; i < protocol.objects.size(); ++i) {
        for (int k = 0; k < 300; ++k) {
            const engine::Vec3 place = near(gate, random, gate.radius());
            const bool in_object =
                protocol.surface ? engine::SurfaceFeet(surface_of(protocol, protocol.objects[i]))
                                       .closest(place)
                                       .inside
                                 : engine::OutlineFeet(*outline_of(protocol, i))
                                       .closest(engine::Vec2(place))
                                       .inside;
            inside += in_object ? 1 : 0;
            if (in_object) {
                CHECK_FALSE(gate.lets_begin(place));
            }
        }
    }
    CHECK(inside > 20);
}

TEST_CASE("a gate that a protocol leaves out is open everywhere", "[gate][law]") {
    Protocol protocol = shipped("shape_friction");
    protocol.apparatus.start_radius = 0.0;
    CHECK(StartGate(protocol).lets_begin({std::nan(""), 1.0, 0.0}));
    CHECK(StartGate().lets_begin({0.0, -1.0, 0.0}));
}

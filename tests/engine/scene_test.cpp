#include "engine/rendering/scene.hpp"
#include "stimuli/two_curve.hpp"
#include "tests/support/allocations.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/outlines.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

namespace {

constexpr double kCurvatures[] = {-10.0, -5.0, 0.0, 5.0, 10.0};

Scene scene_of(double curvature, const Friction& friction, const Slew& slew) {
    return {stimuli::make_outline({.curvature = curvature}), {.friction = friction, .slew = slew}};
}

/// Over and into the whole object, at hand speed.
std::vector<Vec2> scene_hand(std::uint64_t seed) {
    return random_hand(seed, 4000, {-0.045, -0.004}, {0.045, 0.046});
}

}  // namespace

TEST_CASE("the force is zero on every tick outside the object") {
    SEED(std::uint64_t{8});
    for (const double kappa : kCurvatures) {
        for (const Friction& friction : {Friction{}, kStudyFriction}) {
            const Scene scene = scene_of(kappa, friction, kStudySlew);
            const OutlineFeet feet(scene.outline());
            ContactState state;
            bool was_inside = false;
            for (const Vec2& h : scene_hand(seed)) {
                const Contact contact = scene.tick(state, h);
                const bool inside = feet.closest(h).inside;
                // A sliding contact may still hold for the tick in which HIP leaves over another
                // side.
                if (!inside && !was_inside) {
                    REQUIRE(contact.mode == Mode::free);
                }
                if (contact.mode == Mode::free) {
                    REQUIRE(contact.force == Vec2{});
                }
                was_inside = inside || contact.mode != Mode::free;
            }
        }
    }
}

TEST_CASE("a tick allocates nothing") {
    for (const Friction& friction : {Friction{}, kStudyFriction}) {
        const Scene scene = scene_of(-5.0, friction, kStudySlew);
        const std::vector<Vec2> path = scene_hand(7);
        ContactState state;
        const std::size_t before = allocations();
        for (const Vec2& h : path) {
            static_cast<void>(scene.tick(state, h));
        }
        CHECK(allocations() == before);
    }
}

TEST_CASE("a scene refuses values out of range, with the value and the remedy") {
    const auto outline = stimuli::make_outline({});
    const auto refusal = [&](const SceneSpec& spec) {
        return refusal_of<std::invalid_argument>([&] { return Scene(outline, spec); });
    };
    CHECK_THAT(refusal({.stiffness = 0.0}), Has("stiffness is 0:", "above 0"));
    CHECK_THAT(refusal({.period = -0.001}), Has("period"));
    CHECK_THAT(refusal({.friction = {.mu_s = 0.4, .mu_d = 0.5}}),
               Has("mu_s is 0.4", "not below mu_d"));
    CHECK_THAT(refusal({.friction = {.mu_s = 0.4, .mu_d = -0.5}}), Has("mu_d is -0.5"));
    CHECK_THAT(refusal({.slew = {.speed = 0.2, .radius = 0.0}}), Has("vertex radius"));
    CHECK(refusal({}) == "accepted");
}

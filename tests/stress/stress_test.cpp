#include <cstring>

#include "tests/stress/stress_run.hpp"
#include "tests/support/catch.hpp"

using namespace palpate;
using namespace palpate::stress;

TEST_CASE("every tick of random hands in random scenes holds every law", "[stress][law]") {
    // palpate_stress goes on where this slice ends.
    const auto slice = GENERATE(range(0U, 8U));
    Tally tally;
    for (std::uint64_t i = 0; i < 50; ++i) {
        const std::uint64_t seed = 1 + 50 * slice + i;
        const auto c = random_case(seed, Mood::gentle);
        if (!c) {
            continue;
        }
        const auto breach = feel(*c, tally, false);
        CAPTURE(seed, breach ? breach->tick : 0, breach ? breach->value : 0.0,
                breach ? breach->limit : 0.0);
        CHECK((breach ? breach->law : "") == "");
    }
    CHECK(tally.in_contact > 2000);
}

TEST_CASE("a scene written for `palpate render` is the scene, to the bit", "[stress]") {
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        const auto c = random_case(seed, Mood::wild);
        if (!c) {
            continue;
        }
        CAPTURE(seed);
        const protocols::SceneFile read =
            protocols::parse_scene(scene_text(c->scene), "scene.toml");
        const auto& law = c->scene.friction;
        CHECK(read.friction.law == law.law);
        CHECK(read.friction.set.mu_s == law.set.mu_s);
        CHECK(read.friction.set.tau_slip == law.set.tau_slip);
        CHECK(read.friction.slew.radius == law.slew.radius);
        CHECK(read.renderer.stiffness == c->scene.renderer.stiffness);
        const engine::Outline outline = protocols::outline_of(read);
        REQUIRE(outline.spans().size() == c->outline->spans().size());
        for (std::size_t i = 0; i < outline.spans().size(); ++i) {
            const engine::Vec2 a = outline.spans()[i].at(0.3).point;
            const engine::Vec2 b = c->outline->spans()[i].at(0.3).point;
            CHECK(std::memcmp(&a, &b, sizeof a) == 0);
        }
    }
}

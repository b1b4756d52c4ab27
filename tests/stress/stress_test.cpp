#include "tests/stress/held.hpp"

using namespace palpate::stress;

TEST_CASE("every tick of random hands in random scenes holds every law") {
    // palpate_stress goes on where this slice ends.
    const auto slice = GENERATE(range(0U, 8U));
    Tally tally;
    for (std::uint64_t i = 0; i < 50; ++i) {
        const std::uint64_t seed = 1 + 50 * slice + i;
        if (const auto c = random_case(seed, Mood::gentle)) {
            holds(*c, seed, tally);
        }
    }
    CHECK(tally.in_contact > 2000);
    CHECK(tally.walks > 1000);
}

TEST_CASE(
    "the god-object finds the first root at cusps, under heavy weights and however far a hand "
    "leaps") {
    const auto mood = GENERATE(Mood::wild, Mood::study, Mood::cusp, Mood::huge);
    CAPTURE(kMoods.at(static_cast<std::size_t>(mood)));
    Tally tally;
    for (std::uint64_t seed = 1; seed <= 25; ++seed) {
        if (const auto c = random_case(seed, mood)) {
            holds(*c, seed, tally);
        }
    }
    CHECK(tally.walks > 1000);
}

TEST_CASE("where doubles do not tell, and where an excess does not fall, the first root is found") {
    Tally tally;
    // Broken without the second search in twice the digits (205 to 1178), or where Newton's
    // iteration goes on without a proof (209 to 868).
    for (const std::uint64_t seed : {205U, 323U, 913U, 1178U, 209U, 640U, 655U, 868U}) {
        const auto c = random_case(seed, Mood::wild);
        REQUIRE(c);
        holds(*c, seed, tally);
    }
}

TEST_CASE("scenes in which long runs once found a law broken hold every law") {
    struct Found {
        Mood mood;
        std::uint64_t seed;
    };
    // A smooth seam whose two sides each drive the god-object to the other (the first four); a
    // first root beside a centre of curvature, a walk between heavy weights, a slip that ended
    // within its cone; a hand that went exactly as far as it was away, to the last digit, and was
    // not looked at; closest points beside ends a million times lighter than what follows. And
    // three where the law asked for more than doubles can tell. In the last two a damped hand comes
    // back to the very tip of a vertex.
    const auto found =
        GENERATE(Found{Mood::gentle, 35147}, Found{Mood::gentle, 42317}, Found{Mood::wild, 3031},
                 Found{Mood::wild, 5906}, Found{Mood::gentle, 40863}, Found{Mood::wild, 5496},
                 Found{Mood::wild, 5858}, Found{Mood::wild, 535867}, Found{Mood::wild, 153931},
                 Found{Mood::wild, 183958}, Found{Mood::wild, 460350}, Found{Mood::wild, 466979},
                 Found{Mood::wild, 470164}, Found{Mood::huge, 300}, Found{Mood::huge, 1009});
    const auto c = random_case(found.seed, found.mood);
    REQUIRE(c);
    Tally tally;
    holds(*c, found.seed, tally);
}

TEST_CASE("surfaces on which the god-object was once left outside of its cone hold every law") {
    // Found by palpate_stress: narrow valleys next to centres of curvature, borders met at a slant,
    // poles, sheets that fold back, lie on themselves or run away, rises before the cone, weights
    // of 1e-3 to 1e3, a flow that passes within a hundredth of the load of what is no foot, an edge
    // just before the cone and just beyond a step.
    Tally tally;
    for (const std::uint64_t seed :
         {72U, 91U, 131U, 221U, 350U, 352U, 441U, 554U, 561U, 9800243U}) {
        holds(random_surface_case(seed, Mood::gentle), seed, tally);
    }
    for (const std::uint64_t seed : {20U, 25U, 59U, 82U, 117U, 127U, 167U, 187U, 239U, 348U, 4023U,
                                     4733U, 30127U, 10250140U, 14100063U}) {
        holds(random_surface_case(seed, Mood::wild), seed, tally);
    }
    // A foot that came to rest only in the tick after; a corner that a pole shares, and a crease of
    // which one side carries, where the god-object went from side to side.
    // On the last flows part a thousandfold on a ring of 3 m, the hand is 650 m away, and steps that
    // erred by a share of that ended 4.2e-6 m off.
    for (const std::uint64_t seed : {10180U, 13275U, 20674U, 1'032'180U}) {
        const auto c = random_patches_case(seed, Mood::wild);
        REQUIRE(c);
        const std::uint64_t before = tally.walks;
        holds(*c, seed, tally);
        CHECK((seed != 1'032'180U || tally.walks > before + 50));
    }
}

TEST_CASE("a scene written for `palpate render` is the scene, to the bit") {
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        const auto c = random_case(seed, Mood::wild);
        if (!c) {
            continue;
        }
        CAPTURE(seed);
        const protocols::SceneFile read =
            protocols::parse_scene(scene_text(c->scene), "scene.toml", protocols::Crossings::taken);
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

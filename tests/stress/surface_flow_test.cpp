#include "tests/stress/exact_flow.hpp"
#include "tests/stress/held.hpp"
#include "tests/support/surface_cuts.hpp"
#include "tests/support/test_text.hpp"

using namespace palpate::stress;
using engine::Vec3;

namespace {

/// A surface whose tangents change fast (tests/texts/steep_surface.tsv).
SurfaceData steep_surface() {
    SurfaceData d{.degree_u = 3,
                  .degree_v = 2,
                  .knots_u = {0, 0, 0, 0, 1, 2, 3, 3, 3, 3},
                  .knots_v = {0, 0, 0, 1, 2, 2, 2}};
    d.points.resize(6);
    d.weights.resize(6);
    for (std::size_t i = 0; const auto& row : test_rows("steep_surface.tsv")) {
        d.points.at(i / 4).push_back(
            {std::stod(row.at(0)), std::stod(row.at(1)), std::stod(row.at(2))});
        d.weights.at(i++ / 4).push_back(std::stod(row.at(3)));
    }
    return d;
}

engine::SurfaceScene scene_with(const std::vector<SurfaceData>& pieces,
                                const engine::SceneSpec& spec) {
    return {tests::made(pieces), engine::SurfaceSceneSpec{.contact = spec}};
}

/// How far the forces on a whole surface and on the same cut along u differ beyond 1e-10 of the
/// size, as a share of the largest, until a tick says that it is not proven.
double cut_differs(const SurfaceCase& c, double share, std::size_t& compared) {
    const auto& knots = c.data.knots_u;
    const double cut = knots.front() + share * (knots.back() - knots.front());
    const auto halves = tests::cut_u(c.data, cut);
    const engine::SurfaceScene whole = scene_with({c.data}, c.spec);
    const engine::SurfaceScene two = scene_with({halves.first, halves.second}, c.spec);
    engine::SurfaceState a;
    engine::SurfaceState b;
    double largest = 0.0;
    double worst = 0.0;
    for (const Vec3& h : c.path) {
        if (a.touching) {  // each tick begins at the same place, or last bits decide who slips
            const double u = whole.object().u_of(a.place);
            const std::size_t half = u <= cut ? 0 : 1;
            b.place = two.surface(half).place_of(u, whole.object().v_of(a.place));
            b.place.surface = half;
        }
        b.touching = a.touching;
        b.theta = a.theta;
        const auto x = whole.tick(a, h);
        const auto y = two.tick(b, h);
        const auto proven = [](const engine::SurfaceContact& t) {
            return t.settled && t.on_flow && t.cp.proven;
        };
        if (!proven(x) || !proven(y)) {
            break;
        }
        compared += x.mode == engine::Mode::slip ? 1U : 0U;
        largest = std::max({largest, glm::length(x.force), glm::length(y.force)});
        const double rounding =
            c.spec.stiffness * (1e-10 * c.surface->size() + 1e-11 * glm::length(h));
        worst = std::max(worst, glm::length(x.force - y.force) - rounding);
    }
    return largest > 0.0 ? worst / largest : 0.0;
}

/// Ticks in which a god-object slid under friction, and those of them that say that their way is
/// not proven.
struct Slides {
    std::size_t all = 0;
    std::size_t unproven = 0;

    void add(const SurfaceCase& c) {
        const engine::SurfaceScene scene(surfaces_of(c),
                                         engine::SurfaceSceneSpec{.contact = c.spec});
        engine::SurfaceState state;
        for (const Vec3& h : c.path) {
            const engine::SurfaceContact contact = scene.tick(state, h);
            const bool slid = contact.mode == engine::Mode::slip;
            all += slid ? 1U : 0U;
            unproven += slid && !(contact.on_flow && contact.settled) ? 1U : 0U;
        }
    }
};

}  // namespace

TEST_CASE("a slide ends at the first place of its flow in the cone, where tangents change fast") {
    const SurfaceData steep = steep_surface();
    const engine::SurfaceObject object(tests::made(std::vector{steep}));
    const std::vector<tests::SurfaceOracle> oracles{tests::SurfaceOracle(steep)};
    const double mu = 1.0387081324726017;
    const Vec3 hand{0.0073534583185892333, -0.022385793048285869, 0.006215761193400407};
    engine::SurfacePlace from = object.surface(0).place_of(2.4120810303570717, 0.3035112498670674);
    // RK4 in 25 digits: 1.57 mm before a later place in the cone, at which walks in steps once
    // ended.
    const auto slide = engine::slide_on_surface(object, from, hand - object.origin(), mu);
    const Vec3 later{0.011428080114877151, -0.019931800885345352, 0.0086226613129266189};
    CHECK(std::fabs(glm::length(slide.point + object.origin() - later) - 1.57e-3) < 0.005e-3);
    CHECK(slide.on_flow);
    CHECK(slide.settled);
    const FlowEnd end = ExactFlow(object, oracles).end(from, hand, mu);
    REQUIRE(end.kind == FlowEnd::Kind::cone);
    CHECK(tests::length(end.point - tests::Long3(slide.point + object.origin())) <
          1e-10 * object.size());
}

TEST_CASE("the end of a flow on a plane is the straight way to the cone") {
    // The oracle itself: h is 3 mm under a plane and 10 mm away; the cone of mu 0.5 is 1.5 mm wide.
    const SurfaceData flat = tests::plane(0.1);
    const engine::SurfaceObject object(tests::made(std::vector{flat}));
    const std::vector<tests::SurfaceOracle> oracles{tests::SurfaceOracle(flat)};
    const Vec3 on = object.surface(0).at(0.5, 0.5).point;
    const Vec3 normal = object.surface(0).normal(0.5, 0.5);
    const auto jet = object.surface(0).at(0.5, 0.5);
    const Vec3 side = jet.du / glm::length(jet.du);
    const Vec3 hand = on - 3e-3 * normal + 10e-3 * side;
    const FlowEnd end =
        ExactFlow(object, oracles).end(object.surface(0).place_of(0.5, 0.5), hand, 0.5L);
    REQUIRE(end.kind == FlowEnd::Kind::cone);
    CHECK(tests::length(end.point - tests::Long3(on + 8.5e-3 * side)) < 1e-15);
    CHECK(std::fabs(static_cast<double>(end.way) - 8.5e-3) < 1e-15);
}

TEST_CASE("a surface cut in two feels as the whole one") {
    std::size_t compared = 0;
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        const SurfaceCase c = random_surface_case(seed, Mood::gentle);
        if (c.spec.friction.none()) {
            continue;
        }
        CAPTURE(seed);
        CHECK(cut_differs(c, 0.37, compared) < 1e-9);
    }
    CHECK(compared > 200);
}

TEST_CASE("every tick of random hands over random surfaces, whole or in pieces, holds every law") {
    Tally tally;
    const auto hold = [&](std::uint64_t first, unsigned count, Mood mood, bool whole, bool pieces) {
        for (std::uint64_t seed = first; seed < first + tests::cases(count); ++seed) {
            if (whole) {
                holds(random_surface_case(seed, mood), seed, tally);
            }
            const auto c = pieces ? random_patches_case(seed, mood) : std::nullopt;
            if (c) {
                holds(*c, seed, tally);
            }
        }
    };
    SECTION("whole ones") {
        hold(1, 60, Mood::gentle, true, false);
        CHECK(tally.in_contact > tests::cases(2000U));
    }
    SECTION("in pieces") {
        hold(1, 40, Mood::gentle, false, true);
        hold(1, 40, Mood::wild, false, true);
        CHECK(tally.in_contact > tests::cases(5000U));
    }
    SECTION("slides end where their flow first meets the cone") {
        hold(1001, 30, Mood::gentle, true, true);
        hold(1001, 30, Mood::wild, true, true);
        CHECK(tally.walks > tests::cases(4000U));
        CHECK(tally.ties < tally.walks / 1000);
    }
}

TEST_CASE("of two hundred gentle slides under friction at most three are unproven") {
    // Counted here: 37 of 4,147 on whole surfaces, 39 of 3,870 on joined ones (1 %). In seeds 1 to
    // 300 they are 346 of 16,504 (2.1 %), 80 of them in one scene.
    Slides whole;
    Slides joined;
    for (std::uint64_t seed = 1; seed <= 150; ++seed) {
        const SurfaceCase c = random_surface_case(seed, Mood::gentle);
        if (c.spec.friction.none()) {
            continue;
        }
        whole.add(c);
        if (const auto pieces = random_patches_case(seed, Mood::gentle)) {
            joined.add(*pieces);
        }
    }
    CAPTURE(whole.all, whole.unproven, joined.all, joined.unproven);
    CHECK(whole.all > 3000);
    CHECK(joined.all > 3000);
    CHECK(200 * whole.unproven <= 3 * whole.all);
    CHECK(200 * joined.unproven <= 3 * joined.all);
}

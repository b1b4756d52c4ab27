#include "tests/stress/exact_flow.hpp"
#include "tests/stress/held.hpp"
#include "tests/support/surface_cuts.hpp"

using namespace palpate::stress;
using engine::Vec3;

namespace {

/// Weights from 0.013 to 98, so that the tangents change fast.
const SurfaceData kSteep{
    .degree_u = 3,
    .degree_v = 2,
    .knots_u = {0, 0, 0, 0, 1, 2, 3, 3, 3, 3},
    .knots_v = {0, 0, 0, 1, 2, 2, 2},
    .points = {{{-0.04857598689864187, -0.049275492526854626, 0.005815200554451533},
                {-0.04932249603359027, -0.018123368842973758, -0.010558221305412925},
                {-0.05013611285083556, 0.014577933228617614, -0.008363983705512223},
                {-0.04849697792042292, 0.04769845054968117, -0.00436491881974809}},
               {{-0.028412124960866612, -0.0510548991172016, 0.008147071883529072},
                {-0.030930859869074654, -0.018987830167163534, -0.0008421361364011771},
                {-0.028950678530122627, 0.01592275036013353, -0.005301127098357999},
                {-0.029074515566433944, 0.0492702322685687, 0.0030532274575486955}},
               {{-0.008735429106112906, -0.05041167721376354, 0.006609404758286478},
                {-0.011152497423004901, -0.01806397740216323, 0.009209439811708832},
                {-0.011075478636387895, 0.01682539050675204, 0.006387961401167212},
                {-0.010086987283929809, 0.050594192338374526, 0.0041273574595812774}},
               {{0.009447018315638041, -0.04973973497258501, 0.01077939533142874},
                {0.009469409708265535, -0.01719761340749584, 0.011745540959752904},
                {0.010120804870465612, 0.015289723679256335, 0.005129405815353358},
                {0.010338044540009106, 0.04910007046241529, -0.010951309310401548}},
               {{0.028517906120496234, -0.04878393130489662, 0.007186900411110336},
                {0.03031475983018827, -0.01733487286766894, -0.004301529879489382},
                {0.02915827029143214, 0.01581833847658869, 0.007476361726397776},
                {0.03131121060642471, 0.04944700796820754, -0.005286311523568556}},
               {{0.05050910876652237, -0.04904372425415448, -0.0009414560821021604},
                {0.04878238170923561, -0.017698385748651593, 0.00177294590438116},
                {0.04957120930569613, 0.01608077060222262, -0.001731138918817111},
                {0.05085670377333027, 0.04944941260153611, -0.0001958258558848614}}},
    .weights = {{50.93310160248601, 0.014906168992613933, 64.61259948302315, 0.20220208352854502},
                {0.12562396479252372, 0.07906006964481033, 0.01377966173827021, 4.717631232857112},
                {0.5095618101879091, 97.99495927539454, 0.491083635795728, 0.02099440839223763},
                {0.028272043605888038, 49.09786834681397, 0.01410139903622381, 24.798089754256647},
                {0.2928893319577873, 6.475386143000591, 0.013016151252759145, 0.2182713273998408},
                {6.134882742150974, 0.4235046554704425, 0.416094114915074, 24.53832525806645}}};

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

TEST_CASE("a slide ends at the first place of its flow in the cone, where tangents change fast",
          "[stress][surface][law]") {
    const engine::SurfaceObject object(tests::made(std::vector{kSteep}));
    const std::vector<tests::SurfaceOracle> oracles{tests::SurfaceOracle(kSteep)};
    const double mu = 1.0387081324726017;
    const Vec3 hand{0.0073534583185892333, -0.022385793048285869, 0.006215761193400407};
    engine::SurfacePlace from = object.surface(0).place_of(2.4120810303570717, 0.3035112498670674);
    // RK4 in 25 digits: 1.57 mm before a later place in the cone, at which walks in steps once
    // ended.
    const auto slide = engine::slide_on_surface<true>(object, from, hand - object.origin(), mu);
    const Vec3 later{0.011428080114877151, -0.019931800885345352, 0.0086226613129266189};
    CHECK(std::fabs(glm::length(slide.point + object.origin() - later) - 1.57e-3) < 0.005e-3);
    CHECK(slide.on_flow);
    CHECK(slide.settled);
    const FlowEnd end = ExactFlow(object, oracles).end(from, hand, mu);
    REQUIRE(end.kind == FlowEnd::Kind::cone);
    CHECK(tests::length(tests::minus(end.point, slide.point + object.origin())) <
          1e-10 * object.size());
}

TEST_CASE("the end of a flow on a plane is the straight way to the cone", "[stress][surface]") {
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
    CHECK(tests::length(tests::minus(end.point, on + 8.5e-3 * side)) < 1e-15);
    CHECK(std::fabs(static_cast<double>(end.way) - 8.5e-3) < 1e-15);
}

TEST_CASE("a surface cut in two feels as the whole one", "[stress][surface][law]") {
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

TEST_CASE("slides over random surfaces end where their flow first meets the cone",
          "[stress][surface][law]") {
    Tally tally;
    for (const auto mood : {Mood::gentle, Mood::wild}) {
        for (std::uint64_t seed = 1001; seed < 1001 + tests::cases(30U); ++seed) {
            holds(random_surface_case(seed, mood), seed, tally);
            if (const auto c = random_patches_case(seed, mood)) {
                holds(*c, seed, tally);
            }
        }
    }
    CHECK(tally.walks > tests::cases(4000U));
    CHECK(tally.ties < tally.walks / 1000);
}

TEST_CASE("a slide under a hand hundreds of sizes away ends where its flow first meets the cone",
          "[stress][surface][law]") {
    // Found by palpate_stress: flows part a thousandfold on a ring of 3 m, the hand is 650 m away,
    // and steps that erred by a share of that ended 4.2e-6 m off.
    const auto c = random_patches_case(1'032'180, Mood::wild);
    REQUIRE(c);
    Tally tally;
    holds(*c, c->seed, tally);
    CHECK(tally.walks > 50);
}

TEST_CASE("of two hundred gentle slides under friction at most three are unproven",
          "[stress][surface][law]") {
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

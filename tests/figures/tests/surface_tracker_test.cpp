#include "engine/surface/surface_closest.hpp"
#include "tests/figures/thesis/surface_tracker.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/surface_cuts.hpp"
#include "tests/support/surface_scenes.hpp"

using namespace palpate::engine;
using namespace palpate::figures;
using Catch::Matchers::Contains;

namespace {

constexpr double kTrackTick = 1e-3;

std::shared_ptr<const SurfaceObject> object_of(const std::vector<SurfaceData>& pieces) {
    return std::make_shared<const SurfaceObject>(made(pieces));
}

}  // namespace

TEST_CASE(
    "outside of a box the thesis' tracker comes to rest on its closest point, over edges and "
    "corners") {
    SEEDED(random, std::uint64_t{8});
    const Vec3 half{random.in(0.02, 0.04), random.in(0.02, 0.04), random.in(0.02, 0.04)};
    const auto box = object_of(box_sides(half, random));
    const TrackerSpec spec{.kind = seed % 2U == 0U ? TrackerKind::feedback : TrackerKind::newton,
                           .gain = feedback_gain(*box, 1.0, kTrackTick)};
    const SurfaceTracker tracker(box, spec);
    SurfaceTrackerState state = tracker.start(Vec3{0.0, 0.0, 0.08});
    Vec3 h{0.0, 0.0, 0.08};
    for (int k = 0; k < 40; ++k) {  // round it, for on its other side the tracker stays where it is
        const Vec3 to = glm::normalize(Vec3{random.in(-1, 1), random.in(-1, 1), random.in(-1, 1)});
        TrackedSpot spot;
        for (int tick = 0; tick < 400; ++tick) {
            h = tick < 200 ? 0.08 * glm::normalize(h + 0.0016 * glm::normalize(to - h)) : h;
            spot = tracker.step(state, h, kTrackTick);
        }
        const Vec3 out = glm::max(glm::abs(h) - half, Vec3{});
        REQUIRE(glm::length(out) > 0.0);
        REQUIRE(std::fabs(spot.distance - glm::length(out)) < 1e-12);
    }
    CHECK(state.switches > 40);
}

TEST_CASE(
    "over joined surfaces the thesis' tracker lags behind a hand by what its gain says, and "
    "Newton's hardly") {
    SEEDED(random, std::uint64_t{6});
    const SurfaceData whole = bicubic_8x8(random, 0.0);
    const auto four = object_of(quarters(whole, 2.4, 2.7, random));
    const SurfaceFeet feet(four);
    const auto path = surface_hand(make_surface(whole), seed, 3000, 0.002, 0.2);
    const auto worst = [&](const TrackerSpec& spec) {
        const SurfaceTracker tracker(four, spec);
        SurfaceTrackerState state = tracker.start(path[0]);
        SurfaceTrack track;
        double max = 0.0;
        for (std::size_t k = 0; k < path.size(); ++k) {
            const TrackedSpot spot = tracker.step(state, path[k], kTrackTick);
            const SurfaceClosest exact = feet.track(track, path[k]);
            REQUIRE(spot.distance >= exact.distance - 1e-15);
            max = k < 100 ? 0.0 : std::max(max, spot.distance - exact.distance);
        }
        CHECK(state.switches > 0);
        return max;
    };
    const double kappa = feedback_gain(*four, 1.0, kTrackTick);
    const double slow = worst({.kind = TrackerKind::feedback, .gain = 0.1 * kappa});
    const double best = worst({.kind = TrackerKind::feedback, .gain = kappa});
    const double newton = worst({.kind = TrackerKind::newton, .iterations = 3});
    CHECK(slow > 1e-5);
    CHECK(best < 0.5 * slow);
    CHECK(newton < 1e-9);
}

TEST_CASE("a surface's tracker refuses what it does not have") {
    const auto sheet = object_of({plane(0.05)});
    const auto with = [&](const TrackerSpec& spec) {
        return SurfaceTracker(sheet, spec);
    };
    CHECK_THROWS_WITH(with({.kind = TrackerKind::tangent_plane}), Contains("give feedback"));
    CHECK_THROWS_WITH(with({.gain = -1.0}), Contains("gain is -1"));
    CHECK_THROWS_WITH(with({.kind = TrackerKind::newton, .iterations = 0}), Contains("1 to 100"));
    CHECK_THROWS_WITH(SurfaceTracker(nullptr, {}), Contains("give one of surfaces"));
    CHECK_THROWS_WITH(feedback_gain(*sheet, 0.0, kTrackTick), Contains("above 0"));
}

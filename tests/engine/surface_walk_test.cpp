#include "tests/support/catch.hpp"
#include "tests/support/surface_scenes.hpp"

using namespace palpate::engine;

TEST_CASE("the work of a tick on a surface is bounded, and what it could not do is said",
          "[scene][surface][law]") {
    // A sheet that is nearly a line under different weights: no search can prove its closest point.
    Random random(7);
    SurfaceData d = random_surface(random, 1.0, 3.0, 5, true);
    for (auto& row : d.points) {
        for (Vec3& p : row) {
            p = Vec3{p.x, 1e-9 * p.y, 1e-9 * p.z};
        }
    }
    const SurfaceFeet feet(shared(d));
    SurfaceTrack patient;
    SurfaceTrack hurried;
    int given_up = 0;
    for (int k = 0; k < 10; ++k) {
        const Vec3 h{random.in(-0.4, 0.4), random.in(-0.1, 0.1), random.in(-0.1, 0.1)};
        const SurfaceClosest first = feet.track(hurried, h, 300'000);
        const SurfaceClosest all = feet.track(patient, h, 30'000'000);
        given_up += first.proven ? 0 : 1;
        if (first.proven && all.proven) {
            CHECK(first.distance == Approx(all.distance).margin(1e-14));
        }
    }
    CHECK(given_up > 0);
}

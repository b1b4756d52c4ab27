#include "engine/deformation/dnurbs.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

TEST_CASE("the slowest motion of a bow is the one that its closed form says",
          "[deformation][law]") {
    SEEDED(random, 20U, 2908U);
    DnurbsSpec spec{.degree = 3,
                    .knots = {0, 0, 0, 0, 1, 1, 1, 1},
                    .points = {{0.0, 0.0}, {0.03, 0.05}, {0.07, 0.05}, {0.1, 0.0}},
                    .fixed = {0, 3}};
    spec.alpha = random.decade(-2.0, 2.0);
    spec.beta = random.decade(-2.0, 2.0);
    spec.mu = random.decade(-300.0, 3.0);
    // One cubic span, both ends fixed: the inner points move alike, by 3 u (1 - u), or against each
    // other, by 3 u (1 - u) (1 - 2 u), which is faster. Of the first the integrals of f^2, f'^2 and
    // f''^2 are 3/10, 3 and 36.
    const double omega =
        std::sqrt((3.0 * spec.alpha + 36.0 * spec.beta) / 0.3) / std::sqrt(spec.mu);
    CHECK(Dnurbs(spec).slowest_motion() == Approx(omega).epsilon(1e-6));
    spec.fixed.clear();
    CHECK(Dnurbs(spec).slowest_motion() == 0.0);
}

#include "tests/support/catch.hpp"
#include "tests/support/surface_cuts.hpp"
#include "tests/support/surface_scenes.hpp"

using namespace palpate::engine;

namespace {

/// A wavy sheet 0.1 m wide, polynomial or rational, and a hand too fast for the slew on it.
struct Chase {
    SurfaceData sheet;
    SceneSpec contact;
    double hz[3];
    double phase[3];
    double out = 0.0;       ///< of its middle, towards a border, m
    double across = 0.038;  ///< to both sides, m

    Chase(Random& random, std::uint64_t seed, double mu)
        : sheet(bicubic_8x8(random, seed % 2U == 0U ? 0.0 : 0.7, 0.03)),
          contact{.friction = {.mu_s = mu, .mu_d = mu}, .slew = {random.decade(-2.0, -0.3), 0.003}},
          hz{random.in(1.0, 5.0), random.in(1.0, 5.0), random.in(2.0, 6.0)},
          phase{random.in(0.0, 6.0), random.in(0.0, 6.0), random.in(0.0, 6.0)} {}

    [[nodiscard]] Vec3 hand(int tick) const {
        const auto wave = [&](int k) {
            return std::sin(6.283185307179586 * hz[k] * kPeriod * tick + phase[k]);
        };
        return {out + across * wave(0), 0.038 * wave(1), -0.012 + 0.015 * wave(2)};
    }

    /// The greatest difference of forces, N, with knots more, and the ticks that were slewed.
    [[nodiscard]] std::pair<double, int> apart(Random& random) const {
        const SurfaceScene few(made(sheet), {.contact = contact});
        SurfaceData more = with_knot_u(sheet, random.in(0.3, 4.7));
        more = turned_by(with_knot_u(turned(more), random.in(0.3, 4.7)), 3);
        const SurfaceScene many(made(more), {.contact = contact});
        SurfaceState a;
        SurfaceState b;
        double worst = 0.0;
        int slewed = 0;
        for (int k = 0; k < 1500; ++k) {
            const SurfaceContact at_a = few.tick(a, hand(k));
            const SurfaceContact at_b = many.tick(b, hand(k));
            if (!at_a.cp.proven || !at_b.cp.proven) {
                a = {};  // a contact may begin that is none
                b = {};
                continue;
            }
            worst = std::max(worst, glm::length(at_a.force - at_b.force));
            slewed += at_a.vertex_slew ? 1 : 0;
        }
        return {worst, slewed};
    }
};

}  // namespace

TEST_CASE("a slewed contact without friction is felt alike with more knots") {
    SEEDED(random, std::uint64_t{24});
    const auto [worst, slewed] = Chase(random, seed, 0.0).apart(random);
    CHECK(slewed > 0);
    CHECK(worst < 1e-5);
}

TEST_CASE("a slewed contact along an open border is felt alike with more knots") {
    SEEDED(random, std::uint64_t{24});
    Chase chase(random, seed, seed % 3U != 0U ? 0.0 : random.in(0.02, 0.2));
    chase.out = 0.052;
    chase.across = 0.006;
    CHECK(chase.apart(random).first < 5e-5);
}

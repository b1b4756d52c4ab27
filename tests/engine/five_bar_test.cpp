#include <cmath>
#include <numbers>

#include "engine/device/five_bar.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;
using palpate::tests::Random;

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

FiveBar symmetric(double driven, double free, double base) {
    return {.driven_1 = driven, .driven_2 = driven, .free_1 = free, .free_2 = free, .base = base};
}

}  // namespace

// Poses and Jacobians of published link lengths (Haplet; 2DIY generations 2 and 3), computed
// independently in extended precision and checked there against central differences.
TEST_CASE("positions and Jacobians agree with the golden poses of real devices",
          "[device][golden]") {
    struct Golden {
        FiveBar linkage;
        double t1, t2, x_mm, y_mm, j11, j12, j21, j22;
    };
    const FiveBar haplet = symmetric(0.05, 0.07, 0.02);
    const FiveBar gen2 = symmetric(0.07, 0.09, 0.0);
    const FiveBar gen3 = symmetric(0.07, 0.09, 0.038);
    const Golden golden[] = {
        {haplet, 150, 30, 10.000000000, 70.375925293, -0.030931410680, -0.030931410680,
         -0.036333881179, 0.036333881179},
        {haplet, 135, 20, 24.047791423, 72.385976225, -0.038672181350, -0.025313283801,
         -0.030034587637, 0.040606600795},
        {gen2, 150, 30, 0.0, 101.520673478, -0.050760336739, -0.050760336739, -0.046259030728,
         0.046259030728},
        {gen2, 135, 20, 22.843407242, 103.039951300, -0.061446375865, -0.041593575435,
         -0.033353394241, 0.056196801483},
        {gen3, 150, 30, 19.0, 76.956792369, -0.033472359693, -0.033472359693, -0.063520794870,
         0.063520794870},
        {gen3, 120, 60, 19.0, 132.621778265, -0.053644222466, -0.053644222466, -0.040233166849,
         0.040233166849},
        {gen3, 135, 20, 34.611032651, 81.524947171, -0.046895835131, -0.024700450478,
         -0.056329734687, 0.064866749038},
    };
    for (const Golden& g : golden) {
        CAPTURE(g.t1, g.t2, g.linkage.base);
        const JointAngles angles{g.t1 * kDegree, g.t2 * kDegree};
        const auto pose = g.linkage.forward(angles);
        REQUIRE(pose);
        CHECK(std::fabs(pose->handle.x * 1e3 - g.x_mm) < 1e-9);
        CHECK(std::fabs(pose->handle.y * 1e3 - g.y_mm) < 1e-9);
        const auto j = g.linkage.jacobian(*pose);
        REQUIRE(j);
        CHECK(std::fabs(j->row_x.x - g.j11) < 1e-12);
        CHECK(std::fabs(j->row_x.y - g.j12) < 1e-12);
        CHECK(std::fabs(j->row_y.x - g.j21) < 1e-12);
        CHECK(std::fabs(j->row_y.y - g.j22) < 1e-12);
    }
}

TEST_CASE("the Jacobian is the derivative of the handle, and its transpose conserves power",
          "[device][law]") {
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
        Random random(seed);
        CAPTURE(seed);
        const FiveBar linkage{.driven_1 = random.in(0.05, 0.07),
                              .driven_2 = random.in(0.05, 0.07),
                              .free_1 = random.in(0.07, 0.09),
                              .free_2 = random.in(0.07, 0.09),
                              .base = random.in(0.0, 0.04)};
        const JointAngles angles{random.in(100.0, 160.0) * kDegree,
                                 random.in(20.0, 80.0) * kDegree};
        const auto pose = linkage.forward(angles);
        const auto j = pose ? linkage.jacobian(*pose) : std::nullopt;
        if (!j || std::fabs(j->determinant()) < 1e-4) {
            continue;
        }
        const double e = 1e-6;
        const auto at = [&](double d1, double d2) {
            return linkage.forward({angles[0] + d1, angles[1] + d2})->handle;
        };
        const Vec2 d1 = (at(e, 0.0) - at(-e, 0.0)) / (2.0 * e);
        const Vec2 d2 = (at(0.0, e) - at(0.0, -e)) / (2.0 * e);
        CHECK(glm::length(d1 - Vec2{j->row_x.x, j->row_y.x}) < 1e-9);
        CHECK(glm::length(d2 - Vec2{j->row_x.y, j->row_y.y}) < 1e-9);
        const Vec2 force = random.point(-5.0, 5.0);
        const Vec2 rates = random.point(-2.0, 2.0);
        CHECK(std::fabs(glm::dot(j->transposed(force), rates) - glm::dot(force, *j * rates)) <
              1e-14);
    }
}

TEST_CASE(
    "the inverse brings the handle back in the whole workspace, and refuses what is out of reach",
    "[device][law]") {
    const FiveBar linkage;
    Random random(2);
    for (int i = 0; i < 2000; ++i) {
        const Vec2 handle{random.in(-0.035, 0.060), random.in(0.045, 0.120)};
        CAPTURE(handle.x, handle.y);
        const auto angles = linkage.inverse(handle);
        REQUIRE(angles);
        const auto pose = linkage.forward(*angles);
        REQUIRE(pose);
        CHECK(glm::length(pose->handle - handle) < 1e-15);
    }
    CHECK_FALSE(linkage.inverse({0.0, 0.5}).has_value());
    CHECK_FALSE(linkage.inverse({0.0, 0.0}).has_value());
    CHECK_FALSE(linkage.forward({std::numbers::pi, 0.0}).has_value());  // elbows too far apart
}

#include "engine/device/five_bar.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

/// Links of any lengths; either assembly.
FiveBar any_linkage(Random& random) {
    return {.driven_1 = random.in(0.04, 0.09),
            .driven_2 = random.in(0.04, 0.09),
            .free_1 = random.in(0.05, 0.10),
            .free_2 = random.in(0.05, 0.10),
            .base = random.in(0.0, 0.05),
            .mode = {.handle_left = random.coin()}};
}

/// An angle less whole turns, in [-pi, pi].
double turned(double angle) {
    return std::remainder(angle, 2.0 * kPi);
}

FiveBar symmetric(double driven, double free, double base) {
    return {.driven_1 = driven, .driven_2 = driven, .free_1 = free, .free_2 = free, .base = base};
}

}  // namespace

// Poses and Jacobians of published link lengths (Haplet; 2DIY generations 2 and 3), computed
// independently in extended precision and checked there against central differences.
TEST_CASE("positions and Jacobians agree with the golden poses of real devices") {
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

TEST_CASE("the Jacobian is the derivative of the handle, and its transpose conserves power") {
    int tried = 0;
    for (std::uint64_t seed = 0; seed < 4000; ++seed) {
        Random random(seed);
        CAPTURE(seed);
        const FiveBar linkage = any_linkage(random);
        const JointAngles angles{random.in(-kPi, kPi), random.in(-kPi, kPi)};
        const auto pose = linkage.forward(angles);
        if (!pose || linkage.clearance(*pose).parallel < 0.005) {
            continue;
        }
        ++tried;
        const auto j = linkage.jacobian(*pose);
        REQUIRE(j);
        const double e = 1e-6;
        const auto at = [&](double d1, double d2) {
            return linkage.forward({angles[0] + d1, angles[1] + d2})->handle;
        };
        const Vec2 d1 = (at(e, 0.0) - at(-e, 0.0)) / (2.0 * e);
        const Vec2 d2 = (at(0.0, e) - at(0.0, -e)) / (2.0 * e);
        CHECK(glm::length(d1 - j->column_1()) < 1e-8);
        CHECK(glm::length(d2 - j->column_2()) < 1e-8);
        const Vec2 force = random.point(-5.0, 5.0);
        const Vec2 rates = random.point(-2.0, 2.0);
        CHECK(std::fabs(glm::dot(j->transposed(force), rates) - glm::dot(force, *j * rates)) <
              1e-13 * singular_values(*j).largest / 0.1);

        // The handle's acceleration that comes of the rates alone, by a difference of the Jacobian.
        const auto later = linkage.forward({angles[0] + e * rates.x, angles[1] + e * rates.y});
        const auto sooner = linkage.forward({angles[0] - e * rates.x, angles[1] - e * rates.y});
        const Vec2 drift =
            (*linkage.jacobian(*later) * rates - *linkage.jacobian(*sooner) * rates) / (2.0 * e);
        const Jacobian c = linkage.drift(*pose, *j, rates);
        CHECK(glm::length(c * rates - drift) < 1e-6 * (1.0 + glm::length(drift)));
        const Vec2 other = random.point(-2.0, 2.0);
        CHECK(glm::length(c * other - linkage.drift(*pose, *j, other) * rates) <
              1e-12 * (1.0 + glm::length(drift)));
    }
    CHECK(tried > 1500);
}

TEST_CASE("singular values are those of the turned and stretched circle") {
    SEEDED(random, std::uint64_t{300});
    const Jacobian j{.row_x = random.point(-1.0, 1.0), .row_y = random.point(-1.0, 1.0)};
    const SingularValues s = singular_values(j);
    CHECK(std::fabs(s.largest * s.smallest - std::fabs(j.determinant())) < 1e-14);
    CHECK(std::fabs(s.largest * s.largest + s.smallest * s.smallest - glm::dot(j.row_x, j.row_x) -
                    glm::dot(j.row_y, j.row_y)) < 1e-14);
}

TEST_CASE("inverse and forward undo each other in every working mode, and keep it") {
    int kept = 0;
    for (std::uint64_t seed = 0; seed < 20000; ++seed) {
        Random random(seed);
        CAPTURE(seed);
        FiveBar linkage = any_linkage(random);
        const JointAngles angles{random.in(-kPi, kPi), random.in(-kPi, kPi)};
        const auto pose = linkage.forward(angles);
        if (!pose) {
            continue;
        }
        linkage.mode = linkage.mode_of(*pose);  // the mode that these angles belong to
        const Clearance clearance = linkage.clearance(*pose);
        CHECK(clearance.min() >= 0.0);
        if (clearance.min() < 0.001) {
            continue;
        }
        ++kept;
        const auto back = linkage.inverse(pose->handle);
        REQUIRE(back);
        CHECK(std::fabs(turned(back->at(0) - angles[0])) < 1e-12);
        CHECK(std::fabs(turned(back->at(1) - angles[1])) < 1e-12);
        const auto again = linkage.forward(*back);
        REQUIRE(again);
        CHECK(glm::length(again->handle - pose->handle) < 1e-12);
        CHECK(linkage.mode_of(*again) == linkage.mode);

        // Another mode gives another pose or none, never this one.
        FiveBar other = linkage;
        other.mode.elbow_1_left = !other.mode.elbow_1_left;
        CHECK(other.clearance(*pose).serial_1 == -clearance.serial_1);
        if (const auto apart = other.inverse(pose->handle)) {
            CHECK(other.mode_of(*other.forward(*apart)) == other.mode);
        }
    }
    CHECK(kept > 8000);
}

TEST_CASE("the serial clearance is the way to the place where the links lie in line") {
    SEEDED(random, std::uint64_t{500});
    const FiveBar linkage;
    const Vec2 handle{random.in(-0.03, 0.055), random.in(0.05, 0.12)};
    const auto pose = linkage.forward(linkage.inverse(handle).value());
    REQUIRE(pose);
    const Clearance clearance = linkage.clearance(*pose);
    const double r = glm::length(handle);
    const double outward = linkage.driven_1 + linkage.free_1 - r;
    CHECK(clearance.serial_1 < outward + 1e-15);
    // Just short of that way the handle can be reached, just beyond it cannot.
    const Vec2 away = handle / r;
    if (clearance.serial_1 > outward - 1e-15 && clearance.serial_2 > 2.0 * outward) {
        CHECK(linkage.inverse(handle + away * (outward - 1e-9)));
        CHECK_FALSE(linkage.inverse(handle + away * (outward + 1e-9)));
    }
}

TEST_CASE("elbows one above the other are a pose like any other") {
    // The published formula divides by the difference of the elbows' x.
    const FiveBar linkage{.mode = {.handle_left = false}};
    for (const double off : {0.0, 1e-16, -1e-16, 1e-12, 1e-6}) {
        const double t2 = -1.2;
        const double x = linkage.base + linkage.driven_2 * std::cos(t2) + off;
        const double t1 = std::acos(x / linkage.driven_1);
        const auto pose = linkage.forward({t1, t2});
        REQUIRE(pose);
        CHECK(std::fabs(pose->elbow_1.x - pose->elbow_2.x - off) < 1e-16);
        CHECK(std::fabs(glm::length(pose->handle - pose->elbow_1) - linkage.free_1) < 1e-16);
        CHECK(std::fabs(glm::length(pose->handle - pose->elbow_2) - linkage.free_2) < 1e-16);
        CHECK(linkage.jacobian(*pose));
    }
}

TEST_CASE(
    "the inverse brings the handle back in the whole workspace, and refuses what is out of reach") {
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

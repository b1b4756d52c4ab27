#include "engine/surface/nurbs_surface.hpp"
#include "stimuli/surface_patch.hpp"
#include "tests/support/catch.hpp"

using namespace palpate::engine;
using namespace palpate::stimuli;

namespace {

struct Drawn {
    SurfacePatch patch;
    std::mt19937 random;

    explicit Drawn(unsigned seed) : random(seed) {
        std::uniform_real_distribution<double> size{0.02, 0.12};
        std::uniform_real_distribution<double> sine{-stimuli::kMaxHalfSine, stimuli::kMaxHalfSine};
        patch.size = size(random);
        patch.curvature_x = seed % 7 == 0 ? 0.0 : 2.0 * sine(random) / patch.size;
        patch.curvature_y = seed % 5 == 0 ? 0.0
                          : seed % 3 == 0 ? patch.curvature_x
                                          : 2.0 * sine(random) / patch.size;
    }
    double parameter(double low, double high) {
        return std::uniform_real_distribution<double>{low, high}(random);
    }
};

/// How far a point is from the exact surface, m: its profile in the plane y = 0 is an arc of
/// curvature k through the origin, revolved about the line y = 0, z = -1 / c.
double off(const SurfacePatch& patch, const Vec3& p) {
    const double k = patch.curvature_x;
    const double c = patch.curvature_y;
    const double height =  // in the plane of the profile
        c == 0.0 ? p.z : std::copysign(std::hypot(p.y, p.z + 1.0 / c), c) - 1.0 / c;
    return k == 0.0 ? height : std::hypot(p.x, height + 1.0 / k) - std::fabs(1.0 / k);
}

}  // namespace

TEST_CASE("a patch is the surface of revolution that its curvatures name, to rounding",
          "[stimuli][surface][law]") {
    SEED(60U);
    Drawn drawn(seed);
    CAPTURE(drawn.patch.size, drawn.patch.curvature_x, drawn.patch.curvature_y);
    const auto surface = make_surface(drawn.patch);

    CHECK(glm::length(surface->at(1.5, 1.5).point) < 1e-15);
    CHECK(surface->normal(1.5, 1.5).z > 1.0 - 1e-12);
    double worst = 0.0;
    double lowest = 1.0;
    for (int i = 0; i < 200; ++i) {
        const double u = drawn.parameter(1.0, 2.0);
        const double v = drawn.parameter(1.0, 2.0);
        // A weak curvature has its centre far away, and so do the digits of the distance from it.
        const double k = drawn.patch.curvature_x;
        const double c = drawn.patch.curvature_y;
        const double far =
            std::max(k == 0.0 ? 0.0 : 1.0 / std::fabs(k), c == 0.0 ? 0.0 : 1.0 / std::fabs(c));
        worst = std::max(worst, std::fabs(off(drawn.patch, surface->at(u, v).point)) - 1e-15 * far);
        lowest = std::min(lowest, surface->normal(u, v).z);
    }
    CHECK(worst < 1e-14);
    CHECK(lowest > 0.7);  // 30 degrees along x and along y
}

TEST_CASE(
    "the rim goes on from the patch without a gap, level straight outwards, beyond every reach",
    "[stimuli][surface][law]") {
    EACH(seed, range(100U, 130U));
    Drawn drawn(seed);
    const auto surface = make_surface(drawn.patch);
    const double half = 0.5 * drawn.patch.size;
    for (int i = 0; i < 50; ++i) {
        const double along = drawn.parameter(1.0, 2.0);
        const double out = drawn.parameter(0.0, 1.0);
        for (const bool last : {false, true}) {
            const double at = last ? 2.0 + out : 1.0 - out;
            const double border = last ? 2.0 : 1.0;
            const Vec3 in_x = surface->at(at, along).point;
            const Vec3 from_x = surface->at(border, along).point;
            CHECK(std::fabs(in_x.z - from_x.z) < 1e-15);
            CHECK((last ? in_x.x - from_x.x : from_x.x - in_x.x) >= 0.0);
            const Vec3 in_y = surface->at(along, at).point;
            const Vec3 from_y = surface->at(along, border).point;
            CHECK(std::fabs(in_y.z - from_y.z) < 1e-15);
            CHECK((last ? in_y.y - from_y.y : from_y.y - in_y.y) >= 0.0);
        }
    }
    CHECK(std::fabs(surface->at(0.0, 0.0).point.x + half + stimuli::kRim) < 1e-15);
    CHECK(std::fabs(surface->at(3.0, 3.0).point.y - half - stimuli::kRim) < 1e-15);
}

TEST_CASE("a drawing's lines stay within its border, whatever the patch",
          "[stimuli][surface][law]") {
    EACH(seed, range(200U, 230U));
    const Drawn drawn(seed);
    const stimuli::PatchDrawing drawing = stimuli::drawing_of(*make_surface(drawn.patch));
    const auto inside = [&drawing](const Vec2& p) {  // crossings of a ray to the right
        bool odd = false;
        for (std::size_t i = 0; i < drawing.border.size(); ++i) {
            const Vec2& a = drawing.border[i];
            const Vec2& b = drawing.border[(i + 1) % drawing.border.size()];
            if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)) {
                odd = !odd;
            }
        }
        return odd;
    };
    REQUIRE(drawing.lines.size() == 10);
    for (const auto& line : drawing.lines) {
        for (std::size_t i = 1; i + 1 < line.size(); ++i) {
            CHECK(inside(line[i]));
        }
    }
}

TEST_CASE(
    "a hill is light on the left and dark on the right, a hollow the other way, a level one even",
    "[stimuli][surface][law]") {
    /// Of the right half less that of the left one.
    const auto darker_right = [](double curvature_x, double curvature_y) {
        const auto surface =
            make_surface({.size = 0.060, .curvature_x = curvature_x, .curvature_y = curvature_y});
        double sum = 0.0;
        for (const auto& one : stimuli::drawing_of(*surface).shade) {
            sum += (one.point.x > 0.0 ? 1.0 : -1.0) * static_cast<double>(one.dark);
        }
        return sum;
    };
    CHECK(darker_right(10.0, 10.0) > 200.0);
    CHECK(darker_right(-10.0, -10.0) < -200.0);
    CHECK(std::fabs(darker_right(0.0, 0.0)) < 20.0);
    const auto walls =
        stimuli::drawing_of(*make_surface({.curvature_x = 16, .curvature_y = 16})).walls;
    REQUIRE(walls.size() == 2);
    for (const auto& wall : walls) {  // below the patch's edge everywhere
        CHECK(std::min(wall[wall.size() - 1].y, wall[wall.size() - 2].y) <
              std::ranges::min(wall, {}, [](const Vec2& p) { return p.y; }).y + 1e-12);
    }
}

TEST_CASE("seen from above the border of a patch is where its sides are",
          "[stimuli][surface][law]") {
    EACH(seed, range(300U, 320U));
    const Drawn drawn(seed);
    const auto border = stimuli::border_of(*make_surface(drawn.patch));
    const double half = 0.5 * drawn.patch.size;
    REQUIRE(border.size() == 128);
    double area = 0.0;
    for (std::size_t i = 0; i < border.size(); ++i) {
        area += 0.5 * engine::cross(border[i], border[(i + 1) % border.size()]);
        CHECK(glm::length(border[i]) >=
              half * (1.0 - 1e-12) * 0.86);  // 1 + c z, 30 degrees at most
        CHECK(glm::length(border[i]) <= 2.0 * half);
    }
    // Of a plane a square; a side along y is the longer the higher it lies above the axis.
    const bool flat = drawn.patch.curvature_x == 0.0 || drawn.patch.curvature_y == 0.0;
    CHECK(std::fabs(std::fabs(area) / (drawn.patch.size * drawn.patch.size) - 1.0) <
          (flat ? 1e-12 : 0.2));
}

TEST_CASE("a patch that cannot be is refused with its value and what to give",
          "[stimuli][surface]") {
    CHECK_THROWS_WITH(make_surface({.size = 0.06, .curvature_x = 20.0}),
                      "a curvature of 20 1/m is too strong for a patch of 60 mm: stay within "
                      "16.6666667 1/m either way");
    CHECK_THROWS_WITH(make_surface({.size = 0.0}),
                      "the size of the patch is 0 m: give a number above 0");
}

#include "stimuli/surface_patch.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>

#include "engine/base/refuse.hpp"
#include "engine/surface/nurbs_surface.hpp"

namespace palpate::stimuli {
namespace {

using engine::Vec2;
using engine::Vec3;

constexpr std::size_t kRow = 7;  ///< control points a side: rim, patch, rim, of degree 2

/// The arc of one curvature through the origin, level there, over [-half, half].
struct Arc {
    double drop = 0.0;    ///< of its ends, m: how far they lie below the middle
    double lift = 0.0;    ///< of its middle control point, m
    double cosine = 1.0;  ///< of half its angle: the weight of that point
};

Arc arc_of(double curvature, double half) {
    const double sine = curvature * half;
    const double cosine = std::sqrt(1.0 - sine * sine);
    const double drop = curvature * half * half / (1.0 + cosine);
    return {.drop = drop, .lift = half * sine / cosine - drop, .cosine = cosine};
}

void check(const SurfacePatch& patch) {
    refuse_if(!(patch.size > 0.0), "the size of the patch is {:.9g} m: give a number above 0",
              patch.size);
    for (const double curvature : {patch.curvature_x, patch.curvature_y}) {
        refuse_if(!(std::fabs(curvature) * patch.size / 2.0 <= kMaxHalfSine),
                  "a curvature of {:.9g} 1/m is too strong for a patch of {:.9g} mm: stay within "
                  "{:.9g} 1/m either way",
                  curvature, 1e3 * patch.size, 2.0 * kMaxHalfSine / patch.size);
    }
}

/// `inner`, with a rim to `far` on both sides.
std::array<double, kRow> with_rim(const std::array<double, 3>& inner, double far) {
    return {-far,     0.5 * (inner[0] - far), inner[0], inner[1],
            inner[2], 0.5 * (inner[2] + far), far};
}

/// The rim is level: it has its border's height, and its weight.
std::array<double, kRow> level(const std::array<double, 3>& inner) {
    return {inner[0], inner[0], inner[0], inner[1], inner[2], inner[2], inner[2]};
}

/// Once around the unit square, `steps` a side.
std::vector<Vec2> around(int steps) {
    std::vector<Vec2> all;
    for (int i = 0; i < 4 * steps; ++i) {
        const double t = static_cast<double>(i % steps) / steps;
        const int side = i / steps;
        all.push_back(side == 0   ? Vec2{0.0, t}
                      : side == 1 ? Vec2{t, 1.0}
                      : side == 2 ? Vec2{1.0, 1.0 - t}
                                  : Vec2{1.0 - t, 0.0});
    }
    return all;
}

// Turned by 30 degrees, seen from 50 degrees above: steeper than any patch, so that nothing hides
// anything.
constexpr double kTurnCos = 0.8660254037844386;
constexpr double kTurnSin = 0.5;
constexpr double kAboveCos = 0.6427876096865393;
constexpr double kAboveSin = 0.766044443118978;

Vec2 seen_at(const Vec3& p) {
    const double away = kTurnSin * p.x + kTurnCos * p.y;
    return {kTurnCos * p.x - kTurnSin * p.y, kAboveSin * away + kAboveCos * p.z};
}

using PointAt = std::function<Vec3(double, double)>;

/// By the slope against the light: what is level has one shade, whatever the patch.
float darkness(const Vec3& along_u, const Vec3& along_v) {
    constexpr double kLevel = 0.30;
    constexpr double kContrast = 1.1;
    const Vec3 right{kTurnCos, -kTurnSin, 0.0};
    const Vec3 back{kTurnSin, kTurnCos, 0.0};
    const Vec3 light = glm::normalize(-0.7 * right + 0.3 * back + Vec3{0.0, 0.0, 0.65});
    const Vec3 normal = glm::normalize(glm::cross(along_u, along_v));
    return static_cast<float>(
        std::clamp(kLevel - kContrast * (glm::dot(normal, light) - light.z), 0.0, 0.85));
}

void add_shade(PatchDrawing& drawing, int steps, const PointAt& point) {
    constexpr double kStep = 1e-3;
    const auto at = [&](int i, int j) {
        const double u = static_cast<double>(i) / steps;
        const double v = static_cast<double>(j) / steps;
        const double du = u < 0.5 ? kStep : -kStep;
        const double dv = v < 0.5 ? kStep : -kStep;
        const Vec3 here = point(u, v);
        return ShadedPoint{seen_at(here), darkness((point(u + du, v) - here) / du,
                                                   (point(u, v + dv) - here) / dv)};
    };
    for (int i = 0; i < steps; ++i) {
        for (int j = 0; j < steps; ++j) {
            const ShadedPoint a = at(i, j);
            const ShadedPoint c = at(i + 1, j + 1);
            for (const ShadedPoint& one : {a, at(i + 1, j), c, a, c, at(i, j + 1)}) {
                drawing.shade.push_back(one);
            }
        }
    }
}

/// Down to a level that is deeper than any patch.
void add_walls(PatchDrawing& drawing, int steps, const PointAt& point) {
    const double base = -0.35 * (point(1.0, 0.5).x - point(0.0, 0.5).x);
    for (const bool along_u : {true, false}) {
        std::vector<Vec2> wall;
        Vec3 last{};
        for (int i = 0; i <= steps; ++i) {
            const double t = static_cast<double>(i) / steps;
            last = along_u ? point(t, 0.0) : point(0.0, t);
            wall.push_back(seen_at(last));
        }
        Vec3 first = point(0.0, 0.0);
        last.z = first.z = base;
        wall.push_back(seen_at(last));
        wall.push_back(seen_at(first));
        drawing.walls.push_back(std::move(wall));
    }
}

}  // namespace

std::shared_ptr<const engine::NurbsSurface> make_surface(const SurfacePatch& patch) {
    check(patch);
    const double half = 0.5 * patch.size;
    const double far = half + kRim;
    const Arc x = arc_of(patch.curvature_x, half);
    const Arc y = arc_of(patch.curvature_y, half);
    const auto places = with_rim({-half, 0.0, half}, far);
    const auto heights = level({-x.drop, x.lift, -x.drop});
    const auto weights_x = level({1.0, x.cosine, 1.0});
    const auto weights_y = level({1.0, y.cosine, 1.0});
    std::vector<std::vector<Vec3>> points(kRow);
    std::vector<std::vector<double>> weights(kRow);
    for (std::size_t i = 0; i < kRow; ++i) {
        // A point at this height goes round the axis at 1 / curvature_y + height.
        const double height = heights[i];
        const double side = half * (1.0 + patch.curvature_y * height);
        const double end = height * y.cosine - y.drop;
        const double middle = (height + y.drop) / y.cosine;
        const auto across = with_rim({-side, 0.0, side}, far);
        const auto up = level({end, middle, end});
        for (std::size_t j = 0; j < kRow; ++j) {
            points[i].emplace_back(places[i], across[j], up[j]);
            weights[i].push_back(weights_x[i] * weights_y[j]);
        }
    }
    const std::vector<double> knots{0, 0, 0, 1, 1, 2, 2, 3, 3, 3};
    return std::make_shared<const engine::NurbsSurface>(2, 2, knots, knots, points, weights);
}

std::vector<Vec2> border_of(const engine::NurbsSurface& surface) {
    constexpr int kSteps = 32;  // of a side
    std::vector<Vec2> border;
    for (const Vec2& at : around(kSteps)) {
        border.emplace_back(surface.at(1.0 + at.x, 1.0 + at.y).point);
    }
    return border;
}

PatchDrawing drawing_of(const engine::NurbsSurface& surface) {
    constexpr int kSteps = 32;  // of a line
    constexpr int kLines = 6;   // pieces between two borders
    const auto point = [&](double u, double v) {
        return surface.at(1.0 + u, 1.0 + v).point;
    };
    const auto seen = [&](double u, double v) {
        return seen_at(point(u, v));
    };
    PatchDrawing drawing;
    for (const Vec2& at : around(kSteps)) {
        drawing.border.push_back(seen(at.x, at.y));
    }
    for (int line = 1; line < kLines; ++line) {
        const double at = static_cast<double>(line) / kLines;
        std::vector<Vec2> of_u;
        std::vector<Vec2> of_v;
        for (int i = 0; i <= kSteps; ++i) {
            const double t = static_cast<double>(i) / kSteps;
            of_u.push_back(seen(at, t));
            of_v.push_back(seen(t, at));
        }
        drawing.lines.push_back(std::move(of_u));
        drawing.lines.push_back(std::move(of_v));
    }
    add_shade(drawing, kSteps, point);
    add_walls(drawing, kSteps, point);
    return drawing;
}

}  // namespace palpate::stimuli

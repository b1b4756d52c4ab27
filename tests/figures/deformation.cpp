// Figure 4.4.1: a dynamic NURBS curve at rest under a force at its middle and at its ends.
#include "engine/deformation/dnurbs.hpp"
#include "tests/figures/drawing.hpp"
#include "tests/figures/make.hpp"

namespace palpate::figures {
namespace {

using engine::Vec2;

constexpr double kAlpha = 12.0;   // N/m
constexpr double kBeta = 0.4;     // N/m
constexpr int kDrawn = 200;       // of a drawn curve
constexpr double kMmPerN = 25.0;  // of the drawn force

/// One picture: where the force acts, and what is held.
struct Load {
    const char* name;
    double u;
    Vec2 force;
    std::vector<std::size_t> fixed;
};

const std::array<Load, 4>& loads() {
    static const std::array<Load, 4> all{{{"a", 0.5, {0.0, -1.0}, {0, 3}},
                                          {"b", 0.0, {-0.3, 0.3}, {3}},
                                          {"c", 0.0, {0.3, -0.3}, {3}},
                                          {"d", 1.0, {0.3, 0.3}, {0}}}};
    return all;
}

struct Deformed {
    std::vector<double> u{};
    std::vector<Vec2> rest{}, bent{};                ///< of the curve, m
    std::vector<Vec2> points_rest{}, points_bent{};  ///< control points, m
    Vec2 loaded{};                                   ///< on the curve at rest, m
};

Deformed deformed(const Load& load) {
    const engine::Dnurbs curve({.degree = 3,
                                .knots = {0, 0, 0, 0, 1, 1, 1, 1},
                                .points = {{-0.05, 0.0}, {-0.02, 0.05}, {0.02, 0.05}, {0.05, 0.0}},
                                .alpha = kAlpha,
                                .beta = kBeta,
                                .fixed = load.fixed});
    const std::vector<Vec2> q = curve.equilibrium(load.u, load.force);
    const std::vector<Vec2> still(q.size());
    Deformed shown{.points_rest = curve.spec().points, .points_bent = q};
    for (std::size_t i = 0; i < q.size(); ++i) {
        shown.points_bent[i] += curve.spec().points[i];
    }
    for (int i = 0; i <= kDrawn; ++i) {
        shown.u.push_back(static_cast<double>(i) / kDrawn);
        shown.rest.push_back(curve.point(shown.u.back(), still));
        shown.bent.push_back(curve.point(shown.u.back(), q));
    }
    shown.loaded = curve.point(load.u, still);
    return shown;
}

Panel panel_of(const Load& load, const Deformed& shown) {
    Panel panel = plane_mm(fmt::format("({}) force at u = {}", load.name, load.u), 240.0);
    panel.series = {path_mm("at rest", shown.rest, {Ink::blue, 2.0}),
                    dots_mm("control points at rest", shown.points_rest, Ink::blue),
                    path_mm("deformed", shown.bent, {Ink::vermillion, 2.0, Stroke::dashed}),
                    dots_mm("displaced", shown.points_bent, Ink::vermillion)};
    panel.arrows = {{.x = kMillimetres * shown.loaded.x,
                     .y = kMillimetres * shown.loaded.y,
                     .dx = kMmPerN * load.force.x,
                     .dy = kMmPerN * load.force.y,
                     .name = fmt::format("force, {:g} mm a newton", kMmPerN),
                     .ink = Ink::green}};
    return panel;
}

}  // namespace

MadeFigure make_deformation() {
    Figure figure{
        .id = "fig_4_4_1",
        .title = "Figure 4.4.1: a B-spline curve under a force",
        .columns = 2,
        .share_x = false,
        .caption = fmt::format(
            "Equilibrium of a dynamic NURBS curve (cubic, equal weights, tension {:g} N/m, "
            "rigidity {:g} N/m, both per unit of u) under a force of {:g} N in (a) and {:.2g} N in "
            "(b) to (d). Held are both ends in (a), the right one in (b) and (c), the left one in "
            "(d): with nothing held, as in the thesis, no force has an equilibrium.",
            kAlpha, kBeta, 1.0, 0.3 * std::sqrt(2.0)),
        .width = 980.0};
    MadeFigure made;
    for (const Load& load : loads()) {
        const Deformed shown = deformed(load);
        figure.panels.push_back(panel_of(load, shown));
        std::vector<CsvColumn> table{{"u", shown.u}};
        add_vectors(table, "rest", "m", shown.rest, std::identity());
        add_vectors(table, "deformed", "m", shown.bent, std::identity());
        made.tables.push_back({fmt::format("_{}", load.name), table});
    }
    made.svg = svg(figure);
    return made;
}

}  // namespace palpate::figures

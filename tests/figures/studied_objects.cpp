// Figure 4.3.1: the objects of the study, of two curves that are convex, straight or hollow.
#include "stimuli/two_curve.hpp"
#include "tests/figures/drawing.hpp"
#include "tests/figures/make.hpp"

namespace palpate::figures {
namespace {

using engine::Vec2;

struct Studied {
    const char* title;
    double curvature;  ///< 1/m
};

/// As the shipped protocols of the thesis' study have them.
constexpr std::array<Studied, 5> kStudied{{{"(a) Convex, 10 1/m", 10.0},
                                           {"(b) Convex, 5 1/m", 5.0},
                                           {"(c) Straight", 0.0},
                                           {"(d) Concave, 5 1/m", -5.0},
                                           {"(e) Concave, 10 1/m", -10.0}}};

}  // namespace

MadeFigure make_studied_objects() {
    Figure figure{.id = "fig_4_3_1",
                  .title = "Figure 4.3.1: the objects of the study",
                  .columns = 3,
                  .share_x = false,
                  .width = 980.0};
    Panel all = plane_mm("(f) All on top of each other", 170.0);
    std::vector<CsvColumn> table{{"curvature_per_m", {}}, {"x_m", {}}, {"y_m", {}}};
    for (const Studied& one : kStudied) {
        std::vector<Vec2> points = stimuli::silhouette({.curvature = one.curvature});
        points.push_back(points.front());
        for (const Vec2& p : points) {
            add_row(table, {one.curvature, p.x, p.y});
        }
        Panel panel = plane_mm(one.title, 170.0);
        panel.series = {path_mm("", points)};
        figure.panels.push_back(panel);
        all.series.push_back(path_mm(fmt::format("{:g} 1/m", one.curvature), points));
    }
    figure.panels.push_back(all);
    figure.caption =
        "Two curves meet at a vertex over a base line, as the renderer has them: arcs as exact "
        "rational quadratics, drawn at most 20 micrometres beside. The thesis prints no "
        "curvatures; these are the five of the protocol that ships.";
    return {svg(figure), {{"", table}}};
}

}  // namespace palpate::figures

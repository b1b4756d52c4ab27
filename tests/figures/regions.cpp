// Figure 2.1.4: the Voronoi regions of an object of three curves.
#include "tests/figures/drawing.hpp"
#include "tests/figures/make.hpp"
#include "tests/figures/region_drawing.hpp"

namespace palpate::figures {
namespace {

using engine::Vec2;

constexpr double kFan = 0.009;  // m, length of a drawn normal

/// Three normals of each convex vertex's fan, found as directions from the vertex.
std::vector<data::Arrow> fans(const engine::Outline& outline) {
    std::vector<data::Arrow> arrows;
    for (const engine::Seam& seam : outline.seams()) {
        if (seam.kind != engine::SeamKind::convex) {
            continue;
        }
        const Vec2 first{-seam.tangent_in.y, seam.tangent_in.x};
        constexpr int kNormals = 5;
        for (int k = 0; k < kNormals; ++k) {
            const double phi = -seam.turn * k / (kNormals - 1);  // clockwise
            const Vec2 n{std::cos(phi) * first.x - std::sin(phi) * first.y,
                         std::sin(phi) * first.x + std::cos(phi) * first.y};
            arrows.push_back({kMillimetres * seam.point.x, kMillimetres * seam.point.y,
                              kMillimetres * kFan * n.x, kMillimetres * kFan * n.y,
                              "fan of normals of a vertex", Ink::green});
        }
    }
    return arrows;
}

}  // namespace

MadeFigure make_regions() {
    const Polygons object = three_curves();
    const RegionMap map(curves_of(object));
    const std::vector<Border> pieces = borders(map, kLattice);
    Panel panel = plane_mm("", 560.0);
    panel.series = {outline_mm(curves_of(object)), border_series(map, pieces, true),
                    border_series(map, pieces, false)};
    std::ranges::move(control_points_mm(object), std::back_inserter(panel.series));
    panel.arrows = fans(map.outline());
    panel.labels = region_names(map);
    look_at(panel, -78.0, 78.0, -66.0, 66.0);
    Figure figure{.id = "fig_2_1_4",
                  .title = "Figure 2.1.4: internal and external Voronoi regions",
                  .panels = {panel}};
    figure.caption = fmt::format(
        "Three cubics of four control points each close an object. On a lattice of {} x {} "
        "places the engine's global closest point says which feature is nearest: outside a curve "
        "(a, c, e) or a vertex (b, d, f), inside one of the three curves (1, 2, 3). Where two "
        "neighbours differ, the border between them is bisected to 1e-12 m. The external borders "
        "come out as the normals at the curves' ends; the internal ones as the bisectors of two "
        "curves, not as those normals drawn on into the object.",
        kLattice.columns, kLattice.rows);
    std::vector<CsvColumn> table{column("region", pieces, &Border::region),
                                 column("other_region", pieces, &Border::other)};
    add_vectors(table, "from", "m", pieces, &Border::from);
    add_vectors(table, "to", "m", pieces, &Border::to);
    return {svg(figure), {{"", table}, {"_object", control_point_table(object)}}};
}

}  // namespace palpate::figures

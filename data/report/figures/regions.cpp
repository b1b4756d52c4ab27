// Figures 2.1.4 and 2.1.5: the Voronoi regions of three curves, and how a path goes through them.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "data/report/figures/drawing.hpp"
#include "data/report/figures/make.hpp"
#include "data/report/figures/region_map.hpp"
#include "data/report/svg_diagram.hpp"

namespace palpate::data {
namespace {

using engine::Vec2;

constexpr Lattice kLattice{.low = {-0.08007, -0.07011}, .step = 0.001, .columns = 161, .rows = 141};
constexpr double kFan = 0.009;    // m, length of a drawn normal
constexpr double kTick = 0.001;   // s
constexpr double kRound = 4.0;    // s, once round the object
constexpr double kInner = 0.012;  // m, radius of the second round

Series border_series(const RegionMap& map, const std::vector<Border>& pieces, bool external) {
    std::vector<Vec2> points;
    for (const Border& b : pieces) {
        if (map.external(b.region) == external) {
            points.insert(points.end(), {b.from, b.to, gap()});
        }
    }
    Series series = path_mm(external ? "external borders: normals at the ends"
                                     : "internal borders: equally far from two curves",
                            points);
    series.ink = external ? Ink::blue : Ink::vermillion;
    series.width = 1.4;
    return series;
}

/// Three normals of each convex vertex's fan, found as directions from the vertex.
std::vector<Arrow> fans(const engine::Outline& outline) {
    std::vector<Arrow> arrows;
    for (const engine::Joint& joint : outline.joints()) {
        if (joint.kind != engine::JointKind::convex) {
            continue;
        }
        const Vec2 first{-joint.tangent_in.y, joint.tangent_in.x};
        constexpr int kNormals = 5;
        for (int k = 0; k < kNormals; ++k) {
            const double phi = -joint.turn * k / (kNormals - 1);  // clockwise
            const Vec2 n{std::cos(phi) * first.x - std::sin(phi) * first.y,
                         std::sin(phi) * first.x + std::cos(phi) * first.y};
            arrows.push_back({kMillimetres * joint.point.x, kMillimetres * joint.point.y,
                              kMillimetres * kFan * n.x, kMillimetres * kFan * n.y,
                              "fan of normals of a vertex", Ink::green});
        }
    }
    return arrows;
}

/// The names of all regions where their lattice nodes are on average.
std::vector<Label> names(const RegionMap& map) {
    const std::vector<int> regions = regions_of(map, kLattice);
    std::vector<Vec2> sum(static_cast<std::size_t>(map.count()));
    std::vector<double> nodes(sum.size(), 0.0);
    for (int row = 0; row < kLattice.rows; ++row) {
        for (int column = 0; column < kLattice.columns; ++column) {
            const int region = regions[static_cast<std::size_t>(row * kLattice.columns + column)];
            const Vec2 p = kLattice.node(column, row);
            if (map.external(region) && map.feet().closest(p).distance > 0.026) {
                continue;  // names stay near the object
            }
            sum[static_cast<std::size_t>(region)] += p;
            nodes[static_cast<std::size_t>(region)] += 1.0;
        }
    }
    std::vector<Label> labels;
    for (std::size_t i = 0; i < sum.size(); ++i) {
        const Vec2 at = kMillimetres * sum[i] / nodes[i];
        labels.push_back({at.x, at.y, map.name(static_cast<int>(i)),
                          map.external(static_cast<int>(i)) ? Ink::blue : Ink::vermillion});
    }
    return labels;
}

/// Twice round the object: first out at each vertex and in at each curve, then inside.
struct Tour {
    std::vector<double> t;
    std::vector<Vec2> hip;
    std::vector<int> region;
};

/// Distance from the middle at `angle`, m, in the first round: the vertices lie 120 degrees apart.
double first_round(double angle) {
    constexpr double kTop = 0.52 * std::numbers::pi;  // where the vertex on top is seen
    return 0.038 + 0.022 * std::cos(3.0 * (angle - kTop));
}

Tour tour(const RegionMap& map) {
    constexpr double kTurnIn = 0.08;  // of a round, from the first to the second
    Tour out;
    const int ticks = static_cast<int>(2.0 * kRound / kTick);
    for (int i = 0; i <= ticks; ++i) {
        const double rounds = 2.0 * static_cast<double>(i) / ticks;
        const double angle = 2.0 * std::numbers::pi * (0.43 - rounds);  // clockwise
        const double share = std::clamp((rounds - 1.0) / kTurnIn + 0.5, 0.0, 1.0);
        const double away = (1.0 - share) * first_round(angle) + share * kInner;
        out.t.push_back(i * kTick);
        out.hip.push_back(away * Vec2{std::cos(angle), std::sin(angle)});
        out.region.push_back(map.at(out.hip.back()));
    }
    return out;
}

std::vector<std::size_t> switches(const Tour& tour) {
    std::vector<std::size_t> at;
    for (std::size_t i = 1; i < tour.region.size(); ++i) {
        if (tour.region[i] != tour.region[i - 1]) {
            at.push_back(i);
        }
    }
    return at;
}

Panel tour_panel(const RegionMap& map, const Tour& tour) {
    Panel panel = plane_mm("(a) Path", 400.0);
    const std::vector<Border> pieces = borders(map, kLattice);
    panel.series = {outline_mm(curves_of(three_curves())), border_series(map, pieces, true),
                    border_series(map, pieces, false), path_mm("HIP", tour.hip)};
    panel.series.back().ink = Ink::green;
    panel.labels = names(map);
    const std::vector<std::size_t> at = switches(tour);
    for (std::size_t k = 0; k < at.size(); ++k) {
        const Vec2 p = kMillimetres * tour.hip[at[k]];
        panel.markers.push_back({p.x, p.y, std::to_string(k + 1)});
    }
    panel.x.low = -74.0;
    panel.x.high = 74.0;
    panel.y.low = -62.0;
    panel.y.high = 62.0;
    return panel;
}

/// Rows of the state axis: outside on top.
double row_of(const RegionMap& map, int region) {
    return static_cast<double>(map.count() - region);
}

Panel flow_panel(const RegionMap& map, const Tour& tour) {
    Panel panel{.title = "(b) Active region",
                .x = {.label = "time", .unit = "s"},
                .y = {.label = "region", .low = 0.4, .high = map.count() + 0.9},
                .height = 400.0};
    Series steps{.name = "", .x = {}, .y = {}, .ink = Ink::green, .width = 2.2};
    for (std::size_t i = 0; i < tour.t.size(); ++i) {
        if (i > 0 && tour.region[i] != tour.region[i - 1]) {
            steps.x.push_back(tour.t[i]);
            steps.y.push_back(row_of(map, tour.region[i - 1]));
        }
        steps.x.push_back(tour.t[i]);
        steps.y.push_back(row_of(map, tour.region[i]));
    }
    panel.series = {steps};
    for (int region = 0; region < map.count(); ++region) {
        panel.y.names.emplace_back(row_of(map, region), map.name(region));
    }
    const std::vector<std::size_t> at = switches(tour);
    for (std::size_t k = 0; k < at.size(); ++k) {
        panel.markers.push_back(
            {tour.t[at[k]], row_of(map, tour.region[at[k]]), std::to_string(k + 1)});
    }
    return panel;
}

std::string words_of(const RegionMap& map, const Tour& tour) {
    std::string words = map.name(tour.region.front());
    for (const std::size_t i : switches(tour)) {
        words += " → " + map.name(tour.region[i]);
    }
    return words;
}

}  // namespace

MadeFigure make_regions() {
    const Polygons object = three_curves();
    const RegionMap map(curves_of(object));
    const std::vector<Border> pieces = borders(map, kLattice);
    Panel panel = plane_mm("", 560.0);
    for (Series& s :
         std::vector<Series>{outline_mm(curves_of(object)), border_series(map, pieces, true),
                             border_series(map, pieces, false)}) {
        panel.series.push_back(std::move(s));
    }
    for (Series& s : control_points_mm(object)) {
        panel.series.push_back(std::move(s));
    }
    panel.arrows = fans(map.outline());
    panel.labels = names(map);
    panel.x.low = -78.0;
    panel.x.high = 78.0;
    panel.y.low = -66.0;
    panel.y.high = 66.0;
    Figure figure{.id = "fig_2_1_4",
                  .title = "Figure 2.1.4: internal and external Voronoi regions",
                  .panels = {panel},
                  .caption = ""};
    figure.caption = fmt::format(
        "Three cubics of four control points each close an object. On a lattice of {} x {} places "
        "the "
        "engine's global closest point says which feature is nearest: outside a curve (a, c, e) or "
        "a "
        "vertex (b, d, f), inside one of the three curves (1, 2, 3). Where two neighbours differ, "
        "the "
        "border between them is bisected to 1e-12 m. The external borders come out as the normals "
        "at "
        "the curves' ends; the internal ones as the bisectors of two curves, not as those normals "
        "drawn on into the object.",
        kLattice.columns, kLattice.rows);
    const auto end = [](const Border& b, int i) {
        return std::array<double, 4>{b.from.x, b.from.y, b.to.x,
                                     b.to.y}[static_cast<std::size_t>(i)];
    };
    std::vector<CsvColumn> table{
        column("region", pieces, [](const Border& b) { return b.region; }),
        column("other_region", pieces, [](const Border& b) { return b.other; })};
    const std::array<const char*, 4> heads{"from_x_m", "from_y_m", "to_x_m", "to_y_m"};
    for (int i = 0; i < 4; ++i) {
        table.push_back(column(heads[static_cast<std::size_t>(i)], pieces,
                               [&](const Border& b) { return end(b, i); }));
    }
    return {svg(figure), {{"", table}, {"_object", control_point_table(object)}}};
}

MadeFigure make_region_flow() {
    const RegionMap map(curves_of(three_curves()));
    const Tour path = tour(map);
    Figure figure{.id = "fig_2_1_5",
                  .title = "Figure 2.1.5: the active Voronoi region along a path",
                  .panels = {tour_panel(map, path), flow_panel(map, path)},
                  .columns = 2,
                  .share_x = false,
                  .width = 1080.0};
    figure.caption =
        "HIP goes twice round the object of figure 2.1.4, the second time inside. Numbers are the "
        "switches of "
        "the active region, as the engine's closest point finds them: " +
        words_of(map, path) + ".";
    return {svg(figure),
            {{"",
              {{"time_s", path.t},
               column("hip_x_m", path.hip, [](Vec2 p) { return p.x; }),
               column("hip_y_m", path.hip, [](Vec2 p) { return p.y; }),
               column("region", path.region, [](int r) { return r; })}}}};
}

MadeFigure make_region_graph() {
    const RegionMap map(curves_of(three_curves()));
    const Tour path = tour(map);
    const std::vector<std::array<int, 2>> pairs = neighbours(map, kLattice);
    Diagram diagram{.title = "Figure 2.1.5: which regions lie side by side",
                    .nodes = {},
                    .transitions = {},
                    .height = 470.0,
                    .node_width = 92.0,
                    .node_height = 42.0};
    for (int region = 0; region < map.count(); ++region) {
        const bool outside = map.external(region);
        const double turn = outside ? region : 2.0 * (region - map.count() * 2 / 3);
        const double angle = std::numbers::pi * (1.0 - turn / 3.0) - std::numbers::pi / 6.0;
        const double away = outside ? 195.0 : 82.0;
        diagram.nodes.push_back({map.name(region),
                                 !outside          ? "inside, curve"
                                 : region % 2 == 0 ? "outside, curve"
                                                   : "outside, vertex",
                                 380.0 + 1.55 * away * std::cos(angle),
                                 235.0 - away * std::sin(angle),
                                 outside ? Ink::blue : Ink::vermillion});
    }
    std::vector<CsvColumn> table{
        {"region", {}}, {"other_region", {}}, {"switches_of_the_path", {}}};
    const std::vector<std::size_t> at = switches(path);
    for (const auto& [a, b] : pairs) {
        const auto taken = std::count_if(at.begin(), at.end(), [&, a = a, b = b](std::size_t i) {
            return std::min(path.region[i], path.region[i - 1]) == a &&
                   std::max(path.region[i], path.region[i - 1]) == b;
        });
        diagram.transitions.push_back({.from = static_cast<std::size_t>(a),
                                       .to = static_cast<std::size_t>(b),
                                       .condition = taken > 0 ? fmt::format("{} ×", taken) : "",
                                       .shift_y = -11.0,
                                       .ink = taken > 0 ? Ink::green : Ink::grey,
                                       .width = taken > 0 ? 2.2 : 1.2,
                                       .two_way = true});
        table[0].values.push_back(a);
        table[1].values.push_back(b);
        table[2].values.push_back(static_cast<double>(taken));
    }
    diagram.caption =
        "The regions of figure 2.1.4 as states: two are joined if the engine found them at "
        "places 1e-12 m apart, on the borders "
        "between places of the lattice. Green with a number: so often the path of the figure "
        "before switched there. A closed smooth path can only go along these lines.";
    return {svg(diagram), {{"", table}}};
}

}  // namespace palpate::data

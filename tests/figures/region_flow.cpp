// Figure 2.1.5: how a path goes through the Voronoi regions of figure 2.1.4.
#include "tests/figures/drawing.hpp"
#include "tests/figures/make.hpp"
#include "tests/figures/region_drawing.hpp"
#include "tests/figures/svg_diagram.hpp"

namespace palpate::figures {
namespace {

using engine::Vec2;

constexpr double kRound = 4.0;    // s, once round the object
constexpr double kInner = 0.012;  // m, radius of the second round

/// Twice round the object: first out at each vertex and in at each curve, then inside.
struct Tour {
    std::vector<double> t;
    std::vector<Vec2> hip;
    std::vector<int> region;
};

/// Distance from the middle at `angle`, m, in the first round: the vertices lie 120 degrees apart.
double first_round(double angle) {
    constexpr double kTop = 0.52 * std::numbers::pi;  // where the vertex on top is seen
    return 0.036 + 0.018 * std::cos(3.0 * (angle - kTop));
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
                    border_series(map, pieces, false), path_mm("HIP", tour.hip, {Ink::green})};
    panel.labels = region_names(map);
    panel.markers =
        numbered(switches(tour), [&](std::size_t i) { return kMillimetres * tour.hip[i]; });
    look_at(panel, -74.0, 74.0, -62.0, 62.0);
    return panel;
}

/// Rows of the state axis: outside on top.
double row_of(const RegionMap& map, int region) {
    return static_cast<double>(map.count() - region);
}

Panel flow_panel(const RegionMap& map, const Tour& tour) {
    Panel panel = time_panel("(b) Active region", "region", "", 400.0);
    panel.y.low = 0.4;
    panel.y.high = map.count() + 0.9;
    Series steps{.name = "", .x = {}, .y = {}, .ink = Ink::green, .width = 2.2};
    for (std::size_t i = 0; i < tour.t.size(); ++i) {
        if (i > 0 && tour.region[i] != tour.region[i - 1]) {
            steps.add(tour.t[i], row_of(map, tour.region[i - 1]));
        }
        steps.add(tour.t[i], row_of(map, tour.region[i]));
    }
    panel.series = {steps};
    for (int region = 0; region < map.count(); ++region) {
        panel.y.names.emplace_back(row_of(map, region), map.name(region));
    }
    panel.markers = numbered(switches(tour), [&](std::size_t i) {
        return Vec2{tour.t[i], row_of(map, tour.region[i])};
    });
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
        "HIP goes twice round the object of figure 2.1.4, the second time inside. Numbers are "
        "the switches of the active region, as the engine's closest point finds them: " +
        words_of(map, path) + ".";
    std::vector<CsvColumn> table{{"time_s", path.t}};
    add_vectors(table, "hip", "m", path.hip, std::identity());
    table.push_back(column("region", path.region, std::identity()));
    return {svg(figure), {{"", table}}};
}

MadeFigure make_region_graph() {
    const RegionMap map(curves_of(three_curves()));
    const Tour path = tour(map);
    const std::vector<std::array<int, 2>> pairs = neighbours(map, kLattice);
    Diagram diagram{.title = "Figure 2.1.5: which regions lie side by side",
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
        const Node& one = diagram.nodes[static_cast<std::size_t>(a)];
        const Node& two = diagram.nodes[static_cast<std::size_t>(b)];
        const Vec2 way = glm::normalize(Vec2{two.x - one.x, two.y - one.y});
        const double up = way.x > 0.0 ? -1.0 : 1.0;  // y goes down the page
        diagram.transitions.push_back({.from = static_cast<std::size_t>(a),
                                       .to = static_cast<std::size_t>(b),
                                       .condition = taken > 0 ? fmt::format("{} ×", taken) : "",
                                       .shift_x = -18.0 * up * way.y,
                                       .shift_y = 13.0 * up * way.x,
                                       .ink = taken > 0 ? Ink::green : Ink::grey,
                                       .width = taken > 0 ? 2.2 : 1.2,
                                       .two_way = true});
        add_row(table,
                {static_cast<double>(a), static_cast<double>(b), static_cast<double>(taken)});
    }
    diagram.caption =
        "The regions of figure 2.1.4 as states. Two are joined if the engine found both within "
        "1e-12 m, on either side of a border. Green with a number: so often the path of the "
        "figure before switched there. HIP can go from region to region only along these lines.";
    return {svg(diagram), {{"", table}}};
}

}  // namespace palpate::figures

#include "tests/figures/region_drawing.hpp"

namespace palpate::figures {

using engine::Vec2;

Series border_series(const RegionMap& map, const std::vector<Border>& pieces, bool external) {
    std::vector<Vec2> points;
    for (const Border& b : pieces) {
        if (map.external(b.region) == external) {
            points.insert(points.end(), {b.from, b.to, gap()});
        }
    }
    return external ? path_mm("external borders: normals at the ends", points, {Ink::blue, 1.4})
                    : path_mm("internal borders: equally far from two curves", points,
                              {Ink::vermillion, 1.4});
}

std::vector<Label> region_names(const RegionMap& map) {
    constexpr double kReach = 0.036;  // m
    const std::vector<int> regions = regions_of(map, kLattice);
    std::vector<Vec2> sum(static_cast<std::size_t>(map.count()));
    std::vector<double> nodes(sum.size(), 0.0);
    for (int row = 0; row < kLattice.rows; ++row) {
        for (int column = 0; column < kLattice.columns; ++column) {
            const int region = regions[static_cast<std::size_t>(row * kLattice.columns + column)];
            const Vec2 p = kLattice.node(column, row);
            if (map.external(region) && map.feet().closest(p).distance > kReach) {
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

}  // namespace palpate::figures

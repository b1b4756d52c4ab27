#pragma once

#include "engine/contact/closest_point.hpp"
#include "tests/support/std.hpp"

namespace palpate::figures {

/// The Voronoi regions of a closed outline of n curves with n convex vertices, as the engine finds
/// them: external 0 .. 2n - 1, curve i at 2 i and the vertex at its end at 2 i + 1; internal 2n +
/// i, of curve i.
class RegionMap {
public:
    /// @param curves  joined end to end and closed, the object on the right of travel
    explicit RegionMap(const std::vector<engine::NurbsCurve<2>>& curves);

    [[nodiscard]] int at(const engine::Vec2& h) const;
    [[nodiscard]] int count() const noexcept { return 3 * curves_; }
    [[nodiscard]] bool external(int region) const noexcept { return region < 2 * curves_; }
    /// "a", "b", ... outside, "1", "2", ... inside.
    [[nodiscard]] std::string name(int region) const;

    [[nodiscard]] const engine::Outline& outline() const noexcept { return outline_; }
    [[nodiscard]] const engine::OutlineFeet& feet() const noexcept { return feet_; }

private:
    int curves_;
    engine::Outline outline_;
    engine::OutlineFeet feet_;
};

/// A square lattice of nodes, m.
struct Lattice {
    engine::Vec2 low{};
    double step = 0.001;
    int columns = 2;
    int rows = 2;

    [[nodiscard]] engine::Vec2 node(int column, int row) const noexcept {
        return low + step * engine::Vec2{static_cast<double>(column), static_cast<double>(row)};
    }
};

/// A piece of the border between two regions.
struct Border {
    engine::Vec2 from{};
    engine::Vec2 to{};
    int region = 0;  ///< lower number
    int other = 0;
};

/// The borders between regions of the same side of the outline, one piece a cell: where two nodes
/// of a cell's edge lie in different regions, the place between them is bisected to 1e-12 m.
[[nodiscard]] std::vector<Border> borders(const RegionMap& map, const Lattice& lattice);

/// Region of each node, row by row.
[[nodiscard]] std::vector<int> regions_of(const RegionMap& map, const Lattice& lattice);

/// Pairs (low, high) of regions that meet on a line between two nodes, sorted, each once: both
/// sides of the place, bisected to 1e-12 m, where the region changes.
[[nodiscard]] std::vector<std::array<int, 2>> neighbours(const RegionMap& map,
                                                         const Lattice& lattice);

}  // namespace palpate::figures

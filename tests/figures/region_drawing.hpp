#pragma once

#include "tests/figures/drawing.hpp"
#include "tests/figures/region_map.hpp"

/// What figures 2.1.4 and 2.1.5 draw of the regions; in mm.
namespace palpate::figures {

/// Where the regions of the object of three curves are looked for. Off its vertices by a little.
inline constexpr Lattice kLattice{
    .low = {-0.08007, -0.07011}, .step = 0.001, .columns = 161, .rows = 141};

/// The borders on one side of the outline.
[[nodiscard]] Series border_series(const RegionMap& map,
                                   const std::vector<Border>& pieces,
                                   bool external);

/// The names of all regions, where their lattice nodes near the object are on average.
[[nodiscard]] std::vector<Label> region_names(const RegionMap& map);

}  // namespace palpate::figures

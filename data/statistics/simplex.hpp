#pragma once

#include <functional>
#include <span>
#include <vector>

namespace palpate::data {

/// Where a search without derivatives ended.
struct SimplexMaximum {
    std::vector<double> at{};
    double value = 0.0;
    bool settled = false;  ///< begun anew there it gains less than 1e-9
};

/// A maximum near `start` by the simplex of J. A. Nelder, R. Mead, Computer J. 7:308, 1965, begun
/// anew where it ended, up to 12 times.
/// @param value  of a point; may be -infinity
/// @param edge   length of the first edge along each parameter, not 0
[[nodiscard]] SimplexMaximum simplex_maximum(
    const std::function<double(std::span<const double>)>& value,
    std::vector<double> start,
    std::vector<double> edge);

}  // namespace palpate::data

#pragma once

#include <string>

#include "data/plot/figure.hpp"

namespace palpate::data {

/// The figure as a standalone SVG 1.1 text, without scripts, fonts or files of its own. The same
/// figure gives the same bytes. Points nearer than 0.15 px to the one drawn before are left out of
/// a line.
/// @throws std::invalid_argument: x and y of different length, no panel, an empty or non-positive
///         log range, sizes out of range
[[nodiscard]] std::string svg(const Figure& figure);

}  // namespace palpate::data

#pragma once

#include "tests/support/nurbs_oracle.hpp"

namespace palpate::tests {

/// A curve, and the places where it is at its worst.
struct NastyFamily {
    std::string name;
    NurbsData<2> curve;
    std::vector<double> u;              ///< of cusps, kinks, crossings; may be empty
    std::vector<engine::Vec2> centres;  ///< points with many feet; may be empty
};

inline constexpr std::uint64_t kNastyCurves = 19;

/// Family `index`, drawn once: about 1 m large.
[[nodiscard]] NastyFamily nasty_family(std::uint64_t index, Random& random);

}  // namespace palpate::tests

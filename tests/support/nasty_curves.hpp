#pragma once

#include "tests/support/nurbs_oracle.hpp"

/// Queries that break closest-point solvers: degree 1 to 9, weights 1e-3 to 1e3, sizes 1e-6 to 1e3
/// m.
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

struct NastyCase {
    std::string name;  ///< "cusp, on the axis of symmetry"
    std::uint64_t seed = 0;
    NurbsData<2> curve;
    engine::Vec2 query{};
};

/// A family of curves goes with a family of queries; kNastyRound seeds in a row are every pair
/// once.
inline constexpr std::uint64_t kNastyQueries = 13;
inline constexpr std::uint64_t kNastyRound = kNastyCurves * kNastyQueries;

/// One seed is one case, on every machine and for ever: add families only at the end of their list.
[[nodiscard]] NastyCase nasty_case(std::uint64_t seed);

/// Diagonal of the box of the control points, m.
[[nodiscard]] double size_of(const NurbsData<2>& curve);

/// Everything that is needed to replay the case by hand, 17 digits.
[[nodiscard]] std::string text_of(const NastyCase& nasty);

}  // namespace palpate::tests

#pragma once

#include <cstdint>
#include <functional>

#include "data/fit/curve_model.hpp"

/// Maxima of a CurveModel by two methods that share nothing but the value.
namespace palpate::data {

/// Where a search ended.
struct Optimum {
    CurvePoint at{};
    double value = 0.0;
    bool settled = false;  ///< a further step would gain less than the tolerance
};

/// Fisher scoring from `start` with Levenberg's damping, inside the model's ends: a step that gains
/// nothing is made shorter, a parameter that would leave its range stays at the end.
/// @param free       which parameters move
/// @param tolerance  of the log-likelihood
[[nodiscard]] Optimum climb(const CurveModel& model,
                            const CurvePoint& start,
                            const CurveMask& free,
                            double tolerance = 1e-12);

[[nodiscard]] double dot(const CurvePoint& a, const CurvePoint& b);  ///< the sum of a[i] b[i]
[[nodiscard]] CurvePoint times(const CurveMatrix& matrix, const CurvePoint& vector);  ///< M v

/// A step of Fisher scoring.
struct DampedStep {
    CurvePoint gradient{};      ///< of what is free and would not leave its range; else 0
    CurveMatrix information{};  ///< damped, of all
    CurveMatrix inverse{};      ///< of these
    CurvePoint move{};

    DampedStep(const CurveModel& model,
               const CurvePoint& at,
               const CurvePoint& slopes,
               const CurveMatrix& curvature,
               const CurveMask& free,
               double damping);
};

/// How many starts the maximum is looked for from.
enum class Search : std::uint8_t {
    quick,    ///< slopes in factors of two; from the four best points
    thorough  ///< in factors of the root of two; from the two best of each slope
};

/// The highest maximum found.
struct Highest {
    Optimum best{};
    CurvePoint start{};  ///< the highest point of the grid from which it was reached
};

/// The highest of climb() from `near` and from the highest points of a grid, none of whose
/// neighbours at its slope is higher: locations from half of the levels' range below to half above,
/// in between all levels, and where the curve passes through the share of a level; slopes from 0.25
/// / range to the steepest; rates. What is not free stays as in `near`; where a JND or Weber
/// fraction is held, the slope follows from the location.
[[nodiscard]] Highest highest(const CurveModel& model,
                              const CurvePoint& near,
                              const CurveMask& free,
                              Search search,
                              double tolerance = 1e-12);

/// The simplex of J. A. Nelder, R. Mead, Computer J. 7:308, 1965, begun anew inside all ranges
/// where it ended until that gains less than 1e-9. Knows no derivative.
[[nodiscard]] Optimum nelder_mead(const CurveModel& model,
                                  const CurvePoint& start,
                                  const CurveMask& free);

/// The least of a loss between two places (both among them), which may have several dips: a grid
/// finds the deepest, and golden section its bottom, to 1e-10 of it.
[[nodiscard]] double least_between(const std::function<double(double)>& loss,
                                   double one,
                                   double other);

/// The inverse of the rows and columns of `used`; 0 elsewhere. All 0 if it is not positive
/// definite.
[[nodiscard]] CurveMatrix inverse(const CurveMatrix& matrix, const CurveMask& used);

}  // namespace palpate::data

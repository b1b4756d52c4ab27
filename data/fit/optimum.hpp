#pragma once

#include "data/fit/curve_model.hpp"

/// Maxima of a CurveModel by two methods that share nothing but the value.
namespace palpate::data {

struct Optimum {
    CurvePoint at{};
    double value = 0.0;
    bool settled = false;  ///< a further step would gain less than the tolerance
};

/// Fisher scoring from `start` with Levenberg's damping, inside the model's ends: a step that gains nothing is made
/// shorter, a parameter that would leave its range stays at the end.
/// @param free       which parameters move
/// @param tolerance  of the log-likelihood
[[nodiscard]] Optimum climb(const CurveModel& model,
                            const CurvePoint& start,
                            const CurveMask& free,
                            double tolerance = 1e-12);

/// The simplex of J. A. Nelder, R. Mead, Computer J. 7:308, 1965, begun anew where it ended until that gains less than
/// 1e-9. Knows no derivative.
[[nodiscard]] Optimum nelder_mead(const CurveModel& model,
                                  const CurvePoint& start,
                                  const CurveMask& free);

/// The inverse of the rows and columns of `used`; 0 elsewhere. All 0 if it is not positive definite.
[[nodiscard]] CurveMatrix inverse(const CurveMatrix& matrix, const CurveMask& used);

}  // namespace palpate::data

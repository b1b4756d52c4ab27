#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

/// Algebra of a few unknowns, and what is found by it. The only door to Eigen's matrices of any
/// size, whose headers cost a compiler seconds.
///
/// A matrix of n x n is its rows one after the other. Of a symmetric one the upper half is read.
namespace palpate::data {

/// x of A x = b, A symmetric, by L D L' with pivots. Of an A that is not positive definite some x,
/// which need not be finite: ask it. @param a  n x n   @param b  n, at least one
[[nodiscard]] std::vector<double> solve_symmetric(std::span<const double> a,
                                                  std::span<const double> b);

/// Nodes and weights of the integral of e^(-z^2) f(z) (Gauss-Hermite).
struct Nodes {
    std::vector<double> at{};
    std::vector<double> weight{};
};
/// By Golub and Welsch (Math. Comput. 23:221, 1969). @pre 1 <= count <= 40
[[nodiscard]] Nodes gauss_hermite(int count);

/// A smooth function of a few numbers.
using SmoothFunction = std::function<double(std::span<const double>)>;

/// Where a search for a minimum ended.
struct Minimum {
    std::vector<double> at{};
    double value = 0.0;
    bool converged = false;  ///< no derivative is as large as 1e-3
};

/// A minimum by BFGS (C. G. Broyden, R. Fletcher, D. Goldfarb, D. F. Shanno, 1970) with central
/// differences: until no derivative is as large as 1e-6, or no step gains; at most 200 steps, none
/// longer than 2 along any number.
[[nodiscard]] Minimum minimum_near(const SmoothFunction& f, std::span<const double> start);

/// Up to two of Newton's steps, each as long as it gains or moves by rounding alone.
void polish(const SmoothFunction& f, Minimum& best);

/// The inverse of the second derivatives by differences of 1e-3, n x n. None where they bound
/// nothing: the smallest eigenvalue is not above 1e-8 of the largest.
[[nodiscard]] std::optional<std::vector<double>> inverse_curvature(const SmoothFunction& f,
                                                                   std::span<const double> at);

/// Where a search without derivatives ended.
struct SimplexMaximum {
    std::vector<double> at{};
    double value = 0.0;
};

/// A maximum near `start` by the simplex of J. A. Nelder, R. Mead, Computer J. 7:308, 1965, begun
/// anew where it ended, up to 12 times, until that gains less than 1e-9.
/// @param value  of a point; may be -infinity
/// @param edge   length of the first edge along each parameter, not 0
[[nodiscard]] SimplexMaximum simplex_maximum(const SmoothFunction& value,
                                             std::vector<double> start,
                                             std::vector<double> edge);

/// What a function is at a place.
struct Reading {
    double at = 0.0;
    double value = 0.0;
};

/// Where a function that is nearly a straight line has a value that lies between two readings of
/// it, to within `tolerance` of the value: false position, halving at times, where the line is
/// bent.
/// @param near  below the value   @param far  at it or above, elsewhere
[[nodiscard]] double crossing(const std::function<double(double)>& f,
                              double wanted,
                              Reading near,
                              Reading far,
                              double tolerance);

}  // namespace palpate::data

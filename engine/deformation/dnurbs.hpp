#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/geometry/nurbs_curve.hpp"
#include "engine/geometry/vec.hpp"

/// Dynamic NURBS (D-NURBS): a curve with mass, damping, tension and rigidity that a force deforms.
///
///     M q'' + D q' + K q = R(u)^T F,    q = p - p_rest        thesis eq. 4.5 to 4.9; Terzopoulos &
///     M = int mu R^T R du,  D = int gamma R^T R du            Qin 1994, ACM Trans. Graphics 13(2)
///     K = int alpha R'^T R' + beta R''^T R'' du
///
/// R(u) are the rational basis functions of fixed weights, so that the matrices are constant and
/// the two axes do not see one another. Departures from the thesis: its K p pulls the curve
/// together to a point, so the rest shape is subtracted; nothing holds its curve, so control points
/// can be fixed. Weights stay as they are: as generalised coordinates they would make M singular
/// along their common scale (all weights times the same factor are the same curve).
///
/// Integrals are sums over the knot intervals with Gauss-Legendre points: degree + 1 where all
/// weights are equal, which is exact; else 16, and twice as many until nothing changes any more (16
/// alone leave a relative error of 3e-8 in the rigidity of weights 1, 2, 0.5, 1, and more where
/// weights differ more). Where an inner knot makes a kink, nothing resists its bending: intervals
/// know nothing of one another's second derivatives.
namespace palpate::engine {

/// What a deformable curve is made of. Densities are per unit of u, the same everywhere on the
/// curve.
struct DnurbsSpec {
    int degree = 3;
    std::vector<double> knots{};
    std::vector<Vec2> points{};        ///< control points at rest, m
    std::vector<double> weights{};     ///< > 0; empty: all 1
    double mu = 0.0;                   ///< mass, kg, >= 0
    double gamma = 0.0;                ///< damping, N s/m, >= 0
    double alpha = 0.0;                ///< tension, N/m, >= 0
    double beta = 0.0;                 ///< rigidity, N/m, >= 0
    std::vector<std::size_t> fixed{};  ///< control points that do not move
};

/// The basis functions that are not zero at u: R of control points first, first + 1, ...
struct BasisAt {
    std::size_t first = 0;
    std::vector<double> value{};  ///< sum 1
    std::vector<double> first_derivative{};
    std::vector<double> second_derivative{};
};

/// A deformable curve: its matrices, and where it comes to rest.
class Dnurbs {
public:
    /// @throws std::invalid_argument with the key, the value and the remedy
    explicit Dnurbs(DnurbsSpec spec);

    /// As it was given; how many control points it has; and the ends of its domain.
    [[nodiscard]] const DnurbsSpec& spec() const noexcept { return spec_; }
    [[nodiscard]] std::size_t points() const noexcept { return spec_.points.size(); }
    [[nodiscard]] double front() const noexcept { return knots_.front(); }
    [[nodiscard]] double back() const noexcept { return knots_.back(); }

    /// R and its derivatives at u, Piegl & Tiller, The NURBS Book, eq. 2.5, 2.9 and 4.8. @param u
    /// in [front, back]
    [[nodiscard]] BasisAt basis(double u) const;
    /// The point C(u) when the control points are displaced. @param displacements as many as
    /// points, m
    [[nodiscard]] Vec2 point(double u, std::span<const Vec2> displacements) const;

    /// Entries of M, D and K for the control points i and j; kg, N s/m and N/m.
    [[nodiscard]] double mass(std::size_t i, std::size_t j) const {
        return spec_.mu * gram_[at(i, j)];
    }
    [[nodiscard]] double damping(std::size_t i, std::size_t j) const {
        return spec_.gamma * gram_[at(i, j)];
    }
    [[nodiscard]] double stiffness(std::size_t i, std::size_t j) const {
        return stiffness_[at(i, j)];
    }

    /// The control points that move, in their order.
    [[nodiscard]] const std::vector<std::size_t>& moving() const noexcept { return moving_; }

    /// Displacements at rest under a force, m: K q = R(u)^T F by Cholesky. Relative accuracy: that
    /// of the integrals, or 1e-16 times the condition of K if that is more.
    /// @param force  N, finite
    /// @throws std::invalid_argument if K leaves a motion free: then no force has an equilibrium
    [[nodiscard]] std::vector<Vec2> equilibrium(double u, const Vec2& force) const;

    /// omega_1, rad/s, of the slowest motion without its damping: the least omega of K x = omega^2
    /// M x. 0 if nothing moves, or if K leaves a motion free. Relative accuracy 1e-4.
    /// @pre mu > 0
    [[nodiscard]] double slowest_motion() const;

private:
    void assemble(std::size_t gauss_points);
    [[nodiscard]] std::size_t at(std::size_t i, std::size_t j) const noexcept {
        return i * points() + j;
    }

    DnurbsSpec spec_;
    KnotVector knots_;
    std::vector<double> weights_;
    std::vector<std::size_t> moving_;
    std::vector<double> gram_;       ///< int R^T R du, row by row
    std::vector<double> stiffness_;  ///< K, N/m
};

/// Its motion in steps of one length by the trapezoid rule, factored once: second order, stable at
/// any step, and without numerical damping. Energy is 1/2 v^T M v + 1/2 q^T K q; a step loses h
/// v_m^T D v_m of it, v_m the mean of the two velocities, and gains the force times the way of its
/// point.
class DnurbsMotion {
public:
    /// At rest. @param step  s, > 0
    /// @throws std::invalid_argument if mu is 0: what weighs nothing has no velocity of its own
    DnurbsMotion(const Dnurbs& curve, double step);

    /// One step under a force at u that stays the same within it. No allocation.
    /// @param force  N, finite
    void advance(const BasisAt& where, const Vec2& force) noexcept;

    /// Displacements, m, and velocities, m/s, of all control points.
    [[nodiscard]] const std::vector<Vec2>& displacements() const noexcept { return q_; }
    [[nodiscard]] const std::vector<Vec2>& velocities() const noexcept { return v_; }
    [[nodiscard]] double step() const noexcept { return h_; }

private:
    double h_;
    std::vector<std::size_t> moving_;
    std::vector<std::size_t>
        place_;                  ///< of a control point among those that move; none: their number
    std::vector<double> keep_;   ///< M - h/2 D - h^2/4 K, row by row
    std::vector<double> pull_;   ///< h K
    std::vector<double> lower_;  ///< Cholesky factor of M + h/2 D + h^2/4 K
    std::vector<Vec2> q_, v_;
    std::vector<Vec2> side_;  ///< right side, then the new velocities
};

}  // namespace palpate::engine

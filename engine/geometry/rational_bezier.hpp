#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

#include "engine/geometry/vec.hpp"

namespace palpate::engine {

/// Highest degree of a curve span.
inline constexpr int kMaxDegree = 9;

/// Largest coordinate of a control point, m, and the range of weights: beyond them products of
/// three weights and two lengths, as the closest point needs them, would leave the range of
/// doubles.
inline constexpr double kMaxCoordinate = 1e9;
inline constexpr double kMinWeight = 1e-12;
inline constexpr double kMaxWeight = 1e12;

/// @throws std::invalid_argument if control point `index` or its weight is no such thing
template <int D>
void check_control_point(const Vec<D>& point, double weight, std::size_t index);

/// Point and derivatives of a curve at one parameter: m, m, m per unit of u.
template <int D>
struct Jet {
    Vec<D> point{};
    Vec<D> first{};
    Vec<D> second{};
};

/// A curve that moves less than this share of its own bending, |C'| < 1e-6 |C''|, stands still: an
/// end with repeated control points, or a cusp. No Taylor series helps there, and the tangent is
/// that of the end.
inline constexpr double kStill2 = 1e-12;
/// An end of a span, in u: where C' vanishes at the end itself, no more of the span stands still.
inline constexpr double kStillEnd = 1e-5;

/// Whether the curve all but stands still at this jet.
template <int D>
[[nodiscard]] bool stands_still(const Jet<D>& jet) noexcept {
    return glm::dot(jet.first, jet.first) <= kStill2 * glm::dot(jet.second, jet.second);
}

/// Whether a step of u from this jet turns the tangent by less than 2^-27, which Taylor's series of
/// second order then gives to 1e-16.
template <int D>
[[nodiscard]] bool is_straight_step(const Jet<D>& jet, double step) noexcept {
    constexpr double kTurn2 = 0x1p-54;
    const double speed2 = glm::dot(jet.first, jet.first);
    const double bend2 = glm::dot(jet.second, jet.second);
    return speed2 > kStill2 * bend2 && step * step * std::max(speed2, bend2) <= kTurn2 * speed2;
}

/// One rational Bezier span in D = 2 or 3 dimensions, u in [0, 1].
///
///     C(u) = sum w_i B_i(u) P_i / sum w_i B_i(u)        Piegl & Tiller, The NURBS Book, eq. 4.1
///
/// Every NURBS curve is a row of such spans. Coordinates are kept about the middle of the control
/// points. Polynomials up to degree 3 are evaluated by Horner's scheme (error below 1e-15 of the
/// size); all others by de Casteljau's corner cutting in homogeneous coordinates (below 5e-16 for
/// weights of 1e-3 to 1e3, where Horner loses up to 7 digits).
template <int D>
class RationalBezier {
public:
    /// @param points   degree + 1 control points, m, finite
    /// @param weights  as many, each finite and > 0
    /// @param about    what the points are relative to, m: far away they keep their digits
    /// @throws std::invalid_argument naming what is wrong, the value and the remedy
    RationalBezier(std::span<const Vec<D>> points,
                   std::span<const double> weights,
                   const Vec<D>& about = Vec<D>{});

    /// 1 to kMaxDegree.
    [[nodiscard]] int degree() const noexcept { return degree_; }
    /// All weights are the same.
    [[nodiscard]] bool polynomial() const noexcept { return polynomial_; }
    [[nodiscard]] Vec<D> point(std::size_t i) const noexcept { return origin_ + local_[i]; }
    [[nodiscard]] double weight(std::size_t i) const noexcept { return weights_[i]; }
    [[nodiscard]] std::span<const double> weights() const noexcept {
        return std::span(weights_).first(static_cast<std::size_t>(degree_) + 1);
    }
    [[nodiscard]] const Box<D>& box() const noexcept { return box_; }  ///< of the control points

    /// Middle of the box; local control points and their weighted forms are relative to it.
    [[nodiscard]] const Vec<D>& origin() const noexcept { return origin_; }
    [[nodiscard]] const Vec<D>& local_point(std::size_t i) const noexcept { return local_[i]; }

    /// C, C' and C'' at u; u is not clamped.
    [[nodiscard]] Jet<D> at(double u) const noexcept { return at(u, 1.0 - u); }
    /// The same for u + v = 1, each with all its digits: beside a heavy last control point one bit
    /// of u may be 1e-10 of the size.
    [[nodiscard]] Jet<D> at(double u, double v) const noexcept {
        Jet<D> jet = local_at(u, v);
        jet.point = origin_ + jet.point;
        return jet;
    }
    /// The same with C relative to origin(): far from the world's origin it has more digits.
    [[nodiscard]] Jet<D> local_at(double u, double v) const noexcept {
        return horner_ ? by_horner(u) : by_corner_cutting(u, v);
    }

    /// Taylor's series of a jet is the curve: a polynomial up to degree 3.
    [[nodiscard]] bool is_its_taylor_series() const noexcept { return horner_; }
    /// Its coefficients of u^k then, about origin().
    [[nodiscard]] const Vec<D>& power(std::size_t k) const noexcept { return power_[k]; }
    /// The jet a step `du` beside one of this curve, by Taylor's series: of third order where that
    /// is the curve itself, of second order elsewhere. Its point is right to a few last bits of the
    /// step.
    [[nodiscard]] Jet<D> beside(const Jet<D>& jet, double du) const noexcept {
        const Vec<D>& cubic = power_[3];
        return {.point = jet.point + du * (jet.first + du * (0.5 * jet.second + du * cubic)),
                .first = jet.first + du * (jet.second + (3.0 * du) * cubic),
                .second = jet.second + (6.0 * du) * cubic};
    }

private:
    [[nodiscard]] Jet<D> by_horner(double u) const noexcept {
        const auto& c = power_;
        Jet<D> jet;
        jet.point = c[0] + u * (c[1] + u * (c[2] + u * c[3]));
        jet.first = c[1] + u * (2.0 * c[2] + (3.0 * u) * c[3]);
        jet.second = 2.0 * c[2] + (6.0 * u) * c[3];
        return jet;
    }
    [[nodiscard]] Jet<D> by_corner_cutting(double u, double v) const noexcept;
    template <int N>
    [[nodiscard]] Jet<D> cut(double u, double v) const noexcept;

    Vec<D> origin_{};
    std::array<Vec<D>, 4> power_{};  ///< coefficients of 1, u, u^2, u^3 when horner_
    bool horner_ = false;
    bool polynomial_ = false;
    int degree_ = 1;
    std::array<Vec<D>, kMaxDegree + 1> weighted_{};  ///< w_i (P_i - origin)
    std::array<double, kMaxDegree + 1> weights_{};
    std::array<Vec<D>, kMaxDegree + 1> local_{};
    Box<D> box_{};
};

extern template class RationalBezier<2>;
extern template class RationalBezier<3>;

}  // namespace palpate::engine

#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/geometry/rational_bezier.hpp"

namespace palpate::engine {

/// Four doubles in two registers: homogeneous coordinates (w x, w y, w z, w). SSE2 is part of every
/// x86-64, and each lane is one IEEE operation, so that all machines agree to the bit. A bare
/// `Quad q;` holds rubbish: clearing scratch arrays would cost as much as an evaluation.
struct Quad {
    using Pair [[gnu::vector_size(16)]] = double;

    Pair xy;
    Pair zw;

    /// The weight; and the first three coordinates, which are w P, not P.
    [[nodiscard]] double w() const noexcept { return zw[1]; }
    [[nodiscard]] Vec3 xyz() const noexcept { return Vec3{xy[0], xy[1], zw[0]}; }

    Quad& operator+=(const Quad& b) noexcept {
        xy += b.xy;
        zw += b.zw;
        return *this;
    }
    friend Quad operator+(const Quad& a, const Quad& b) noexcept {
        return {a.xy + b.xy, a.zw + b.zw};
    }
    friend Quad operator-(const Quad& a, const Quad& b) noexcept {
        return {a.xy - b.xy, a.zw - b.zw};
    }
    friend Quad operator*(double s, const Quad& a) noexcept { return {s * a.xy, s * a.zw}; }
};

/// (p, w), both as they are: p is not multiplied by w.
[[nodiscard]] inline Quad quad(const Vec3& p, double w) noexcept {
    return Quad{Quad::Pair{p.x, p.y}, Quad::Pair{p.z, w}};
}

/// What a call may still compute, in about two multiply-adds; a third of a nanosecond each on the
/// machines of today. Counted, so that a bound on it is the same on every machine and every run.
using Work = std::int64_t;

/// Point and derivatives of a surface at one (u, v): m, m per unit of u or v, and so on.
/// Each lies in a place of four doubles, as it is written by the registers of AVX2.
struct SurfaceJet {
    alignas(16) Vec3 point{};
    alignas(16) Vec3 du{};
    alignas(16) Vec3 dv{};
    alignas(16) Vec3 duu{};
    alignas(16) Vec3 duv{};
    alignas(16) Vec3 dvv{};
};

/// Curvature of the normal section in the direction a du + b dv, 1/m, > 0: the surface curves away
/// from its normal, as a ball seen from outside does (the convention of engine/geometry/arc.hpp). 0
/// for no direction.
[[nodiscard]] inline double normal_curvature(const SurfaceJet& jet,
                                             const Vec3& normal,
                                             double a,
                                             double b) noexcept {
    const Vec3 direction = a * jet.du + b * jet.dv;
    const double length2 = glm::dot(direction, direction);
    const Vec3 bend = (a * a) * jet.duu + (2.0 * a * b) * jet.duv + (b * b) * jet.dvv;
    return length2 > 0.0 ? -glm::dot(bend, normal) / length2 : 0.0;
}

/// One rational Bezier patch, u and v in [0, 1].
///
///     S(u, v) = sum B_i(u) B_j(v) w_ij P_ij / sum B_i(u) B_j(v) w_ij     The NURBS Book, eq. 4.11
///
/// A polynomial of degree up to 3 x 3 is evaluated from powers of u and v (error below 1e-15 of the
/// size); everything else in homogeneous coordinates by convex combinations, de Casteljau's corner
/// cutting or Bernstein polynomials (below 1e-15 for weights of 1e-3 to 1e3).
class BezierPatch {
public:
    /// @param net         w_ij (P_ij, 1), place i (degree_v + 1) + j; (degree_u + 1)(degree_v + 1)
    ///                    of them, all w > 0; P relative to a local origin that the caller keeps
    /// @param polynomial  all weights are 1
    /// @throws std::invalid_argument for a degree outside 1 .. 9 or another number of points
    BezierPatch(int degree_u, int degree_v, std::span<const Quad> net, bool polynomial);

    /// As they were given; net(i, j) has i along u and j along v. @pre i <= degree_u, j <= degree_v
    [[nodiscard]] int degree_u() const noexcept { return degree_u_; }
    [[nodiscard]] int degree_v() const noexcept { return degree_v_; }
    [[nodiscard]] bool polynomial() const noexcept { return polynomial_; }
    [[nodiscard]] std::span<const Quad> net() const noexcept { return net_; }
    [[nodiscard]] const Quad& net(int i, int j) const noexcept {
        return net_[static_cast<std::size_t>(i * (degree_v_ + 1) + j)];
    }

    /// S and its derivatives per unit of this patch's u and v, relative to the local origin. u and
    /// v are not clamped.
    [[nodiscard]] SurfaceJet at(double u, double v) const noexcept {
        return jet_(prepared_.data(), degree_u_, degree_v_, u, v);
    }
    /// What at() costs.
    [[nodiscard]] Work work() const noexcept { return work_; }
    /// S alone.
    [[nodiscard]] Vec3 point(double u, double v) const noexcept { return at(u, v).point; }

private:
    /// A way to evaluate a patch of these degrees, from what it wants prepared.
    using Jet = SurfaceJet (*)(const Quad*, int, int, double u, double v) noexcept;
    template <class Jets>
    [[nodiscard]] Jet jet_by() const noexcept;

    int degree_u_ = 1;
    int degree_v_ = 1;
    bool polynomial_ = false;
    Work work_ = 0;
    Jet jet_ = nullptr;  ///< chosen once, for this processor
    std::vector<Quad> net_;
    std::vector<Quad> prepared_;  ///< of low degrees and one weight: coefficients of u^i v^j at
                                  ///< 4 i + j; bicubic: the net and its differences along u; else
                                  ///< the net
};

}  // namespace palpate::engine

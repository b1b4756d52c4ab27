#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/geometry/quad.hpp"
#include "engine/geometry/rational_bezier.hpp"
#include "engine/surface/surface_jet.hpp"

namespace palpate::engine {

/// One rational Bezier patch, u and v in [0, 1].
///
///     S(u, v) = sum B_i(u) B_j(v) w_ij P_ij / sum B_i(u) B_j(v) w_ij     The NURBS Book, eq. 4.11
///
/// A polynomial of degree up to 3 x 3 is evaluated from powers of u and v (error below 1e-15 of the
/// size); everything else in homogeneous coordinates by convex combinations, de Casteljau's corner
/// cutting or Bernstein polynomials (below 1e-15 for weights of 1e-3 to 1e3).
class BezierPatch {
public:
    /// @param net         w_ij (P_ij, 1), place i (degree_v + 1) + j; (degree_u + 1)(degree_v + 1) of
    ///                    them, all w > 0; P relative to a local origin that the caller keeps
    /// @param polynomial  all weights are 1
    /// @throws std::invalid_argument for a degree outside 1 .. 9 or another number of points
    BezierPatch(int degree_u, int degree_v, std::span<const Quad> net, bool polynomial);

    [[nodiscard]] int degree_u() const noexcept { return degree_u_; }
    [[nodiscard]] int degree_v() const noexcept { return degree_v_; }
    [[nodiscard]] bool polynomial() const noexcept { return polynomial_; }
    [[nodiscard]] std::span<const Quad> net() const noexcept { return net_; }
    [[nodiscard]] const Quad& net(int i, int j) const noexcept {
        return net_[static_cast<std::size_t>(i * (degree_v_ + 1) + j)];
    }

    /// S and its derivatives per unit of this patch's u and v, relative to the local origin. u and v
    /// are not clamped.
    [[nodiscard]] SurfaceJet at(double u, double v) const noexcept;
    /// S alone.
    [[nodiscard]] Vec3 point(double u, double v) const noexcept { return at(u, v).point; }

private:
    enum class Method : std::uint8_t { powers, bicubic, biquadratic, any };

    int degree_u_ = 1;
    int degree_v_ = 1;
    bool polynomial_ = false;
    Method method_ = Method::any;
    std::vector<Quad> net_;
    std::vector<Quad> prepared_;  ///< powers: coefficients of u^i v^j at 4 i + j; bicubic: the net
                                  ///< and its differences along u
};

}  // namespace palpate::engine

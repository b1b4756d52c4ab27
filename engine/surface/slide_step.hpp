#pragma once

#include <cmath>

#include "engine/surface/surface_ground.hpp"

namespace palpate::engine {

/// A step of the god-object in the parameters of its patch.
struct SurfaceStep {
    double du = 0.0;
    double dv = 0.0;
    double length = 0.0;  ///< m
    bool newton = false;  ///< to the foot that the second derivatives promise
};

/// Steps down |r|^2 / 2 from one spot, one of any length:
///
///     (Phi + lambda M) d = -grad          linearly implicit Euler, of the flow towards the foot
///
/// with M the metric and Phi the second derivatives of |S - h|^2 / 2 in u and v. A short step
/// (large lambda) follows the tangential stretch, a long one goes to the foot (lambda = 0, Newton),
/// and one in between bends from the first way to the second as the flow itself does, also in
/// narrow valleys (Hairer & Wanner, Solving Ordinary Differential Equations II, IV.7).
class SurfaceSteps {
public:
    /// @param size  of the surface, m
    SurfaceSteps(const SurfaceSpot& s, double size) noexcept;

    /// The step of `length` m, > 0, or the shorter one to the foot.
    [[nodiscard]] SurfaceStep of(double length) const noexcept;
    /// There is a foot, and a step goes to it.
    [[nodiscard]] bool bowl() const noexcept { return low_ > 1e-9 && low_ > 1e-14 * high_; }
    /// The stretch is square to a way down to both sides, as where an edge folds back.
    [[nodiscard]] bool ridge() const noexcept { return low_ < 0.0 && c_low_ == 0.0; }
    /// In a bowl: the step after which the stretch along the surface is `rest` m, >= 0.
    [[nodiscard]] SurfaceStep to(double rest) const noexcept;
    /// Length of the step to the foot, m; without bound where there is none.
    [[nodiscard]] double reach() const noexcept { return bowl() ? to(0.0).length : 1e300; }
    /// Straight along the stretch, and not beyond the lowest place on that way.
    [[nodiscard]] SurfaceStep straight(double length) const noexcept;
    /// With v (or u) kept.
    [[nodiscard]] SurfaceStep along(bool in_u, double length) const noexcept;
    /// By how much |r|^2 / 2 falls in a step, says the model, m^2.
    [[nodiscard]] double fall(const SurfaceStep& d) const noexcept {
        return (slope_.x * d.du + slope_.y * d.dv) -
               (0.5 * (uu_ * d.du * d.du + vv_ * d.dv * d.dv) + uv_ * d.du * d.dv);
    }

    /// What a step came to is what the model said, or nearly: |r|^2 fell so far, within a quarter,
    /// and the drive along it too, within a half. Then no foot was leapt over.
    /// @param fall  of |r|^2, m^2
    [[nodiscard]] bool believed(const SurfaceStep& d,
                                const SurfaceSpot& to,
                                double fall,
                                double noise) const noexcept {
        const double promised = 2.0 * this->fall(d);
        const double drive = slope_.x * d.du + slope_.y * d.dv;
        const double left = glm::dot(to.r, d.du * to.jet.du + d.dv * to.jet.dv);
        return std::fabs(fall - promised) <= 0.25 * promised + noise &&
               std::fabs(left - (promised - drive)) <= 0.5 * drive + noise;
    }

private:
    [[nodiscard]] Vec2 at(double lambda) const noexcept;
    /// @param x  along the axes, m
    [[nodiscard]] SurfaceStep in_parameters(const Vec2& x, bool newton) const noexcept;

    Vec2 slope_{};  ///< of |r|^2 / 2 downwards
    double uu_ = 0.0;
    double uv_ = 0.0;
    double vv_ = 0.0;
    double l11_ = 0.0;  ///< M = L L^T
    double l21_ = 0.0;
    double l22_ = 0.0;
    Vec2 axis_{};       ///< of the smaller eigenvalue of L^-1 Phi L^-T
    double low_ = 0.0;  ///< its eigenvalues
    double high_ = 0.0;
    double c_low_ = 0.0;  ///< the stretch along its axes, m
    double c_high_ = 0.0;
};

/// The steps of a god-object that does not follow the flow: without friction, along an edge, where
/// the flow has no direction.
///
/// The step of this length: into the patch, or along its edge.
[[nodiscard]] SurfaceStep step_of(const Footing& at,
                                  const SurfaceSteps& steps,
                                  double length) noexcept;
/// The length of the first step to try, m: to the foot or close to it where the cone is narrow,
/// else Newton's on the excess along the stretch, and further where the last one fell short.
/// @param last  length of the last step, m; @param last_excess  before it, m
[[nodiscard]] double first_length(const Footing& at,
                                  const SurfaceSteps& steps,
                                  double mu,
                                  double last,
                                  double last_excess) noexcept;
/// A step ends on the edge of its patch.
[[nodiscard]] SurfaceStep cut(const SurfaceSpot& s, SurfaceStep step) noexcept;
/// Below the last bits of the parameters.
[[nodiscard]] bool still(const SurfaceStep& step) noexcept;
/// Length of the edge between two spots on it, m: the trapezium's with its correction, of order 4.
[[nodiscard]] double edge_way(const SurfaceSpot& a, const SurfaceSpot& b) noexcept;
/// The share of a step that a budget of `rest` m pays, nearly: along an edge the speed changes.
[[nodiscard]] double paid(const Footing& at,
                          const SurfaceStep& step,
                          const SurfaceSpot& end,
                          double rest) noexcept;
/// Part of the stretch along the way of `step`, m.
[[nodiscard]] double ahead(const SurfaceStep& step, const SurfaceSpot& s) noexcept;
/// Excess over the cone, m; along an edge only that of the part along it.
[[nodiscard]] double measure(const Footing& at,
                             const SurfaceStep& step,
                             const SurfaceSpot& s) noexcept;
/// Where the tangents nearly vanish, or are one, rounding has a say in where the flow leads.
/// @param size  of the surface, m
[[nodiscard]] bool singular(const SurfaceJet& jet, double size) noexcept;
/// How far from the cone a step ends, m.
[[nodiscard]] double left(const Footing& at,
                          const SurfaceStep& step,
                          const SurfaceSpot& s) noexcept;

}  // namespace palpate::engine

#pragma once

#include "engine/friction/friction_law.hpp"
#include "engine/geometry/outline.hpp"

namespace palpate::engine {

/// The god-object's situation at one place: frame, stretch, and how far outside the cone it is.
struct ConeState {
    Frame frame{};
    double tau = 0.0;     ///< r . t, m, signed
    double nu = 0.0;      ///< -r . n, m
    double excess = 0.0;  ///< |tau| - mu max(nu, 0), m; > 0: the GO has to move
};

/// State at `frame` for HIP `h` and coefficient mu. The 2-D face of Stretch: signed along t.
template <bool HasFriction>
[[nodiscard]] ConeState cone_state(const Frame& frame, const Vec2& h, double mu) noexcept {
    const Vec2 r = h - frame.point;
    ConeState s{
        .frame = frame, .tau = glm::dot(r, frame.tangent), .nu = -glm::dot(r, frame.normal)};
    s.excess = (s.tau < 0.0 ? -s.tau : s.tau) - cone_radius<HasFriction>(mu, s.nu);
    return s;
}

/// Where a slide ended.
enum class SlideEnd : std::uint8_t {
    in_cone,  ///< at the first place where the stretch fits the cone
    at_end,   ///< at the end of the segment, still outside
    out_of_budget,
};

struct Slide {
    double u = 0.0;
    double length = 0.0;  ///< arc length travelled, m, first order in each step
    SlideEnd end = SlideEnd::in_cone;
};

/// Moves the god-object from u in direction `dir` (+1 or -1) up to the first place where
/// dir tau <= mu max(nu, 0), at most `budget` m and not over the end of the segment.
///
///     ds = (dir tau - mu nu) / max(1 - kappa (nu + mu |tau|), 1/4)
///
/// is Newton's step, since d(dir tau - mu nu)/ds = -(1 - kappa (nu + mu |tau|)) along a curve with
/// curvature kappa; the floor keeps it finite near a centre of curvature. Past the root it is closed
/// in by bracketed Newton steps, so that the end is the root to rounding and on its inner side.
/// @pre excess > 0 at u, in direction dir
template <bool HasFriction>
[[nodiscard]] Slide slide_to_cone(const RationalBezier<2>& curve,
                                  const Vec2& h,
                                  double mu,
                                  double u,
                                  double dir,
                                  double budget) noexcept;

}  // namespace palpate::engine

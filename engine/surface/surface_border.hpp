#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/surface/nurbs_surface.hpp"

namespace palpate::engine {

/// A border of a surface as a curve over [0, 1], the equal shares of its knot range.
class SurfaceBorder {
public:
    /// @param side  u first, u last, v first, v last
    SurfaceBorder(const NurbsSurface& surface, std::size_t index, std::uint8_t side);

    /// Index of its surface; and 0 u first, 1 u last, 2 v first, 3 v last.
    [[nodiscard]] std::size_t surface() const noexcept { return surface_; }
    [[nodiscard]] std::uint8_t side() const noexcept { return side_; }
    /// Along it the surface lies to the left, seen from outside.
    [[nodiscard]] bool counter_clockwise() const noexcept { return side_ == 1 || side_ == 2; }
    /// Relative to the surface's origin, m. @param s  in [0, 1]
    [[nodiscard]] Vec3 at(double s) const;
    /// "border u = 1 of surface 2"; surfaces are counted from 1.
    [[nodiscard]] std::string name() const;
    /// Where its spans begin, and 1.
    [[nodiscard]] const std::vector<double>& breaks() const noexcept { return breaks_; }
    /// Box of its control points.
    [[nodiscard]] const Box<3>& box() const noexcept { return box_; }

    /// Homogeneous control values of [lo, hi], which lies within one span.
    [[nodiscard]] std::vector<Quad> part(double lo, double hi) const;
    /// The distance of a point from it by samples and their refinement, m: for sentences, no proof.
    [[nodiscard]] double distance(const Vec3& p) const;

private:
    [[nodiscard]] std::size_t span_of(double s) const noexcept;

    std::size_t surface_;
    std::uint8_t side_;
    double knot_;  ///< that is the same along it
    Box<3> box_{};
    std::vector<double> breaks_;
    std::vector<std::vector<Quad>> spans_;
};

/// Borders about the same origin: whether b(s), or b(1 - s), is nowhere farther than `tolerance` m
/// from a(s): a proof by the Bernstein coefficients of A w_b - B w_a, on halves of halves.
[[nodiscard]] bool same_curve(const SurfaceBorder& a,
                              const SurfaceBorder& b,
                              bool reversed,
                              double tolerance);

/// The largest distance of a(s) from b(s), or b(1 - s), among samples, m.
[[nodiscard]] double sampled_gap(const SurfaceBorder& a, const SurfaceBorder& b, bool reversed);

}  // namespace palpate::engine

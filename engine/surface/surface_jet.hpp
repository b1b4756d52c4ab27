#pragma once

#include <glm/geometric.hpp>

#include "engine/geometry/vec.hpp"

namespace palpate::engine {

/// Point and derivatives of a surface at one (u, v): m, m per unit of u or v, and so on.
struct SurfaceJet {
    Vec3 point{};
    Vec3 du{};
    Vec3 dv{};
    Vec3 duu{};
    Vec3 duv{};
    Vec3 dvv{};
};

/// The two principal curvatures, 1/m, low <= high. > 0: the surface curves away from its normal, as
/// a ball seen from outside does (the convention of engine/geometry/arc.hpp).
struct Curvatures {
    double low = 0.0;
    double high = 0.0;
};

/// @param normal  unit normal at the place of `jet`
///
/// From the two fundamental forms (do Carmo, Differential Geometry, 3-3, eq. 7 and 8), relative error
/// about 1e-15 times the largest over the smallest of |du|^2, |dv|^2 and |du x dv|. Both are 0 where
/// du x dv vanishes.
[[nodiscard]] Curvatures principal_curvatures(const SurfaceJet& jet, const Vec3& normal) noexcept;

/// Curvature of the normal section in the direction a du + b dv, 1/m, > 0 as above. 0 for no
/// direction.
[[nodiscard]] inline double normal_curvature(const SurfaceJet& jet,
                                             const Vec3& normal,
                                             double a,
                                             double b) noexcept {
    const Vec3 direction = a * jet.du + b * jet.dv;
    const double length2 = glm::dot(direction, direction);
    const Vec3 bend = (a * a) * jet.duu + (2.0 * a * b) * jet.duv + (b * b) * jet.dvv;
    return length2 > 0.0 ? -glm::dot(bend, normal) / length2 : 0.0;
}

}  // namespace palpate::engine

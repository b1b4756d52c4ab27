#pragma once

#include <cmath>

#include "engine/surface/nurbs_surface.hpp"

namespace palpate::tests {

/// The two principal curvatures, 1/m, low <= high. > 0: the surface curves away from its normal, as
/// a ball seen from outside does (the convention of engine/geometry/arc.hpp).
struct Curvatures {
    double low = 0.0;
    double high = 0.0;
};

/// @param normal  unit normal at the place of `jet`
///
/// From the two fundamental forms (do Carmo, Differential Geometry, 3-3, eq. 7 and 8), relative
/// error about 1e-15 times the largest over the smallest of |du|^2, |dv|^2 and |du x dv|. Both are
/// 0 where du x dv vanishes.
///
/// The shape operator in an orthonormal frame of the tangent plane: half the difference of its
/// eigenvalues is then a length of two small numbers, not the root of a cancelled difference.
inline Curvatures principal_curvatures(const engine::SurfaceJet& jet, const engine::Vec3& normal) {
    const double e = glm::dot(jet.du, jet.du);
    const engine::Vec3 area = glm::cross(jet.du, jet.dv);
    const double area2 = glm::dot(area, area);  // e g - f^2 without its cancellation
    if (!(e > 0.0) || !(area2 > 0.0)) {
        return {};
    }
    const double shear = glm::dot(jet.du, jet.dv) / e;
    const double height2 = area2 / e;  // of dv above du
    const double l = -glm::dot(jet.duu, normal);
    const double m = -glm::dot(jet.duv, normal);
    const double n = -glm::dot(jet.dvv, normal);
    const double a = l / e;
    const double b = (m - shear * l) / std::sqrt(area2);
    const double c = (n - shear * (2.0 * m - shear * l)) / height2;
    const double mean = 0.5 * (a + c);
    const double skew = 0.5 * (a - c);
    const double half = std::sqrt(skew * skew + b * b);
    return {mean - half, mean + half};
}

}  // namespace palpate::tests

#include "engine/surface/surface_jet.hpp"

#include <cmath>

namespace palpate::engine {

/// The shape operator in an orthonormal frame of the tangent plane: half the difference of its
/// eigenvalues is then a length of two small numbers, not the root of a cancelled difference.
Curvatures principal_curvatures(const SurfaceJet& jet, const Vec3& normal) noexcept {
    const double e = glm::dot(jet.du, jet.du);
    const Vec3 area = glm::cross(jet.du, jet.dv);
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

}  // namespace palpate::engine

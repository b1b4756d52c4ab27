#include "engine/surface/flow_spot.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::engine {

double FlowSpot::measure(const Vec2& d) const noexcept {
    return std::sqrt(std::max(e * d.x * d.x + 2.0 * f * d.x * d.y + g * d.y * d.y, 0.0));
}

double FlowSpot::excess_by(const Vec2& d, double mu) const noexcept {
    // T . dS, and n . dn along the way.
    const double ahead = (e * way.x + f * way.y) * d.x + (f * way.x + g * way.y) * d.y;
    const double bends = turn.x * d.x + turn.y * d.y;
    return -ahead - (load + (load > 0.0 ? mu * length : 0.0)) * bends;
}

FlowSpot flow_spot(const SurfaceJet& j, const Vec2& at, const Vec3& h, double mu) noexcept {
    FlowSpot s;
    s.at = at;
    s.e = glm::dot(j.du, j.du);
    s.f = glm::dot(j.du, j.dv);
    s.g = glm::dot(j.dv, j.dv);
    const Vec3 area = glm::cross(j.du, j.dv);
    const double area2 = glm::dot(area, area);
    if (!(area2 > 1e-18 * s.e * s.g)) {
        return s;
    }
    const Vec3 normal = (1.0 / std::sqrt(area2)) * area;
    const Vec3 r = h - j.point;
    const Stretch<3> parts = stretch<3>(r, normal);
    s.length = parts.length;
    s.load = parts.load;
    s.excess = s.length - cone_radius<true>(mu, s.load);
    if (!(s.length > 0.0)) {
        return s;
    }
    const double inverse = 1.0 / area2;
    const auto raised = [&s, inverse](double a, double b) {
        return Vec2{(s.g * a - s.f * b) * inverse, (s.e * b - s.f * a) * inverse};
    };
    const double per_length = 1.0 / s.length;
    s.way = per_length * raised(glm::dot(parts.tangential, j.du), glm::dot(parts.tangential, j.dv));
    const double uu = glm::dot(normal, j.duu);
    const double uv = glm::dot(normal, j.duv);
    const double vv = glm::dot(normal, j.dvv);
    s.turn = Vec2{uu * s.way.x + uv * s.way.y, uv * s.way.x + vv * s.way.y};
    const double bends = s.turn.x * s.way.x + s.turn.y * s.way.y;  // n . C
    const Vec3 c = (s.way.x * s.way.x) * j.duu + (2.0 * s.way.x * s.way.y) * j.duv +
                   (s.way.y * s.way.y) * j.dvv;
    const double pull = s.load * per_length;
    s.bend = (pull * bends) * s.way -
             raised(pull * s.turn.x + glm::dot(j.du, c), pull * s.turn.y + glm::dot(j.dv, c));
    s.rate = -1.0 - bends * (s.load + (s.load > 0.0 ? mu * s.length : 0.0));
    s.regular = std::isfinite(s.bend.x + s.bend.y + s.rate);
    return s;
}

FlowArc::FlowArc(const FlowSpot& from, const FlowSpot& to, const Vec2& end, double h) noexcept
    : start_(from.at), first_(h * from.way), second_((0.5 * h * h) * from.bend) {
    // What the ends ask for beyond the second order.
    const Vec2 place = end - start_ - first_ - second_;
    const Vec2 slope = h * (to.way - from.way) - 2.0 * second_;
    const Vec2 bend = (h * h) * (to.bend - from.bend);
    third_ = 10.0 * place - 4.0 * slope + 0.5 * bend;
    fourth_ = 7.0 * slope - 15.0 * place - bend;
    fifth_ = 6.0 * place - 3.0 * slope + 0.5 * bend;
}

}  // namespace palpate::engine

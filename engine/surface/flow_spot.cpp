#include "engine/surface/flow_spot.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/processor.hpp"

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

namespace {

/// Every member is named at the end, for else all are set to zero first.
FlowSpot spot_of(const SurfaceJet& j, const Vec2& at, const Vec3& h, double mu) noexcept {
    const double e = glm::dot(j.du, j.du);
    const double f = glm::dot(j.du, j.dv);
    const double g = glm::dot(j.dv, j.dv);
    const Vec3 area = glm::cross(j.du, j.dv);
    const double area2 = glm::dot(area, area);
    if (!(area2 > 1e-18 * e * g)) {
        return {.at = at, .e = e, .f = f, .g = g};
    }
    const Vec3 normal = (1.0 / std::sqrt(area2)) * area;
    const Vec3 r = h - j.point;
    const Stretch<3> parts = stretch<3>(r, normal);
    const double excess = parts.length - cone_radius<true>(mu, parts.load);
    if (!(parts.length > 0.0)) {
        return {.at = at,
                .length = parts.length,
                .load = parts.load,
                .excess = excess,
                .e = e,
                .f = f,
                .g = g};
    }
    const double inverse = 1.0 / area2;
    const auto raised = [&](double a, double b) {
        return Vec2{(g * a - f * b) * inverse, (e * b - f * a) * inverse};
    };
    const double per_length = 1.0 / parts.length;
    const Vec2 way =
        per_length * raised(glm::dot(parts.tangential, j.du), glm::dot(parts.tangential, j.dv));
    const double uu = glm::dot(normal, j.duu);
    const double uv = glm::dot(normal, j.duv);
    const double vv = glm::dot(normal, j.dvv);
    const Vec2 turn{uu * way.x + uv * way.y, uv * way.x + vv * way.y};
    const double bends = turn.x * way.x + turn.y * way.y;  // n . C
    const Vec3 c =
        (way.x * way.x) * j.duu + (2.0 * way.x * way.y) * j.duv + (way.y * way.y) * j.dvv;
    const double pull = parts.load * per_length;
    const Vec2 bend = (pull * bends) * way -
                      raised(pull * turn.x + glm::dot(j.du, c), pull * turn.y + glm::dot(j.dv, c));
    const double rate = -1.0 - bends * (parts.load + (parts.load > 0.0 ? mu * parts.length : 0.0));
    return {.at = at,
            .way = way,
            .bend = bend,
            .length = parts.length,
            .load = parts.load,
            .excess = excess,
            .rate = rate,
            .e = e,
            .f = f,
            .g = g,
            .turn = turn,
            .regular = std::isfinite(bend.x + bend.y + rate)};
}

}  // namespace

FlowSpot flow_spot(const SurfaceJet& jet, const Vec2& at, const Vec3& h, double mu) noexcept {
    return as_this_processor_can([&] { return spot_of(jet, at, h, mu); });
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

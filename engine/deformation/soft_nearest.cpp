#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/deformation/soft_shape.hpp"

namespace palpate::engine {
namespace {

constexpr int kMaxSteps = 12;  ///< of Newton's iteration to a foot

double squared(const Vec2& a) noexcept {
    return glm::dot(a, a);
}

}  // namespace

SoftShape::Met SoftShape::on_span(const SoftState& state,
                                  std::size_t look,
                                  const Vec2& hip) const noexcept {
    constexpr std::size_t kOfCurve = kCuts * kLooks;
    const std::size_t span = looks_[look].at.span;
    const std::size_t place = look - span * (kOfCurve + 1);
    double lo = place == 0 ? 0.0 : looks_[look - 1].at.u;
    double hi = place == kOfCurve ? 1.0 : looks_[look + 1].at.u;
    double u = looks_[look].at.u;
    Jet<2> jet = this->jet(state, {span, u});
    for (int i = 0; i < kMaxSteps; ++i) {
        const Vec2 r = jet.point - hip;
        const double g = glm::dot(r, jet.first);
        (g > 0.0 ? hi : lo) = u;
        const double slope = squared(jet.first) + glm::dot(r, jet.second);
        double next = u - g / slope;
        if (!(slope > 0.0 && next >= lo && next <= hi)) {  // at the foot it is the end just set
            next = 0.5 * (lo + hi);
        }
        if (std::fabs(next - u) <= kEpsilon) {
            break;
        }
        u = next;
        jet = this->jet(state, {span, u});
    }
    const double length = glm::length(jet.first);
    const Vec2 normal = perp(jet.first * (1.0 / length));
    return {.at = {span, u},
            .normal = normal,
            .depth = glm::dot(jet.point - hip, normal),
            .point = jet.point};
}

SoftShape::Met SoftShape::nearest(const SoftState& state, const Vec2& hip) const noexcept {
    std::size_t best = 0;
    double best2 = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < looks_.size(); ++i) {
        const Look& look = looks_[i];
        Vec2 r = look.rest - hip;
        for (std::size_t k = 0; k < 4; ++k) {
            r += look.value[k] * state.q[look.first + k];
        }
        if (squared(r) < best2) {
            best2 = squared(r);
            best = i;
        }
    }
    constexpr std::size_t kEndOfFirst = kCuts * kLooks;
    Met met = on_span(state, best, hip);
    double found2 = squared(met.point - hip);
    const auto offer = [&](const Met& other) {
        const double other2 = squared(other.point - hip);
        if (other2 < found2) {
            met = other;
            found2 = other2;
        }
    };
    const bool beside_first = best == kEndOfFirst || best == kEndOfFirst - 1;
    if (beside_first || best == kEndOfFirst + 1 || best == kEndOfFirst + 2) {
        // Beside V both curves are asked, and where neither has a foot the vertex is it.
        offer(on_span(state, beside_first ? kEndOfFirst + 1 : kEndOfFirst, hip));
        const Jet<2> in = jet(state, {0, 1.0});
        const Jet<2> out = jet(state, {1, 0.0});
        const Vec2 r = in.point - hip;
        const bool at_tip = glm::dot(r, in.first) <= 0.0 && glm::dot(r, out.first) >= 0.0;
        if (at_tip && squared(r) <= found2 + 1e-18) {
            const double length = glm::length(r);
            const bool inside = cross(in.first, out.first) > 0.0;  // concave: seen from inside
            met = {.at = {0, 1.0},
                   .normal = length > 0.0 ? r * ((inside ? 1.0 : -1.0) / length) : met.normal,
                   .depth = inside ? length : -length,
                   .point = in.point};
            found2 = squared(r);
        }
    }
    const Jet<2> base = outline_->spans()[kSoftSpans].at(0.0);
    const double u =
        std::clamp(glm::dot(hip - base.point, base.first) / squared(base.first), 0.0, 1.0);
    const Vec2 foot = base.point + u * base.first;
    const Vec2 normal = perp(base.first * (1.0 / glm::length(base.first)));
    offer({.at = {kSoftSpans, u},
           .normal = normal,
           .depth = glm::dot(foot - hip, normal),
           .point = foot});
    const bool corner = met.at.span == kSoftSpans ? u == 0.0 || u == 1.0
                      : met.at.span == 0          ? met.at.u <= 0.0
                                                  : met.at.u >= 1.0;
    if (corner) {  // convex, seen from outside
        met.depth = -std::sqrt(found2);
    }
    return met;
}

}  // namespace palpate::engine

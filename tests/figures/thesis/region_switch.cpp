#include "tests/figures/thesis/region_switch.hpp"

#include "engine/base/text.hpp"

namespace palpate::figures {
namespace {

using namespace palpate::engine;

/// Ends further apart than this, m, are not the same vertex: that of Outline.
constexpr double kSameEnd = 1e-9;

/// A foot is nearer only by more than rounding, as a share of the squared distance: in the region
/// of a vertex both feet lie in it, and the active curve shall not flicker.
constexpr double kNearer = 1.0 - 1e-12;

double distance2(const TrackedFoot& foot, const Vec2& hip) noexcept {
    const Vec2 gap = foot.point - hip;
    return glm::dot(gap, gap);
}

/// Twice the signed area that the sampled chords of the curves enclose: < 0 clockwise.
double chord_area(const std::vector<NurbsCurve<2>>& curves) {
    constexpr int kChords = 64;
    double area = 0.0;
    for (const auto& curve : curves) {
        for (const auto& span : curve.spans()) {
            for (int i = 0; i < kChords; ++i) {
                area += cross(span.curve.at(static_cast<double>(i) / kChords).point,
                              span.curve.at(static_cast<double>(i + 1) / kChords).point);
            }
        }
    }
    return area;
}

}  // namespace

RegionSwitch::RegionSwitch(const std::vector<NurbsCurve<2>>& curves, bool closed, RegionRule rule)
    : closed_(closed), rule_(rule) {
    if (curves.empty() || curves.size() > kMaxRegions) {
        throw std::invalid_argument("the outline has " + std::to_string(curves.size()) +
                                    " curves: give 1 to " + std::to_string(kMaxRegions));
    }
    for (const auto& curve : curves) {
        const auto end_at = [&](double u) {
            const Jet<2> jet = curve.at(u);
            const double speed = glm::length(jet.first);
            if (!(speed > 0.0)) {
                throw std::invalid_argument("curve " + std::to_string(ends_.size()) +
                                            " has no tangent at u = " + number_text(u) +
                                            ": let its last two control points differ");
            }
            return End{.u = u, .point = jet.point, .tangent = jet.first / speed};
        };
        ends_.push_back({end_at(curve.front()), end_at(curve.back())});
    }
    for (std::size_t i = 0; i < ends_.size(); ++i) {
        const auto j = after(i);
        if (!j) {
            continue;
        }
        const double gap = glm::length(ends_[*j].front.point - ends_[i].back.point);
        if (!(gap <= kSameEnd)) {
            throw std::invalid_argument("curve " + std::to_string(*j) + " starts " +
                                        number_text(gap) + " m away from the end of curve " +
                                        std::to_string(i) + ": let them share the point");
        }
    }
    if (closed_ && !(chord_area(curves) < 0.0)) {
        throw std::invalid_argument(
            "a closed outline must run clockwise, the object on the right of travel: reverse the "
            "order of its control points and of its curves");
    }
}

std::optional<std::size_t> RegionSwitch::after(std::size_t i) const noexcept {
    if (i + 1 < ends_.size()) {
        return i + 1;
    }
    return closed_ ? std::optional<std::size_t>(0) : std::nullopt;
}

std::optional<std::size_t> RegionSwitch::before(std::size_t i) const noexcept {
    if (i > 0) {
        return i - 1;
    }
    return closed_ ? std::optional<std::size_t>(ends_.size() - 1) : std::nullopt;
}

bool RegionSwitch::past_front(std::size_t i, const Vec2& hip) const noexcept {
    return glm::dot(hip - ends_[i].front.point, ends_[i].front.tangent) < 0.0;
}

bool RegionSwitch::past_back(std::size_t i, const Vec2& hip) const noexcept {
    return glm::dot(hip - ends_[i].back.point, ends_[i].back.tangent) > 0.0;
}

std::size_t RegionSwitch::nearest(std::size_t active,
                                  std::span<const TrackedFoot> feet,
                                  const Vec2& hip,
                                  bool everywhere) const noexcept {
    std::size_t best = active;
    double best2 = distance2(feet[active], hip);
    const auto compare = [&](std::size_t i) {
        const double d2 = distance2(feet[i], hip);
        if (d2 < best2 * kNearer) {
            best = i;
            best2 = d2;
        }
    };
    if (everywhere) {
        for (std::size_t i = 0; i < ends_.size(); ++i) {
            compare(i);
        }
        return best;
    }
    for (const auto& neighbour : {before(active), after(active)}) {
        if (neighbour) {
            compare(*neighbour);
        }
    }
    return best;
}

std::size_t RegionSwitch::next(std::size_t active,
                               std::span<const TrackedFoot> feet,
                               const Vec2& hip,
                               bool locked) const noexcept {
    if (locked) {
        return active;
    }
    if (rule_ == RegionRule::nearest_feature) {
        return nearest(active, feet, hip, false);
    }
    const auto forward = after(active);
    if (forward && past_back(active, hip) && !past_front(*forward, hip)) {
        return *forward;
    }
    const auto backward = before(active);
    if (backward && past_front(active, hip) && !past_back(*backward, hip)) {
        return *backward;
    }
    return active;
}

bool RegionSwitch::inside_vertex(const End& in, const End& out, const Vec2& hip) const noexcept {
    const Vec2 r = hip - in.point;
    const bool behind_in = glm::dot(r, perp(in.tangent)) < 0.0;
    const bool behind_out = glm::dot(r, perp(out.tangent)) < 0.0;
    const bool convex = cross(in.tangent, out.tangent) < 0.0;
    return convex ? behind_in && behind_out : behind_in || behind_out;
}

bool RegionSwitch::inside(std::size_t nearest,
                          std::span<const TrackedFoot> feet,
                          const Vec2& hip) const noexcept {
    const TrackedFoot& foot = feet[nearest];
    const Ends& ends = ends_[nearest];
    if (foot.u >= ends.back.u && past_back(nearest, hip)) {
        const auto j = after(nearest);
        return j && inside_vertex(ends.back, ends_[*j].front, hip);
    }
    if (foot.u <= ends.front.u && past_front(nearest, hip)) {
        const auto j = before(nearest);
        return j && inside_vertex(ends_[*j].back, ends.front, hip);
    }
    return foot.depth > 0.0;
}

}  // namespace palpate::figures

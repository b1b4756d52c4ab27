#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/contact/closest_point.hpp"
#include "engine/geometry/pair.hpp"
#include "engine/math/bend.hpp"

namespace palpate::engine {

/// A stretch of an outline over which the distance to HIP has one minimum only, and that minimum,
/// as it is followed. A plain value.
struct TrackWindow {
    std::size_t span = 0;  ///< of the foot
    double u = 0.0;        ///< where the jet was taken: a step of less than 2e-6 beside the foot
    Jet<2> jet{};
    Bend bend{};  ///< of (C - h) . C' over u, when last seen

    PieceRange pieces{};
    std::size_t first_span = 0;  ///< in the direction of travel
    std::size_t last_span = 0;
    double first_u = 0.0;
    double last_u = 1.0;
    std::array<std::size_t, 2> vertices{};  ///< within, that h may come to see as a maximum
    std::uint32_t vertex_count = 0;
};

/// What following a window's minimum gave.
struct WindowFoot {
    bool settled = false;  ///< else: no minimum was reached, a search is due
    bool on_seam = false;
    std::size_t seam = 0;
    Foot<2> foot{};
};

/// A foot amid a span.
struct PairFoot {
    double u;
    Pair point;
    double distance2;

    [[nodiscard]] Foot<2> on(std::size_t span) const noexcept {
        return {span, u, Vec2{point[0], point[1]}, distance2};
    }
};

/// How far h is from seeing a maximum at the vertex, m: from being past it for the curve before it
/// and not yet at it for the curve after. As h moves it shrinks by no more than h moves. < 0: a
/// maximum, or within rounding of one. Straight below the end of one curve, the foot of the other
/// would be missed.
[[nodiscard]] inline double clearance(const Seam& seam, const Vec2& h) noexcept {
    // Whether h is at the end of a curve is known to this share of the lengths only: the seam's
    // tangents are rounded, and so is the curve's own derivative there.
    constexpr double kVertexMargin = 1e-12;
    const Vec2 gap = seam.point - h;
    const double margin =
        kVertexMargin * (std::fabs(gap.x) + std::fabs(gap.y) + std::fabs(h.x) + std::fabs(h.y));
    return std::max(-glm::dot(gap, seam.tangent_in), glm::dot(gap, seam.tangent_out)) - margin;
}

/// Opens windows on an outline and follows the minima in them.
///
/// Over a piece the distance has one minimum while f(u) = (C - h) . C' W^k rises, a set of
/// half-planes of h (Pieces::rise_slack); over joined pieces as long as no vertex between them is a
/// maximum: not falling behind it while rising ahead.
class WindowTracker {
public:
    /// @param feet  must live as long as this
    explicit WindowTracker(const OutlineFeet& feet);

    /// The window around `foot`, the closest point of some part of the outline to h, as far as it
    /// can be had with some slack, and not into `taken`.
    /// @return how far h may move while the window keeps its single minimum, m; <= 0: there is none
    [[nodiscard]] double open(TrackWindow& window,
                              const Foot<2>& foot,
                              const Vec2& h,
                              const PieceRange& taken) const noexcept;

    /// On an arc or a line the foot itself, elsewhere Newton's iteration on g(u) = (C - h) . C'
    /// from the last one, its first step along a parabola; across spans, within the window.
    /// @pre h has moved less than the window's slack
    [[nodiscard]] WindowFoot follow(TrackWindow& window, const Vec2& h) const noexcept;

    /// What follow() nearly always needs: on an arc the foot, amid a cubic two steps. Straight on,
    /// so that its numbers stay in registers.
    /// @return false: it needs more, and rest() of what was walked gives it
    template <class Curve>
    [[nodiscard]] bool glide(const Curve& curve,
                             TrackWindow& window,
                             const Vec2& h,
                             PairFoot& foot) const noexcept;
    [[nodiscard]] WindowFoot rest(TrackWindow& window, const Vec2& h) const noexcept {
        return one_minimum(window, h) ? walk(window, h) : WindowFoot{};
    }

private:
    struct Opening;

    [[nodiscard]] bool one_minimum(const TrackWindow& window, const Vec2& h) const noexcept;
    [[nodiscard]] WindowFoot walk(TrackWindow& window, const Vec2& h) const noexcept;
    [[nodiscard]] static WindowFoot here(const TrackWindow& window,
                                         double u,
                                         const Vec2& point,
                                         const Vec2& h) noexcept;
    std::optional<WindowFoot> past_end(TrackWindow& window,
                                       bool forward,
                                       const Vec2& h) const noexcept;

    const OutlineFeet* feet_;
    std::vector<double>
        taylor_;  ///< of each span: steps of u below it are finished by Taylor's series
};

/// Newton's step on g at a jet, and the slope of g there.
struct FootStep {
    double slope = 0.0;
    double by = 0.0;

    FootStep(const PairJet& jet, Pair h) noexcept {
        const Pair gap = jet.point - h;
        slope = dot(jet.first, jet.first) + dot(gap, jet.second);
        by = -dot(gap, jet.first) / slope;
    }
};

/// Newton's error after a last step: step^2 g'' / (2 g'), with g'' near 3 C' . C''. More than 4e-12
/// of the span is no last step.
[[nodiscard]] inline bool is_last_step(const PairJet& jet, double slope, double step) noexcept {
    constexpr double kSharp2 = 0x1p-76;
    constexpr double kShort = 0x1p-21;
    if (std::fabs(step) < kShort) {
        return true;
    }
    const double bent = dot(jet.first, jet.first) * dot(jet.second, jet.second);
    const double step2 = step * step;
    return 9.0 * bent * (step2 * step2) <= kSharp2 * (slope * slope);
}

/// On an arc, in units of its length instead of the span's parameter.
[[nodiscard]] inline Jet<2> jet_on(const Arc& arc, double s) noexcept {
    const Arc::Point at = arc.at(s, 1.0 - s);
    return {.point = at.point, .first = at.tangent, .second = -arc.curvature() * perp(at.tangent)};
}

inline bool WindowTracker::one_minimum(const TrackWindow& window, const Vec2& h) const noexcept {
    for (std::uint32_t i = 0; i < window.vertex_count; ++i) {
        if (clearance(feet_->outline().seams()[window.vertices[i]], h) < 0.0) {
            return false;
        }
    }
    return true;
}

template <class Curve>
[[gnu::always_inline]] inline bool WindowTracker::glide(const Curve& curve,
                                                        TrackWindow& s,
                                                        const Vec2& h,
                                                        PairFoot& foot) const noexcept {
    const double lo = s.span == s.first_span ? s.first_u : 0.0;
    const double hi = s.span == s.last_span ? s.last_u : 1.0;
    const Pair hip = pair(h);
    if (!one_minimum(s, h)) {
        return false;
    }
    if constexpr (std::is_same_v<Curve, Arc>) {
        foot.u = curve.foot(h);
        if (!(foot.u >= lo && foot.u <= hi)) {
            return false;
        }
        s.u = foot.u;
        s.jet = jet_on(curve, foot.u);
        foot.point = pair(s.jet.point);
    } else {
        const FootStep first(PairJet(s.jet), hip);
        const double way = s.bend.step(first.by);
        const double u = s.u + way;
        if (!(first.slope > 0.0 && u >= lo && u <= hi)) {
            return false;
        }
        const PairJet jet(curve, u);
        const FootStep last(jet, hip);
        s.u = u;
        jet.put(s.jet);
        s.bend.see(first.slope, last.slope, way);
        foot.u = u + last.by;
        if (!(last.slope > 0.0 && foot.u >= std::max(lo, kStillEnd) &&
              foot.u <= std::min(hi, 1.0 - kStillEnd) && std::fabs(last.by) <= taylor_[s.span] &&
              is_last_step(jet, last.slope, last.by))) {
            return false;
        }
        foot.point = jet.point + last.by * (jet.first + (0.5 * last.by) * jet.second);
    }
    const Pair gap = foot.point - hip;
    foot.distance2 = dot(gap, gap);
    return true;
}

}  // namespace palpate::engine

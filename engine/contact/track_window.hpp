#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/contact/closest_point.hpp"
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
    [[nodiscard]] WindowFoot follow(TrackWindow& window, const Vec2& h) const noexcept {
        if (window.vertex_count != 0 && !one_minimum(window, h)) {
            return {};
        }
        Foot<2> foot;
        return glide(window, h, foot) ? WindowFoot{.settled = true, .foot = foot} : walk(window, h);
    }

private:
    struct Opening;

    /// Newton's step at a jet, and the slope of g there.
    struct Step {
        double slope = 0.0;
        double by = 0.0;

        Step(const Jet<2>& jet, const Vec2& h) noexcept {
            const Vec2 gap = jet.point - h;
            slope = glm::dot(jet.first, jet.first) + glm::dot(gap, jet.second);
            by = -glm::dot(gap, jet.first) / slope;
        }
    };

    [[nodiscard]] bool one_minimum(const TrackWindow& window, const Vec2& h) const noexcept;
    [[nodiscard]] bool glide(TrackWindow& window, const Vec2& h, Foot<2>& foot) const noexcept;
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

/// Newton's error after a last step: step^2 g'' / (2 g'), with g'' near 3 C' . C''. More than 4e-12
/// of the span is no last step.
[[nodiscard]] inline bool is_last_step(const Jet<2>& jet, double slope, double step) noexcept {
    constexpr double kSharp2 = 0x1p-76;
    constexpr double kShort = 0x1p-21;
    if (std::fabs(step) < kShort) {
        return true;
    }
    const double bent = glm::dot(jet.first, jet.first) * glm::dot(jet.second, jet.second);
    const double step2 = step * step;
    return 9.0 * bent * (step2 * step2) <= kSharp2 * (slope * slope);
}

/// What nearly every tick needs: two steps amid a span. Here, so that its numbers stay in
/// registers. False: it needs more; what was walked stays.
inline bool WindowTracker::glide(TrackWindow& s, const Vec2& h, Foot<2>& foot) const noexcept {
    const Outline& outline = feet_->outline();
    if (outline.arc(s.span) != nullptr) {
        return false;
    }
    const double lo = s.span == s.first_span ? s.first_u : 0.0;
    const double hi = s.span == s.last_span ? s.last_u : 1.0;
    const Step first(s.jet, h);
    const double way = s.bend.step(first.by);
    const double u = s.u + way;
    if (!(first.slope > 0.0 && u >= lo && u <= hi)) {
        return false;
    }
    const Jet<2> jet = outline.spans()[s.span].at(u);
    const Step last(jet, h);
    s.u = u;
    s.jet = jet;
    s.bend.see(first.slope, last.slope, way);
    foot.span = s.span;
    foot.u = u + last.by;
    if (!(last.slope > 0.0 && foot.u >= std::max(lo, kStillEnd) &&
          foot.u <= std::min(hi, 1.0 - kStillEnd) && std::fabs(last.by) <= taylor_[s.span] &&
          is_last_step(jet, last.slope, last.by))) {
        return false;
    }
    foot.point = jet.point + last.by * (jet.first + (0.5 * last.by) * jet.second);
    const Vec2 gap = foot.point - h;
    foot.distance2 = glm::dot(gap, gap);
    return true;
}

}  // namespace palpate::engine

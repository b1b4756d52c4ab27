#include "engine/contact/track_window.hpp"

namespace palpate::engine {
namespace {

/// A last step that Taylor's series of second order finishes may be this wrong, relative to the
/// span.
constexpr double kTaylorError = 1e-17;

/// And no longer than this: Newton's own error after the step is of the order of its square.
constexpr double kLongestTaylor = 0x1p-19;

/// Weights that differ by more make all of a curve in a millionth of u: there only the jet tells
/// how long a last step may be.
constexpr double kHeavy = 1e3;

/// The longest such step, from C_uuu step^3 / 6 with C_uuu seen at a few places. Only the
/// last digits hang on it, not the proof. 0: the curve is too heavy to be seen so.
double taylor_step(const RationalBezier<2>& curve) {
    constexpr int kPlaces = 16;
    const auto [lightest, heaviest] = std::ranges::minmax(curve.weights());
    if (heaviest > kHeavy * lightest) {
        return 0.0;
    }
    double third = 0.0;
    for (int i = 0; i < kPlaces; ++i) {
        const Vec2 before = curve.at(static_cast<double>(i) / kPlaces).second;
        const Vec2 after = curve.at(static_cast<double>(i + 1) / kPlaces).second;
        third = std::max(third, kPlaces * glm::length(after - before));
    }
    const double allowed = 6.0 * kTaylorError * glm::length(curve.box().size());
    double step = kLongestTaylor;
    while (third * step * step * step > allowed) {
        step *= 0.5;
    }
    return step;
}

/// Steps of a follow: two are usual; more means that a search is due.
constexpr int kWindowSteps = 12;

/// Pieces of a window on either side of the foot. More would make a search dearer than it saves.
constexpr std::size_t kReach = 8;

/// A window is not narrowed below this slack, m, if more can be had: 50 ticks at 0.1 m/s.
constexpr double kWanted = 0.005;

}  // namespace

WindowTracker::WindowTracker(const OutlineFeet& feet) : feet_(&feet) {
    for (const RationalBezier<2>& span : feet.outline().spans()) {
        taylor_.push_back(taylor_step(span));
    }
}

WindowFoot WindowTracker::follow(TrackWindow& window, const Vec2& h) const noexcept {
    const Arc* arc = feet_->outline().arc(window.span);
    PairFoot foot;
    const bool glides = arc != nullptr
                          ? glide(*arc, window, h, foot)
                          : glide(feet_->outline().spans()[window.span], window, h, foot);
    return glides ? WindowFoot{.settled = true, .foot = foot.on(window.span)} : rest(window, h);
}

/// The foot of h, in this place of the window's span.
WindowFoot WindowTracker::here(const TrackWindow& s,
                               double u,
                               const Vec2& point,
                               const Vec2& h) noexcept {
    const Vec2 gap = point - h;
    return {.settled = true, .foot = {s.span, u, point, glm::dot(gap, gap)}};
}

/// Towards an end of the span the distance still falls: the foot is there, at the vertex beyond, or
/// nothing is returned, and the window goes on on the next span.
std::optional<WindowFoot> WindowTracker::past_end(TrackWindow& s,
                                                  bool forward,
                                                  const Vec2& h) const noexcept {
    const Outline& outline = feet_->outline();
    const bool window_ends = s.span == (forward ? s.last_span : s.first_span);
    const auto seam = outline.seam_beyond(s.span, forward);
    if (window_ends || !seam) {
        return here(s, s.u, s.jet.point, h);
    }
    const Seam& vertex = outline.seams()[*seam];
    const Vec2 gap = vertex.point - h;
    const double beyond = glm::dot(gap, forward ? vertex.tangent_out : vertex.tangent_in);
    if (forward ? beyond >= 0.0 : beyond <= 0.0) {
        WindowFoot found = here(s, s.u, s.jet.point, h);
        found.on_seam = true;
        found.seam = *seam;
        found.foot.distance2 = glm::dot(gap, gap);
        return found;
    }
    s.span = forward ? vertex.after : vertex.before;
    s.u = forward ? 0.0 : 1.0;
    s.jet = outline.spans()[s.span].at(s.u);
    return std::nullopt;
}

WindowFoot WindowTracker::walk(TrackWindow& s, const Vec2& h) const noexcept {
    const Outline& outline = feet_->outline();
    double before = 0.0;  // slope and length of the first step
    double first = 0.0;
    for (int i = 0; i < kWindowSteps; ++i) {
        const Arc* arc = outline.arc(s.span);
        double slope = 1.0;
        double step = 0.0;
        double next = 0.0;
        if (arc != nullptr) {
            next = arc->foot(h);
        } else {
            const FootStep newton(PairJet(s.jet), pair(h));
            slope = newton.slope;
            step = newton.by;
            if (i == 0) {
                before = slope;
                first = step = s.bend.step(step);
            } else if (i == 1) {
                s.bend.see(before, slope, first);
            }
            next = s.u + step;
        }
        if (!(slope > 0.0) || std::isnan(next)) {
            return {};
        }
        const double lo = s.span == s.first_span ? s.first_u : 0.0;
        const double hi = s.span == s.last_span ? s.last_u : 1.0;
        if (!(next >= lo && next <= hi)) {
            const bool forward = next > hi;
            const double end = forward ? hi : lo;
            if (s.u != end) {
                s.u = end;
                s.jet = outline.spans()[s.span].at(end);
            } else if (const auto found = past_end(s, forward, h)) {
                return *found;
            }
            continue;
        }
        if (arc != nullptr) {
            s.u = next;
            s.jet = jet_on(*arc, next);
            return here(s, next, s.jet.point, h);
        }
        const double longest = taylor_[s.span];
        const bool last =
            longest > 0.0 ? std::fabs(step) <= longest && is_last_step(PairJet(s.jet), slope, step)
                          : is_straight_step(s.jet, step);
        if (!last) {
            s.u = next;
            s.jet = outline.spans()[s.span].at(next);
            continue;
        }
        if ((next < kStillEnd || next > 1.0 - kStillEnd) && stands_still(s.jet)) {
            return {};  // g vanishes with C', whether or not the distance is least here
        }
        return here(s, next, s.jet.point + step * (s.jet.first + (0.5 * step) * s.jet.second), h);
    }
    return {};
}

/// A window on its way to its full size.
struct WindowTracker::Opening {
    const OutlineFeet& feet;
    TrackWindow& window;
    const Vec2& h;
    const PieceRange& taken;
    std::size_t start;  ///< piece of the foot
    double slack;
    double wanted;
    std::size_t first;
    std::size_t last;
    std::size_t count = 1;

    /// Takes one more piece at the end (forward) or at the start, if it may belong to the window.
    bool grow(bool forward) noexcept {
        const Pieces<2>& pieces = feet.tree().pieces();
        const std::size_t edge = forward ? last : first;
        const Piece<2>& piece = pieces[edge];
        std::size_t next = forward ? edge + 1 : edge - 1;
        std::optional<std::size_t> vertex;
        double room = slack;
        if (forward ? piece.hi == 1.0 : piece.lo == 0.0) {
            const auto seam = feet.outline().seam_beyond(piece.span, forward);
            if (!seam) {
                return false;
            }
            next = (forward ? edge + 1 : edge + pieces.size() - 1) % pieces.size();
            const std::uint32_t entered = pieces[next].span;
            if (entered == pieces[start].span || entered == pieces[forward ? first : last].span) {
                return false;  // around a closed outline: the window has two different ends
            }
            const Seam& corner = feet.outline().seams()[*seam];
            if (corner.kind != SeamKind::smooth) {
                const double clear = clearance(corner, h);
                if (clear >= std::min(slack, kWanted)) {
                    room = std::min(room, clear);
                } else if (clear >= 0.0 && window.vertex_count < window.vertices.size()) {
                    vertex = seam;
                } else {
                    return false;
                }
            }
        }
        const double more = pieces.rise_slack(pieces[next], h);
        if (!(more >= wanted) || taken.holds(next, pieces.size())) {
            return false;
        }
        if (vertex) {
            window.vertices[window.vertex_count++] = *vertex;
        }
        slack = std::min(room, more);
        (forward ? last : first) = next;
        ++count;
        return true;
    }
};

double WindowTracker::open(TrackWindow& window,
                           const Foot<2>& foot,
                           const Vec2& h,
                           const PieceRange& taken) const noexcept {
    const Pieces<2>& pieces = feet_->tree().pieces();
    const std::size_t at = pieces.holding(foot.span, foot.u, taken);
    window.span = foot.span;
    window.u = foot.u;
    window.jet = feet_->outline().spans()[foot.span].at(foot.u);
    window.vertex_count = 0;
    const double slack = pieces.rise_slack(pieces[at], h);
    Opening opening{*feet_, window, h, taken, at, slack, std::min(0.5 * slack, kWanted), at, at};
    if (slack > 0.0) {
        for (const bool forward : {true, false}) {
            for (std::size_t i = 0; i < kReach && opening.count + 1 < pieces.size(); ++i) {
                if (!opening.grow(forward)) {
                    break;
                }
            }
        }
    }
    window.pieces = {opening.first, opening.count};
    window.first_span = pieces[opening.first].span;
    window.first_u = pieces[opening.first].lo;
    window.last_span = pieces[opening.last].span;
    window.last_u = pieces[opening.last].hi;
    return opening.slack;
}

}  // namespace palpate::engine

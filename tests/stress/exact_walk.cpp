#include "tests/stress/exact_forms.hpp"

namespace palpate::stress {
namespace {

using namespace palpate::engine;
/// Rounding of a stretch in doubles, relative to coordinates: a walk may see the edge of the cone
/// on either side.
constexpr double kBand = 32.0 * engine::kEpsilon;

/// The law, from place to place.
class Explorer {
public:
    Explorer(const ExactOutline& exact, const Vec2& h, double mu, ExactAnswer& answer)
        : exact_(exact),
          outline_(*exact.outline),
          h_(h),
          mu_(mu),
          answer_(answer),
          band_(answer.band) {}

    void from_span(std::size_t index, Real u, Real rest, int direction) {
        if (direction == 0) {
            const Stretch s = stretch_of(exact_.on[index], u, rest);
            if (!begins(s, doubt(exact_.on[index], u, rest, s))) {
                return;
            }
            direction = s.tau > 0.0L ? 1 : -1;
        }
        const bool forward = direction > 0;
        if ((forward ? rest : u) == 0.0L) {
            over_end(index, forward);
            return;
        }
        const SpanRows& span = (forward ? exact_.on : exact_.back)[index];
        const Real x = forward ? u : rest;
        const Real y = forward ? rest : u;
        const Stretch s = stretch_of(span, x, y);
        if (s.excess <= band_ || s.tau <= band_) {
            stop(s);  // where rounding decides, or the way into this span
        }
        if (s.excess <= -band_ || s.tau <= -band_) {
            return;
        }
        const Ahead ahead = ahead_of(span, h_, mu_, x, y);
        Roots roots;
        const bool surely = first_root_of(ahead, roots);
        answer_.open = answer_.open || roots.blank;
        for (const auto& [share, beyond] : roots.at) {
            const Stretch at = stretch_of(span, ahead.at(share), (1.0L - share) * y);
            const Stretch last = stretch_of(span, ahead.at(beyond), (1.0L - beyond) * y);
            stop(at);
            ExactStop& found = answer_.stops.back();
            found.blur = static_cast<double>(std::hypot(last.at.x - at.at.x, last.at.y - at.at.y));
            found.doubt = static_cast<double>(doubt(span, ahead.at(share), (1.0L - share) * y, at) +
                                              std::fabs(last.nu - at.nu));
        }
        const Vec2 end = outline_.spans()[index].point(
            forward ? static_cast<std::size_t>(outline_.spans()[index].degree()) : 0);
        const Stretch last = stretch(Point(end), tangent(index, forward), direction);
        // Where the curve stands still at its end, the control points tell its tangent.
        const Real unsure =
            repeats(outline_.spans()[index], forward) > 0 ? 0.0L : doubt(span, 1.0L, 0.0L, last);
        const bool on_edge =
            std::min(std::fabs(last.excess), std::fabs(last.tau)) <= band_ + unsure;
        if (!surely && on_edge) {
            stop(last);
            answer_.stops.back().doubt = static_cast<double>(unsure);
        }
        if (!surely || on_edge) {
            over_end(index, forward);
        }
    }

    void from_seam(std::size_t index, double phi) {
        const Seam& seam = outline_.seams()[index];
        if (seam.kind == SeamKind::concave) {
            corner(index, 0);
            return;
        }
        const Point along = fan_tangent(seam, phi);
        const Stretch at = stretch(Point(seam.point), along, 1);
        if (!begins(at, 0.0L)) {
            return;
        }
        fan(index, at.tau > 0.0L ? 1 : -1, along);
    }

private:
    /// tau in the direction of travel.
    struct Stretch {
        Point at{};
        Real tau = 0.0L;
        Real nu = 0.0L;
        Real excess = 0.0L;
    };

    /// `along`: unit, in the direction of the outline; the way goes with it or against it.
    [[nodiscard]] Stretch stretch(const Point& at, const Point& along, int direction) const {
        const Point r = Point(h_) - at;
        Stretch s{.at = at, .tau = direction * glm::dot(r, along), .nu = turn(r, along)};
        s.excess = std::fabs(s.tau) - mu_ * std::max(s.nu, 0.0L);
        return s;
    }
    [[nodiscard]] Stretch stretch_of(const SpanRows& span, Real x, Real y) const {
        const Point ahead = tangent_of(span, x, y);
        return stretch(point_of(span, x, y), span.forward ? ahead : -ahead, span.forward ? 1 : -1);
    }
    /// What rounding in doubles makes of tau and nu by turning the tangent, m.
    [[nodiscard]] Real doubt(const SpanRows& span, Real x, Real y, const Stretch& s) const {
        return turned_in_doubles(span, x, y) * std::hypot(s.tau, s.nu) * (1.0L + mu_);
    }
    /// Whether a walk may begin; if it may also stay, that is a stop.
    bool begins(const Stretch& s, Real doubt) {
        const Real band = band_ + doubt;
        if (s.excess <= band) {
            stop(s);
        }
        if (s.excess > -band && std::fabs(s.tau) <= 2.0L * band) {
            answer_.open = true;
            return false;
        }
        return s.excess > -band;
    }
    void stop(const Stretch& s, bool corner = false) {
        answer_.stops.push_back(
            {.point = Vec2(s.at), .nu = static_cast<double>(s.nu), .corner = corner});
    }
    /// Unit, along the outline, at an end of a span.
    [[nodiscard]] Point tangent(std::size_t index, bool at_end) const {
        const RationalBezier<2>& span = outline_.spans()[index];
        const auto n = static_cast<std::size_t>(span.degree());
        const std::size_t k = repeats(span, at_end) + 1;
        const Vec2& a = span.local_point(at_end ? n - k : 0);
        const Vec2& b = span.local_point(at_end ? n : k);
        return unit(Point(b) - Point(a));
    }

    /// A smooth seam, which may be hollow, has the tangents of its two ends only.
    [[nodiscard]] Point fan_tangent(const Seam& seam, double phi) const {
        const Point in = tangent(seam.before, true);
        if (seam.kind == SeamKind::smooth) {
            return phi > 0.0 ? tangent(seam.after, false) : in;
        }
        const Real c = std::cos(static_cast<Real>(phi));
        const Real s = std::sin(static_cast<Real>(phi));
        return {c * in.x + s * in.y, c * in.y - s * in.x};
    }

    void over_end(std::size_t index, bool forward) {
        const int direction = forward ? 1 : -1;
        const auto seam = outline_.seam_beyond(index, forward);
        const RationalBezier<2>& span = outline_.spans()[index];
        if (!seam) {
            const Vec2 end = span.point(forward ? static_cast<std::size_t>(span.degree()) : 0);
            stop(stretch(Point(end), tangent(index, forward), direction));
            return;
        }
        if (++visits_ > 4 * outline_.spans().size() + 8) {
            return;
        }
        if (outline_.seams()[*seam].kind == SeamKind::concave) {
            corner(*seam, direction);
        } else {
            fan(*seam, direction, tangent(index, forward));
        }
    }

    void fan(std::size_t index, int direction, const Point& along) {
        const Seam& seam = outline_.seams()[index];
        const bool forward = direction > 0;
        const Stretch near = stretch(Point(seam.point), along, direction);
        const Point beyond = tangent(forward ? seam.after : seam.before, !forward);
        const Stretch far = stretch(Point(seam.point), beyond, direction);
        if (near.excess <= band_ || near.tau <= band_ ||
            (seam.kind == SeamKind::smooth && far.tau <= band_)) {  // a smooth seam may be hollow
            stop(near);
        }
        if (near.excess <= -band_ || near.tau <= -band_) {
            return;
        }
        if (far.tau <= band_ && (near.nu <= band_ || far.nu <= band_)) {
            stop({.at = near.at, .nu = -1.0L});  // its normal lies in the fan: HIP is outside
        }
        if (far.tau > -band_) {
            leave(seam, direction);
        }
    }

    void corner(std::size_t index, int direction) {
        const Seam& seam = outline_.seams()[index];
        const Stretch on = stretch(Point(seam.point), tangent(seam.after, false), 1);
        const Stretch back = stretch(Point(seam.point), tangent(seam.before, true), -1);
        // Left along the side that drives outwards, out of its own cone, unless the other side
        // holds the god-object in its cone: on that side alone it would stay. Of two the steeper
        // one.
        const auto drives = [](const Stretch& s, Real margin) {
            return s.tau > margin && s.excess > margin;
        };
        const auto carries = [](const Stretch& s, Real margin) {
            return s.nu > margin && s.excess <= -margin;
        };
        const bool may_on = direction >= 0 && drives(on, -band_) && !carries(back, band_);
        const bool may_back = direction <= 0 && drives(back, -band_) && !carries(on, band_);
        const bool sure_on = direction >= 0 && drives(on, band_) && !carries(back, -band_);
        const bool sure_back = direction <= 0 && drives(back, band_) && !carries(on, -band_);
        if (may_on && !(sure_back && back.tau > on.tau + band_)) {
            leave(seam, 1);
        }
        if (may_back && !(sure_on && on.tau > back.tau + band_)) {
            leave(seam, -1);
        }
        if (!sure_on && !sure_back) {
            stop(on, true);
        }
    }

    void leave(const Seam& seam, int direction) {
        if (direction > 0) {
            from_span(seam.after, 0.0L, 1.0L, 1);
        } else {
            from_span(seam.before, 1.0L, 0.0L, -1);
        }
    }

    const ExactOutline& exact_;
    const Outline& outline_;
    Vec2 h_;
    Real mu_;
    ExactAnswer& answer_;
    Real band_;
    std::size_t visits_ = 0;
};

}  // namespace

ExactOutline::ExactOutline(const Outline& o) : outline(&o) {
    for (const auto& span : o.spans()) {
        on.emplace_back(span, true);
        back.emplace_back(span, false);
        for (const Vec2& p : {span.box().low, span.box().high}) {
            extent = std::max({extent, std::fabs(p.x), std::fabs(p.y)});
        }
    }
}

ExactAnswer exact_walk(const ExactOutline& outline,
                       const engine::GodObject& from,
                       const Vec2& h,
                       double mu) {
    const double extent = std::max({outline.extent, std::fabs(h.x), std::fabs(h.y)});
    ExactAnswer answer;
    answer.band = kBand * extent * (1.0 + mu);
    Explorer explorer(outline, h, mu, answer);
    if (from.place.on_seam) {
        explorer.from_seam(from.place.index, from.place.parameter);
        return answer;
    }
    const Real u = from.place.parameter;
    const bool early = u < 0.5L;
    const Real rest = early ? 1.0L - u : static_cast<Real>(from.spot.rest);
    explorer.from_span(from.place.index, early ? u : 1.0L - rest, rest, 0);
    return answer;
}

bool outside_of_some(const ExactOutline& outline, const Vec2& h, double within) {
    constexpr int kSamples = 256;
    const auto from = [&h](const SpanRows& span, Real u) {
        return Point(h) - point_of(span, u, 1.0L - u);
    };
    for (const SpanRows& span : outline.on) {
        for (int i = 1; i < kSamples; ++i) {
            Real low = (i - 1.0L) / kSamples;
            Real high = (i + 1.0L) / kSamples;
            for (int step = 0; step < 60; ++step) {
                const Real third = (high - low) / 3.0L;
                const Point a = from(span, low + third);
                const Point b = from(span, high - third);
                const bool falls = glm::dot(b, b) <= glm::dot(a, a);
                (falls ? low : high) += falls ? third : -third;
            }
            const Point r = from(span, low);
            if (glm::length(r) <= within && low > 1e-6L && low < 1.0L - 1e-6L &&
                turn(r, tangent_of(span, low, 1.0L - low)) <= 0.0L) {
                return true;
            }
        }
    }
    return false;
}

}  // namespace palpate::stress

#include "engine/geometry/arc.hpp"

#include <algorithm>
#include <array>

#include "engine/base/refuse.hpp"
#include "engine/math/elementary.hpp"

namespace palpate::engine {
namespace {

double checked_chord(const Vec2& from, const Vec2& to) {
    const double chord = glm::length(to - from);
    refuse_if(!(chord > 0.0) || !std::isfinite(chord),
              "a curve needs two finite end points apart from one another; the distance given is "
              "{:.9g} m",
              chord);
    return chord;
}

/// Lengths and weights of an arc may differ by this share, and by that of its coordinates.
constexpr double kSame = 8.0 * kEpsilon;

/// Below this half angle an arc is as long as its chord, to 1e-17.
constexpr double kShortArc = 1e-8;

}  // namespace

RationalBezier<2> make_line(const Vec2& from, const Vec2& to) {
    static_cast<void>(checked_chord(from, to));
    return RationalBezier<2>(std::array{from, to}, std::array{1.0, 1.0});
}

RationalBezier<2> make_arc(const Vec2& from, const Vec2& to, double curvature) {
    const double chord = checked_chord(from, to);
    const double sine = 0.5 * curvature * chord;
    refuse_if(!(std::fabs(sine) <= kMaxArcSine),
              "curvature {:.9g} 1/m is too strong for a chord of {:.9g} m: keep |curvature| below "
              "{:.9g} 1/m",
              curvature, chord, 2.0 * kMaxArcSine / chord);
    if (curvature == 0.0) {
        return make_line(from, to);
    }
    const double cosine = std::sqrt((1.0 - sine) * (1.0 + sine));
    const Vec2 middle = 0.5 * (from + to) + perp(to - from) * (0.5 * sine / cosine);
    return RationalBezier<2>(std::array{from, middle, to}, std::array{1.0, cosine, 1.0});
}

Arc::Arc(const RationalBezier<2>& span, double sine, double cosine)
    : sin_(sine), cos_(cosine), cos2_(0.5 * (1.0 + cosine)), sin2_(0.5 * (1.0 - cosine)) {
    const auto last = static_cast<std::size_t>(span.degree());
    const Vec2 chord = span.local_point(last) - span.local_point(0);
    const double length = glm::length(chord);
    middle_ = span.origin() + 0.5 * (span.local_point(0) + span.local_point(last));
    e_ = chord / length;
    half_ = 0.5 * length;
    quarter_ = 0.25 * length * sine;
    pull_ = half_ * cosine;
}

std::optional<Arc> Arc::of(const RationalBezier<2>& span) {
    const auto last = static_cast<std::size_t>(span.degree());
    const Vec2 chord = span.local_point(last) - span.local_point(0);
    const double length = glm::length(chord);
    if (last > 2 || !(length > 0.0)) {
        return std::nullopt;
    }
    const double share = kSame * (1.0 + glm::length(span.origin()) / length);
    const auto same = [share](double a, double b) {
        return std::fabs(a - b) <= share * b;
    };
    if (last == 1) {
        return same(span.weight(0), span.weight(1)) ? std::optional(Arc(span, 0.0, 1.0))
                                                    : std::nullopt;
    }
    const Vec2 first = span.local_point(1) - span.local_point(0);
    const Vec2 second = span.local_point(2) - span.local_point(1);
    const double leg = glm::length(first);
    const double cosine = span.weight(1) / span.weight(0);
    const double sine = 2.0 * cross(chord, first) * cosine / (length * length);
    const bool is_arc = same(span.weight(0), span.weight(2)) && same(leg, glm::length(second)) &&
                        same(glm::dot(first, chord), cosine * leg * length) &&
                        std::fabs(sine) <= kMaxArcSine;
    return is_arc ? std::optional(Arc(span, sine, cosine)) : std::nullopt;
}

double Arc::way(const Vec2& from, const Vec2& to) const noexcept {
    const double straight = glm::length(to - from);
    const double sine = std::fabs(sin_) * straight / chord();  // of half the angle between them
    if (sine < kShortArc) {
        return straight;
    }
    const double cosine = std::sqrt(std::max((1.0 - sine) * (1.0 + sine), 0.0));
    return straight * arc_tan2(sine, cosine) / sine;
}

}  // namespace palpate::engine

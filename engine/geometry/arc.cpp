#include "engine/geometry/arc.hpp"

#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "engine/base/text.hpp"

namespace palpate::engine {
namespace {

double checked_chord(const Vec2& from, const Vec2& to) {
    const double chord = glm::length(to - from);
    if (!(chord > 0.0) || !std::isfinite(chord)) {
        throw std::invalid_argument(
            "a curve needs two finite end points apart from one another; the "
            "distance given is " +
            number_text(chord) + " m");
    }
    return chord;
}

}  // namespace

RationalBezier<2> make_line(const Vec2& from, const Vec2& to) {
    static_cast<void>(checked_chord(from, to));
    return RationalBezier<2>(std::array{from, to}, std::array{1.0, 1.0});
}

RationalBezier<2> make_arc(const Vec2& from, const Vec2& to, double curvature) {
    const double chord = checked_chord(from, to);
    const double sine = 0.5 * curvature * chord;
    if (!(std::fabs(sine) <= kMaxArcSine)) {
        throw std::invalid_argument("curvature " + number_text(curvature) +
                                    " 1/m is too strong for a chord of " + number_text(chord) +
                                    " m: keep |curvature| below " +
                                    number_text(2.0 * kMaxArcSine / chord) + " 1/m");
    }
    if (curvature == 0.0) {
        return make_line(from, to);
    }
    const double cosine = std::sqrt((1.0 - sine) * (1.0 + sine));
    const Vec2 middle = 0.5 * (from + to) + perp(to - from) * (0.5 * sine / cosine);
    return RationalBezier<2>(std::array{from, middle, to}, std::array{1.0, cosine, 1.0});
}

}  // namespace palpate::engine

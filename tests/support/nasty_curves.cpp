#include "tests/support/nasty_curves.hpp"

#include "tests/support/foot_oracle.hpp"

namespace palpate::tests {
namespace {

using engine::Vec2;

/// What a family of queries may use.
struct Scene {
    const NastyFamily& family;
    const FootOracle& oracle;
    Random& random;
    double size = 1.0;
    double lo = 0.0;
    double hi = 1.0;

    [[nodiscard]] Vec2 at(double u, int derivative = 0) const {
        const auto value = oracle.at(u)[static_cast<std::size_t>(derivative)];
        return {static_cast<double>(value[0]), static_cast<double>(value[1])};
    }
    [[nodiscard]] double any_u() const { return random.in(lo, hi); }
    [[nodiscard]] Vec2 any_direction() const {
        const double angle = random.in(0.0, 2.0 * std::numbers::pi);
        return {std::cos(angle), std::sin(angle)};
    }
    /// A cusp, kink, crossing, centre of a circle, or else any point of the curve.
    [[nodiscard]] Vec2 focus() const {
        const std::size_t all = family.u.size() + family.centres.size();
        if (all == 0) {
            return at(any_u());
        }
        const auto i = random.index(all);
        return i < family.u.size() ? at(family.u[i]) : family.centres[i - family.u.size()];
    }
    [[nodiscard]] Vec2 normal(double u) const {
        const Vec2 along = at(u, 1);
        const double length = glm::length(along);
        return length > 0.0 ? engine::perp(along) / length : Vec2{0.0, 1.0};
    }
    [[nodiscard]] Vec2 curvature_centre(double u) const {
        const Vec2 first = at(u, 1);
        const double bend = engine::cross(first, at(u, 2));
        const double speed2 = glm::dot(first, first);
        const Vec2 centre = at(u) + (speed2 / bend) * engine::perp(first);
        const bool usable = std::isfinite(centre.x) && std::isfinite(centre.y) &&
                            glm::length(centre - at(u)) < 1e6 * size;
        return usable ? centre : at(u);
    }
};

Vec2 around(const Scene& s) {
    return s.at(s.any_u()) + s.size * s.random.point(-1.0, 1.0);
}
/// Halves the way between two points until their feet, far apart, are equally far.
Vec2 tie(const Scene& s) {
    Vec2 a = around(s);
    Vec2 b = around(s);
    const Vec2 foot = s.oracle.closest(a).foot();
    for (int i = 0; i < 54; ++i) {
        const Vec2 middle = 0.5 * (a + b);
        const bool with_a = glm::length(s.oracle.closest(middle).foot() - foot) < 0.1 * s.size;
        (with_a ? a : b) = middle;
    }
    return a;
}

struct Query {
    const char* name;
    Vec2 (*place)(const Scene&);
};
constexpr std::array<Query, kNastyQueries> kQueries{
    {{"around it", around},
     {"at its worst place",
      [](const Scene& s) {
          return s.focus();
      }},
     {"near its worst place",
      [](const Scene& s) {
          const Vec2 focus = s.focus();
          return focus + (s.size * s.random.decade(-16.0, 0.0)) * s.any_direction();
      }},
     {"above its worst place",
      [](const Scene& s) {
          const Vec2 focus = s.focus();
          const double sign = s.random.coin() ? 1.0 : -1.0;
          return focus + Vec2{0.0, sign * s.size * s.random.decade(-12.0, 0.5)};
      }},
     {"on the curve",
      [](const Scene& s) {
          return s.at(s.any_u());
      }},
     {"just off the curve",
      [](const Scene& s) {
          const double u = s.any_u();
          return s.at(u) + (s.size * s.random.decade(-17.0, -4.0)) * s.normal(u);
      }},
     {"centre of curvature",
      [](const Scene& s) {
          return s.curvature_centre(s.any_u());
      }},
     {"near a centre of curvature",
      [](const Scene& s) {
          const Vec2 centre = s.curvature_centre(s.any_u());
          return centre + (s.size * s.random.decade(-15.0, -2.0)) * s.any_direction();
      }},
     {"at a control point",
      [](const Scene& s) {
          const auto& points = s.family.curve.points;
          return points[static_cast<std::size_t>(s.random.below(static_cast<int>(points.size())))];
      }},
     {"beyond an end",
      [](const Scene& s) {
          const bool front = s.random.coin();
          const double u = front ? s.lo : s.hi;
          const Vec2 along = engine::perp(s.normal(u));  // backwards
          const double by = s.size * s.random.decade(-12.0, 1.0);
          return s.at(u) + (front ? by : -by) * along;
      }},
     {"far away",
      [](const Scene& s) {
          return s.at(s.any_u()) + (s.size * s.random.decade(1.0, 9.0)) * s.any_direction();
      }},
     {"on the curve close to an end",
      [](const Scene& s) {
          const double by = (s.hi - s.lo) * s.random.decade(-12.0, -1.0);
          return s.at(s.random.coin() ? s.lo + by : s.hi - by);
      }},
     {"tie", tie}}};

}  // namespace

NastyCase nasty_case(std::uint64_t seed) {
    Random random(seed);
    NastyFamily family = nasty_family(seed % kNastyCurves, random);
    const Query& query = kQueries[(seed / kNastyCurves) % kNastyQueries];
    // Powers of two keep what is exact, exact.
    const double scale =
        random.coin() ? std::exp2(random.below(31) - 20) : random.decade(-6.0, 3.0);
    for (Vec2& p : family.curve.points) {
        p *= scale;
    }
    for (Vec2& p : family.centres) {
        p *= scale;
    }
    const FootOracle oracle(family.curve);
    const double size = size_of(family.curve);
    const Scene scene{.family = family,
                      .oracle = oracle,
                      .random = random,
                      .size = size > 0.0 ? size : scale,
                      .lo = family.curve.knots.front(),
                      .hi = family.curve.knots.back()};
    const Vec2 h = query.place(scene);
    return {family.name + ", " + query.name, seed, family.curve, h};
}

double size_of(const NurbsData<2>& curve) {
    Vec2 low = curve.points[0];
    Vec2 high = low;
    for (const Vec2& p : curve.points) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    return glm::length(high - low);
}

std::string text_of(const NastyCase& nasty) {
    std::ostringstream text;
    text.precision(17);
    text << nasty.name << "\n  seed " << nasty.seed << ", degree " << nasty.curve.degree
         << ", query " << nasty.query.x << ' ' << nasty.query.y << "\n  knots";
    for (const double knot : nasty.curve.knots) {
        text << ' ' << knot;
    }
    for (std::size_t i = 0; i < nasty.curve.points.size(); ++i) {
        text << "\n  point " << nasty.curve.points[i].x << ' ' << nasty.curve.points[i].y
             << " weight " << nasty.curve.weights[i];
    }
    return text.str();
}

}  // namespace palpate::tests

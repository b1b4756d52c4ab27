#include "tests/support/nasty_curves.hpp"

namespace palpate::tests {
namespace {

using engine::Vec2;
using Family = NastyFamily;

std::vector<double> random_weights(Random& random, std::size_t count, double decades) {
    std::vector<double> weights(count, 1.0);
    for (double& w : weights) {
        w = random.decade(-decades, decades);
    }
    return weights;
}

std::vector<Vec2> random_points(Random& random, int count) {
    std::vector<Vec2> points;
    for (int i = 0; i < count; ++i) {
        points.push_back(random.point(-0.5, 0.5));
    }
    return points;
}

/// sum a_k t^k, t = 2u - 1, as a Bezier curve: b_j is the mean of t^k's blossom at j ones and n - j
/// minus ones, e_k / C(n, k). Whole coefficients stay exact where they can.
NurbsData<2> from_centred(const std::vector<Vec2>& a) {
    const std::size_t n = a.size() - 1;
    std::vector<Vec2> points;
    for (std::size_t j = 0; j <= n; ++j) {
        std::vector<double> e(n + 1, 0.0);  // elementary symmetric polynomials
        std::vector<double> all(n + 1, 0.0);
        e[0] = all[0] = 1.0;
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t k = n; k > 0; --k) {
                e[k] += (i < j ? 1.0 : -1.0) * e[k - 1];
                all[k] += all[k - 1];
            }
        }
        Vec2 b{};
        for (std::size_t k = 0; k <= n; ++k) {
            b += (e[k] * a[k]) / all[k];
        }
        points.push_back(b);
    }
    return bezier_data(points);
}

Family random_rational(Random& random) {
    return {"random, weights 1e-3..1e3", random_nurbs<2>(random, 1.0, 3.0), {}, {}};
}

Family random_polynomial(Random& random) {
    return {"random polynomial", random_nurbs<2>(random, 1.0, 0.0), {}, {}};
}

/// C = (t^odd, t^2): C' = 0 at u = 1/2, exactly.
Family exact_cusp(Random& random) {
    std::vector<Vec2> a(random.coin() ? 4 : 6, Vec2{});
    a[2] = {0.0, 1.0};
    a.back() = {1.0, 0.0};
    return {"cusp", from_centred(a), {0.5}, {}};
}

/// C' = t (A + B t) for small whole A and B: a cusp at u = 1/2 without symmetry.
Family leaning_cusp(Random& random) {
    const auto whole = [&random] {
        return static_cast<double>(6 * (random.below(9) - 4));
    };
    const double x = whole();
    const double y = whole();
    const double p = whole();
    return {"leaning cusp", from_centred({Vec2{}, Vec2{}, {x, y}, {p, whole()}}), {0.5}, {}};
}

/// Next to a cusp: a loop or a hairpin, as small as `gap`.
Family near_cusp(Random& random) {
    const double gap = (random.coin() ? 1.0 : -1.0) * random.decade(-14.0, -1.0);
    return {gap > 0.0 ? "hairpin" : "tiny loop",
            bezier_data({{-1.0, 1.0}, {1.0 - gap, -0.5}, {-1.0 + gap, -0.5}, {1.0, 1.0}}),
            {0.5},
            {}};
}

Family loop(Random& random) {
    const double reach = random.in(1.5, 4.0);
    const double t = std::sqrt((3.0 * reach - 3.0) / (3.0 * reach + 1.0));  // it crosses itself
    return {"loop",
            bezier_data({{-1.0, 0.0}, {reach, 1.0}, {-reach, 1.0}, {1.0, 0.0}}),
            {0.5, 0.5 - 0.5 * t},
            {}};
}

/// Knots repeated `degree` times: C0 kinks, sharp or nearly smooth.
Family kinks(Random& random) {
    NurbsData<2> curve;
    curve.degree = 1 + random.below(9);
    const int pieces = 2 + random.below(4);
    const auto p = static_cast<std::size_t>(curve.degree);
    curve.knots.assign(p + 1, 0.0);
    Family family{"kinks", {}, {}, {}};
    for (int i = 1; i < pieces; ++i) {
        curve.knots.insert(curve.knots.end(), p, static_cast<double>(i));
        family.u.push_back(i);
    }
    curve.knots.insert(curve.knots.end(), p + 1, static_cast<double>(pieces));
    curve.points = random_points(random, pieces * curve.degree + 1);
    curve.weights = random_weights(random, curve.points.size(), random.coin() ? 1.0 : 3.0);
    family.curve = curve;
    return family;
}

/// Control points that repeat, at the ends too: C' = 0 there.
Family repeated_points(Random& random) {
    const int degree = 2 + random.below(8);
    std::vector<Vec2> points = random_points(random, degree + 1);
    const int times = 1 + random.below(degree);
    const int first = random.coin() ? 0 : random.below(degree + 1 - times);
    for (int i = 0; i < times; ++i) {
        points[static_cast<std::size_t>(first + i + 1)] = points[static_cast<std::size_t>(first)];
    }
    if (random.coin()) {
        points.back() = points.front();
    }
    return {"repeated control points",
            bezier_data(points, random_weights(random, points.size(), random.coin() ? 0.0 : 3.0)),
            {0.0, 1.0},
            {}};
}

/// Degree 2 to 9 on one line, to and fro.
Family straight(Random& random) {
    const int degree = 1 + random.below(9);
    const Vec2 along = random.coin() ? Vec2{1.0, 0.0} : random.point(-1.0, 1.0);
    std::vector<Vec2> points;
    for (int i = 0; i <= degree; ++i) {
        points.push_back(random.in(-0.5, 0.5) * along);
    }
    return {"straight line of high degree",
            bezier_data(points, random_weights(random, points.size(), random.coin() ? 0.0 : 3.0)),
            {0.0, 1.0},
            {}};
}

Family tiny_turn(Random& random) {
    const int degree = 2 + random.below(8);
    const double bend = random.decade(-16.0, -4.0);
    std::vector<Vec2> points;
    for (int i = 0; i <= degree; ++i) {
        points.push_back({static_cast<double>(i) / degree - 0.5, bend * random.in(-1.0, 1.0)});
    }
    return {"nearly a line", bezier_data(points), {}, {}};
}

/// Whole circle of four quadratics: every point is a foot of the centre.
Family circle(Random& random) {
    const double s = std::numbers::sqrt2 / 2.0;
    NurbsData<2> curve;
    curve.degree = 2;
    curve.knots = {0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4};
    curve.points = {{1, 0}, {1, -1}, {0, -1}, {-1, -1}, {-1, 0}, {-1, 1}, {0, 1}, {1, 1}, {1, 0}};
    curve.weights = {1, s, 1, s, 1, s, 1, s, 1};
    const Vec2 centre = random.point(-3.0, 3.0);
    for (Vec2& p : curve.points) {
        p += centre;
    }
    return {"circle", curve, {0.0, 1.0, 2.0}, {centre}};
}

/// y = t^2 (+ t^4 (+ 2 t^6)) against its circle of curvature about (0, 1/2): |C - h|^2 = 1/4 + t^4,
/// 2 t^6 or 5 t^8, the flattest minima there are.
Family flat_minimum(Random& random) {
    std::vector<Vec2> a(3 + 2 * random.index(3), Vec2{});
    a[1] = {1.0, 0.0};
    a[2] = {0.0, 1.0};
    if (a.size() > 3) {
        a[4] = {0.0, 1.0};
    }
    if (a.size() > 5) {
        a[6] = {0.0, 2.0};
    }
    return {"flat minimum", from_centred(a), {0.5}, {Vec2{0.0, 0.5}}};
}

/// C = (t, lift t^4): no curvature at its bottom.
Family flat_curve(Random& random) {
    const double lift = random.decade(-6.0, 1.0);
    return {
        "flat bottom", from_centred({Vec2{}, {1.0, 0.0}, Vec2{}, Vec2{}, {0.0, lift}}), {0.5}, {}};
}

Family alternating_weights(Random& random) {
    const int degree = 2 + random.below(8);
    std::vector<double> weights;
    for (int i = 0; i <= degree; ++i) {
        weights.push_back((i % 2 == 0) == random.coin() ? 1e-3 : 1e3);
    }
    return {"weights 1e-3 and 1e3 side by side",
            bezier_data(random_points(random, degree + 1), weights),
            {0.0, 1.0},
            {}};
}

/// Weights that fall or rise through the whole range: all of the curve happens at one end of u.
Family steep_weights(Random& random) {
    const int degree = 2 + random.below(8);
    const double sign = random.coin() ? 1.0 : -1.0;
    std::vector<double> weights;
    for (int i = 0; i <= degree; ++i) {
        weights.push_back(std::pow(10.0, sign * (6.0 * i / degree - 3.0)));
    }
    return {"weights from 1e-3 to 1e3",
            bezier_data(random_points(random, degree + 1), weights),
            {0.0, 1.0},
            {}};
}

/// Spans of very different length side by side, C1 and more.
Family uneven_knots(Random& random) {
    NurbsData<2> curve;
    curve.degree = 2 + random.below(8);
    const auto p = static_cast<std::size_t>(curve.degree);
    curve.knots.assign(p + 1, 0.0);
    double at = 0.0;
    Family family{"knots of uneven spacing", {}, {}, {}};
    for (int i = 0; i < 6; ++i) {
        at += random.decade(-9.0, 0.0);
        curve.knots.push_back(at);
        family.u.push_back(at);
    }
    at += random.decade(-9.0, 0.0);
    curve.knots.insert(curve.knots.end(), p + 1, at);
    curve.points = random_points(random, curve.degree + 7);
    curve.weights = random_weights(random, curve.points.size(), random.coin() ? 0.0 : 1.0);
    family.curve = curve;
    return family;
}

/// A curve far from the origin of the world, as seen from its own size.
Family far_object(Random& random) {
    Family family{"object far from the origin", random_nurbs<2>(random, 1.0, 1.0), {}, {}};
    const Vec2 away = random.decade(0.0, 2.0) * random.point(-1.0, 1.0);
    for (Vec2& p : family.curve.points) {
        p += away;
    }
    return family;
}

/// One point, said many times, or two points.
Family collapsed(Random& random) {
    const int degree = 1 + random.below(9);
    std::vector<Vec2> points(static_cast<std::size_t>(degree) + 1, random.point(-0.5, 0.5));
    if (random.coin()) {
        points.back() = random.point(-0.5, 0.5);
    }
    return {"control points all in one or two places", bezier_data(points), {0.0, 1.0}, {}};
}

/// All control points mirrored: the axis is equidistant to two branches.
Family mirrored(Random& random) {
    const int degree = 2 + random.below(8);
    std::vector<Vec2> points(static_cast<std::size_t>(degree) + 1);
    std::vector<double> weights = random_weights(random, points.size(), random.coin() ? 0.0 : 2.0);
    for (std::size_t i = 0; i <= points.size() / 2; ++i) {
        points[i] = random.point(-0.5, 0.5);
        points[points.size() - 1 - i] = Vec2{-points[i].x, points[i].y};
        weights[points.size() - 1 - i] = weights[i];
    }
    if (degree % 2 == 0) {
        points[points.size() / 2].x = 0.0;
    }
    return {"mirrored branches", bezier_data(points, weights), {0.5}, {}};
}

using MakeFamily = Family (*)(Random&);
constexpr MakeFamily kFamilies[] = {random_rational,
                                    random_polynomial,
                                    exact_cusp,
                                    leaning_cusp,
                                    near_cusp,
                                    loop,
                                    kinks,
                                    repeated_points,
                                    straight,
                                    tiny_turn,
                                    circle,
                                    flat_minimum,
                                    flat_curve,
                                    steep_weights,
                                    alternating_weights,
                                    uneven_knots,
                                    far_object,
                                    mirrored,
                                    collapsed};
static_assert(std::size(kFamilies) == kNastyCurves);

}  // namespace

NastyFamily nasty_family(std::uint64_t index, Random& random) {
    return kFamilies[index](random);
}

}  // namespace palpate::tests

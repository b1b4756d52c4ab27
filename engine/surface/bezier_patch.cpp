#include "engine/surface/bezier_patch.hpp"

#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <type_traits>

namespace palpate::engine {
namespace {

/// What loops of any length cost against those of a known one, measured.
constexpr Work kUnrolled = 3;

constexpr std::size_t kMaxPoints = kMaxDegree + 1;

template <int N>
using Degree = std::integral_constant<int, N>;

/// Room for a line of control points: as many as the degree needs where it is known.
template <class N>
struct Room {
    using Line = std::array<Quad, kMaxPoints>;
    static Line fresh() noexcept { return Line{}; }
};
template <int N>
struct Room<Degree<N>> {
    using Line = std::array<Quad, static_cast<std::size_t>(N) + 1>;
    static Line fresh() noexcept {
        Line line;  // every place is written before it is read
        return line;
    }
};

/// Value and derivatives of one line of control points, per unit of u.
struct Line {
    Quad value;
    Quad first;
    Quad second;
};

/// De Casteljau's scheme; `b` is overwritten. `n` is an int or a Degree<N>.
template <class N>
inline Line cut_line(typename Room<N>::Line& b, N n, double u) noexcept {
    const double v = 1.0 - u;
    for (int level = n; level > 2; --level) {
        for (int i = 0; i < level; ++i) {
            const auto k = static_cast<std::size_t>(i);
            b[k] = v * b[k] + u * b[k + 1];
        }
    }
    const double degree = n;
    Line line;
    line.second = Quad{};
    if (n >= 2) {
        line.second = (degree * (degree - 1.0)) * ((b[2] - b[1]) - (b[1] - b[0]));
        b[0] = v * b[0] + u * b[1];
        b[1] = v * b[1] + u * b[2];
    }
    line.first = degree * (b[1] - b[0]);
    line.value = v * b[0] + u * b[1];
    return line;
}

/// S W and W with their derivatives.
struct HomogeneousJet {
    Line u;      ///< value, d/du, d2/du2
    Line v;      ///< value again, d/dv, d2/dv2
    Quad mixed;  ///< d2/du dv
};

template <class P, class Q>
inline HomogeneousJet cut_net(const Quad* net, P p, Q q, double u, double v) noexcept {
    typename Room<Q>::Line value = Room<Q>::fresh();
    typename Room<Q>::Line first = Room<Q>::fresh();
    typename Room<Q>::Line second = Room<Q>::fresh();
    for (int j = 0; j <= q; ++j) {
        typename Room<P>::Line column = Room<P>::fresh();
        for (int i = 0; i <= p; ++i) {
            column[static_cast<std::size_t>(i)] = net[i * (q + 1) + j];
        }
        const Line line = cut_line<P>(column, p, u);
        const auto k = static_cast<std::size_t>(j);
        value[k] = line.value;
        first[k] = line.first;
        second[k] = line.second;
    }
    HomogeneousJet jet;
    jet.v = cut_line<Q>(value, q, v);
    const Line slope = cut_line<Q>(first, q, v);
    jet.u.value = jet.v.value;
    jet.u.first = slope.value;
    jet.mixed = slope.first;
    jet.u.second = cut_line<Q>(second, q, v).value;
    return jet;
}

/// The quotient rule (The NURBS Book, eq. 4.20), solved from the value upwards.
inline SurfaceJet divide(const HomogeneousJet& h) noexcept {
    const double inverse = 1.0 / h.v.value.w();
    const Quad s = inverse * h.v.value;
    const Quad su = inverse * (h.u.first - h.u.first.w() * s);
    const Quad sv = inverse * (h.v.first - h.v.first.w() * s);
    SurfaceJet jet;
    jet.point = s.xyz();
    jet.du = su.xyz();
    jet.dv = sv.xyz();
    jet.duu = (inverse * (h.u.second - (2.0 * h.u.first.w()) * su - h.u.second.w() * s)).xyz();
    jet.duv =
        (inverse * (h.mixed - h.u.first.w() * sv - h.v.first.w() * su - h.mixed.w() * s)).xyz();
    jet.dvv = (inverse * (h.v.second - (2.0 * h.v.first.w()) * sv - h.v.second.w() * s)).xyz();
    return jet;
}

/// Bernstein polynomials of degree 3, 2 and 1 at u, the lower ones times 3 and 6: applied to
/// control points, their first and their second differences they give value and derivatives. The
/// same convex combinations as corner cutting, but side by side instead of one after the other.
struct CubicBasis {
    std::array<double, 4> value;
    std::array<double, 3> first;
    std::array<double, 2> second;

    explicit CubicBasis(double u) noexcept {
        const double v = 1.0 - u;
        const double uu = u * u;
        const double vv = v * v;
        const double uv = u * v;
        value = {vv * v, 3.0 * (uv * v), 3.0 * (uv * u), uu * u};
        first = {3.0 * vv, 6.0 * uv, 3.0 * uu};
        second = {6.0 * v, 6.0 * u};
    }
};

inline Quad blend(const std::array<double, 4>& b, const Quad* c, std::size_t step) noexcept {
    return (b[0] * c[0] + b[1] * c[step]) + (b[2] * c[2 * step] + b[3] * c[3 * step]);
}
inline Quad blend(const std::array<double, 3>& b, const Quad* c, std::size_t step) noexcept {
    return (b[0] * c[0] + b[1] * c[step]) + b[2] * c[2 * step];
}
inline Quad blend(const std::array<double, 2>& b, const Quad* c, std::size_t step) noexcept {
    return b[0] * c[0] + b[1] * c[step];
}

/// First and second differences of n + 1 values.
template <std::size_t N>
inline std::array<Quad, N> differences(const std::array<Quad, N + 1>& c) noexcept {
    std::array<Quad, N> d;
    for (std::size_t k = 0; k < N; ++k) {
        d[k] = c[k + 1] - c[k];
    }
    return d;
}

/// `net`: 4 x 4 control values, then 3 x 4 first and 2 x 4 second differences along u.
inline HomogeneousJet bicubic(const Quad* net, double u, double v) noexcept {
    const CubicBasis bu(u);
    const CubicBasis bv(v);
    std::array<Quad, 4> value;
    std::array<Quad, 4> first;
    std::array<Quad, 4> second;
    for (std::size_t j = 0; j < 4; ++j) {
        value[j] = blend(bu.value, net + j, 4);
        first[j] = blend(bu.first, net + 16 + j, 4);
        second[j] = blend(bu.second, net + 28 + j, 4);
    }
    const std::array<Quad, 3> value_v = differences<3>(value);
    const std::array<Quad, 3> first_v = differences<3>(first);
    const std::array<Quad, 2> value_vv = differences<2>(value_v);
    HomogeneousJet jet;
    jet.v.value = blend(bv.value, value.data(), 1);
    jet.v.first = blend(bv.first, value_v.data(), 1);
    jet.v.second = blend(bv.second, value_vv.data(), 1);
    jet.u.value = jet.v.value;
    jet.u.first = blend(bv.value, first.data(), 1);
    jet.u.second = blend(bv.value, second.data(), 1);
    jet.mixed = blend(bv.first, first_v.data(), 1);
    return jet;
}

/// The net of a bicubic patch with its differences along u.
std::vector<Quad> with_differences(const std::vector<Quad>& net) {
    std::vector<Quad> all = net;
    for (std::size_t from : {std::size_t{0}, std::size_t{16}}) {
        const std::size_t rows = from == 0 ? 3 : 2;
        for (std::size_t k = 0; k < 4 * rows; ++k) {
            all.push_back(all[from + k + 4] - all[from + k]);
        }
    }
    return all;
}

/// Value, slope and half the second derivative of c0 + c1 u + c2 u^2 + c3 u^3: Horner's scheme
/// three times over, sharing c3 u.
inline Line horner(
    const Quad& c0, const Quad& c1, const Quad& c2, const Quad& c3, double u) noexcept {
    const Quad t = u * c3;
    const Quad p = c2 + t;
    const Quad q = p + t;
    const Quad r = c1 + u * p;
    return {.value = c0 + u * r, .first = r + u * q, .second = q + t};
}

/// `c`: coefficients of u^i v^j at 4 i + j.
inline SurfaceJet by_powers(const Quad* c, double u, double v) noexcept {
    std::array<Line, 4> r;
    for (std::size_t i = 0; i < 4; ++i) {
        r[i] = horner(c[4 * i], c[4 * i + 1], c[4 * i + 2], c[4 * i + 3], v);
    }
    const Line s = horner(r[0].value, r[1].value, r[2].value, r[3].value, u);
    const Line sv = horner(r[0].first, r[1].first, r[2].first, r[3].first, u);
    const Line svv = horner(r[0].second, r[1].second, r[2].second, r[3].second, u);
    return {.point = s.value.xyz(),
            .du = s.first.xyz(),
            .dv = sv.value.xyz(),
            .duu = (2.0 * s.second).xyz(),
            .duv = sv.first.xyz(),
            .dvv = (2.0 * svv.value).xyz()};
}

/// Coefficients of 1, u, u^2, u^3 from Bezier values, by forward differences.
std::array<Quad, 4> powers(const std::array<Quad, 4>& b, int degree) {
    const double n = degree;
    std::array<Quad, 4> c{};
    c[0] = b[0];
    c[1] = n * (b[1] - b[0]);
    if (degree >= 2) {
        c[2] = (0.5 * n * (n - 1.0)) * ((b[2] - b[1]) - (b[1] - b[0]));
    }
    if (degree == 3) {
        c[3] = (b[3] - b[0]) - 3.0 * (b[2] - b[1]);
    }
    return c;
}

void check_degree(int degree, const char* name) {
    if (degree < 1 || degree > kMaxDegree) {
        throw std::invalid_argument(std::string(name) + " is " + std::to_string(degree) +
                                    ": give 1 to " + std::to_string(kMaxDegree));
    }
}

}  // namespace

BezierPatch::BezierPatch(int degree_u, int degree_v, std::span<const Quad> net, bool polynomial)
    : degree_u_(degree_u),
      degree_v_(degree_v),
      polynomial_(polynomial),
      net_(net.begin(), net.end()) {
    check_degree(degree_u, "degree_u");
    check_degree(degree_v, "degree_v");
    const auto levels = [](int n) {
        return n * (n + 1) / 2 + 6;
    };
    work_ = 2 * ((degree_v + 1) * levels(degree_u) + 3 * levels(degree_v));
    const auto needed = static_cast<std::size_t>((degree_u + 1) * (degree_v + 1));
    if (net.size() != needed) {
        throw std::invalid_argument("a patch of degree " + std::to_string(degree_u) + " x " +
                                    std::to_string(degree_v) + " needs " + std::to_string(needed) +
                                    " control points, not " + std::to_string(net.size()));
    }
    if (!polynomial || degree_u > 3 || degree_v > 3) {
        method_ = degree_u == 3 && degree_v == 3 ? Method::bicubic
                : degree_u == 2 && degree_v == 2 ? Method::biquadratic
                                                 : Method::any;
        if (method_ == Method::bicubic) {
            prepared_ = with_differences(net_);
        }
        if (method_ == Method::any) {
            work_ *= kUnrolled;
        }
        return;
    }
    method_ = Method::powers;
    std::array<std::array<Quad, 4>, 4> rows{};  // powers of v for each control row
    for (int i = 0; i <= degree_u; ++i) {
        std::array<Quad, 4> line{};
        for (int j = 0; j <= degree_v; ++j) {
            line[static_cast<std::size_t>(j)] = this->net(i, j);
        }
        rows[static_cast<std::size_t>(i)] = powers(line, degree_v);
    }
    prepared_.resize(16);
    for (std::size_t j = 0; j < 4; ++j) {
        const std::array<Quad, 4> column =
            powers({rows[0][j], rows[1][j], rows[2][j], rows[3][j]}, degree_u);
        for (std::size_t i = 0; i < 4; ++i) {
            prepared_[4 * i + j] = column[i];
        }
    }
}

SurfaceJet BezierPatch::at(double u, double v) const noexcept {
    switch (method_) {
        case Method::powers:
            return by_powers(prepared_.data(), u, v);
        case Method::bicubic:
            return divide(bicubic(prepared_.data(), u, v));
        case Method::biquadratic:
            return divide(cut_net(net_.data(), Degree<2>{}, Degree<2>{}, u, v));
        default:
            return divide(cut_net(net_.data(), degree_u_, degree_v_, u, v));
    }
}

/// The shape operator in an orthonormal frame of the tangent plane: half the difference of its
/// eigenvalues is then a length of two small numbers, not the root of a cancelled difference.
Curvatures principal_curvatures(const SurfaceJet& jet, const Vec3& normal) noexcept {
    const double e = glm::dot(jet.du, jet.du);
    const Vec3 area = glm::cross(jet.du, jet.dv);
    const double area2 = glm::dot(area, area);  // e g - f^2 without its cancellation
    if (!(e > 0.0) || !(area2 > 0.0)) {
        return {};
    }
    const double shear = glm::dot(jet.du, jet.dv) / e;
    const double height2 = area2 / e;  // of dv above du
    const double l = -glm::dot(jet.duu, normal);
    const double m = -glm::dot(jet.duv, normal);
    const double n = -glm::dot(jet.dvv, normal);
    const double a = l / e;
    const double b = (m - shear * l) / std::sqrt(area2);
    const double c = (n - shear * (2.0 * m - shear * l)) / height2;
    const double mean = 0.5 * (a + c);
    const double skew = 0.5 * (a - c);
    const double half = std::sqrt(skew * skew + b * b);
    return {mean - half, mean + half};
}

}  // namespace palpate::engine

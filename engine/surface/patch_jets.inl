// Value and derivatives of a patch, in the arithmetic of `Number`: homogeneous coordinates as Quad
// has them, made of one by number(). A part of bezier_patch.cpp, once for all processors and once
// for those with AVX2.

/// Room for a line of control points: as many as the degree needs where it is known. Every place is
/// written before it is read.
template <class N>
struct Room {
    using Line = std::array<Number, kMaxPoints>;
};
template <int N>
struct Room<Degree<N>> {
    using Line = std::array<Number, static_cast<std::size_t>(N) + 1>;
};

/// Value and derivatives of one line of control points, per unit of u.
struct Line {
    Number value;
    Number first;
    Number second;
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
    line.second = Number{};
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
    Line u;        ///< value, d/du, d2/du2
    Line v;        ///< value again, d/dv, d2/dv2
    Number mixed;  ///< d2/du dv
};

template <class P, class Q>
inline HomogeneousJet cut_net(const Quad* net, P p, Q q, double u, double v) noexcept {
    if (p < 1 || q < 1) {
        __builtin_unreachable();  // says that the first two places are written
    }
    typename Room<Q>::Line value;
    typename Room<Q>::Line first;
    typename Room<Q>::Line second;
    for (int j = 0; j <= q; ++j) {
        typename Room<P>::Line column;
        for (int i = 0; i <= p; ++i) {
            column[static_cast<std::size_t>(i)] = number(net[i * (q + 1) + j]);
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

/// Each with its w, which nobody reads, in the place that SurfaceJet leaves for it: packed without
/// them, two coordinates read at once may come from two writes, and wait until both are in memory.
inline SurfaceJet jet_of(const Number& point,
                         const Number& du,
                         const Number& dv,
                         const Number& duu,
                         const Number& duv,
                         const Number& dvv) noexcept {
    SurfaceJet jet;
    static_assert(sizeof jet == 6 * sizeof(Number));
    char* to = reinterpret_cast<char*>(&jet);
    put(point, to);
    put(du, to + sizeof(Number));
    put(dv, to + 2 * sizeof(Number));
    put(duu, to + 3 * sizeof(Number));
    put(duv, to + 4 * sizeof(Number));
    put(dvv, to + 5 * sizeof(Number));
    return jet;
}

/// The quotient rule (The NURBS Book, eq. 4.20), solved from the value upwards.
inline SurfaceJet divide(const HomogeneousJet& h) noexcept {
    const double inverse = 1.0 / h.v.value.w();
    const Number s = inverse * h.v.value;
    const Number su = inverse * (h.u.first - h.u.first.w() * s);
    const Number sv = inverse * (h.v.first - h.v.first.w() * s);
    return jet_of(s, su, sv,
                  inverse * (h.u.second - (2.0 * h.u.first.w()) * su - h.u.second.w() * s),
                  inverse * (h.mixed - h.u.first.w() * sv - h.v.first.w() * su - h.mixed.w() * s),
                  inverse * (h.v.second - (2.0 * h.v.first.w()) * sv - h.v.second.w() * s));
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

template <class Control>
inline Number blend(const std::array<double, 4>& b, const Control* c, std::size_t step) noexcept {
    return (b[0] * number(c[0]) + b[1] * number(c[step])) +
           (b[2] * number(c[2 * step]) + b[3] * number(c[3 * step]));
}
template <class Control>
inline Number blend(const std::array<double, 3>& b, const Control* c, std::size_t step) noexcept {
    return (b[0] * number(c[0]) + b[1] * number(c[step])) + b[2] * number(c[2 * step]);
}
template <class Control>
inline Number blend(const std::array<double, 2>& b, const Control* c, std::size_t step) noexcept {
    return b[0] * number(c[0]) + b[1] * number(c[step]);
}

/// First and second differences of n + 1 values.
template <std::size_t N>
inline std::array<Number, N> differences(const std::array<Number, N + 1>& c) noexcept {
    std::array<Number, N> d;
    for (std::size_t k = 0; k < N; ++k) {
        d[k] = c[k + 1] - c[k];
    }
    return d;
}

/// `net`: 4 x 4 control values, then 3 x 4 first and 2 x 4 second differences along u.
inline HomogeneousJet bicubic(const Quad* net, double u, double v) noexcept {
    const CubicBasis bu(u);
    const CubicBasis bv(v);
    std::array<Number, 4> value;
    std::array<Number, 4> first;
    std::array<Number, 4> second;
    for (std::size_t j = 0; j < 4; ++j) {
        value[j] = blend(bu.value, net + j, 4);
        first[j] = blend(bu.first, net + 16 + j, 4);
        second[j] = blend(bu.second, net + 28 + j, 4);
    }
    const std::array<Number, 3> value_v = differences<3>(value);
    const std::array<Number, 3> first_v = differences<3>(first);
    const std::array<Number, 2> value_vv = differences<2>(value_v);
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

/// Value, slope and half the second derivative of c0 + c1 u + c2 u^2 + c3 u^3: Horner's scheme
/// three times over, sharing c3 u.
inline Line horner(
    const Number& c0, const Number& c1, const Number& c2, const Number& c3, double u) noexcept {
    const Number t = u * c3;
    const Number p = c2 + t;
    const Number q = p + t;
    const Number r = c1 + u * p;
    return {.value = c0 + u * r, .first = r + u * q, .second = q + t};
}

/// `c`: coefficients of u^i v^j at 4 i + j.
[[gnu::always_inline]] inline SurfaceJet by_powers(const Quad* c, double u, double v) noexcept {
    std::array<Line, 4> r;
    for (std::size_t i = 0; i < 4; ++i) {
        r[i] = horner(number(c[4 * i]), number(c[4 * i + 1]), number(c[4 * i + 2]),
                      number(c[4 * i + 3]), v);
    }
    const Line s = horner(r[0].value, r[1].value, r[2].value, r[3].value, u);
    const Line sv = horner(r[0].first, r[1].first, r[2].first, r[3].first, u);
    const Line svv = horner(r[0].second, r[1].second, r[2].second, r[3].second, u);
    return jet_of(s.value, s.first, sv.value, 2.0 * s.second, sv.first, 2.0 * svv.value);
}

/// BezierPatch::at by each method.
struct Jets {
    static SurfaceJet powers(const Quad* c, int /*p*/, int /*q*/, double u, double v) noexcept {
        return by_powers(c, u, v);
    }
    static SurfaceJet cubic(const Quad* net, int /*p*/, int /*q*/, double u, double v) noexcept {
        return divide(bicubic(net, u, v));
    }
    static SurfaceJet square(const Quad* net, int /*p*/, int /*q*/, double u, double v) noexcept {
        return divide(cut_net(net, Degree<2>{}, Degree<2>{}, u, v));
    }
    static SurfaceJet any(const Quad* net, int p, int q, double u, double v) noexcept {
        return divide(cut_net(net, p, q, u, v));
    }
};

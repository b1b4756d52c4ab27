#include "tests/stress/exact_forms.hpp"

#include <boost/math/tools/toms748_solve.hpp>

namespace palpate::stress {
namespace {

using namespace palpate::engine;

/// Rounding of a product of forms, relative to its terms.
constexpr Real kNoise = 0x1p-57L;

/// The same in the doubles that the walk has: a few roundings of 2^-53.
constexpr Real kDoubleNoise = 0x1p-51L;

/// Roots nearer to each other than 2^-60 of a span are one.
constexpr int kMaxHalvings = 60;

/// Pascal's triangle, exact.
constexpr std::size_t kMaxRow = 3 * engine::kMaxDegree + 1;
constexpr auto kChoose = [] {
    std::array<std::array<Real, kMaxRow>, kMaxRow> all{};
    for (std::size_t n = 0; n < kMaxRow; ++n) {
        all[n][0] = all[n][n] = 1.0L;
        for (std::size_t k = 1; k < n; ++k) {
            all[n][k] = all[n - 1][k - 1] + all[n - 1][k];
        }
    }
    return all;
}();

Real choose(std::size_t n, std::size_t k) {
    return kChoose[n][k];
}

/// Bernstein products and slopes, of values or of their magnitudes.
Row times(const Row& f, const Row& g, bool sizes) {
    const std::size_t m = f.size() - 1;
    const std::size_t n = g.size() - 1;
    Row fg(m + n + 1, 0.0L);
    for (std::size_t i = 0; i <= m; ++i) {
        for (std::size_t j = 0; j <= n; ++j) {
            const Real term = choose(m, i) * choose(n, j) * f[i] * g[j];
            fg[i + j] += sizes ? std::fabs(term) : term;
        }
    }
    for (std::size_t k = 0; k <= m + n; ++k) {
        fg[k] /= choose(m + n, k);
    }
    return fg;
}
Row slope(const Row& f, bool sizes) {
    Row d(f.size() - 1);
    for (std::size_t i = 0; i < d.size(); ++i) {
        d[i] = static_cast<Real>(d.size()) *
               (sizes ? std::fabs(f[i + 1]) + std::fabs(f[i]) : f[i + 1] - f[i]);
    }
    return d;
}
Row plus(Row f, const Row& g, Real share) {
    for (std::size_t i = 0; i < f.size(); ++i) {
        f[i] += share * g[i];
    }
    return f;
}

/// f / (t^first (1 - t)^last).
Row without(const Row& f, std::size_t first, std::size_t last) {
    const std::size_t n = f.size() - 1;
    const std::size_t left = n - first - last;
    Row rest(left + 1);
    for (std::size_t i = 0; i <= left; ++i) {
        rest[i] = f[i + first] * choose(n, i + first) / choose(left, i);
    }
    return rest;
}

/// The end of [x, 1] of a Bernstein row.
void keep_end(Row& f, Real x, Real y) {
    for (std::size_t left = f.size() - 1; left > 0; --left) {
        for (std::size_t i = 0; i < left; ++i) {
            f[i] = y * f[i] + x * f[i + 1];
        }
    }
}

/// A row at x in [0, 1].
Real value(Row f, Real x, Real y) {
    keep_end(f, x, y);
    return f[0];
}

/// The first half of a row, which becomes its second half.
Row halved(Row& f) {
    Row left(f.size());
    for (std::size_t k = 0; k < f.size(); ++k) {
        left[k] = f[0];
        for (std::size_t i = 0; i + 1 < f.size() - k; ++i) {
            f[i] = 0.5L * (f[i] + f[i + 1]);
        }
    }
    return left;
}

enum class Signs { above, falls, other };

Signs signs_of(const Row& f, const Row& noise) {
    std::size_t i = 0;
    for (; i < f.size() && f[i] > noise[i]; ++i) {
    }
    if (i == f.size()) {
        return Signs::above;
    }
    const bool starts = i > 0;
    for (; i < f.size() && f[i] < -noise[i]; ++i) {
    }
    return starts && i == f.size() ? Signs::falls : Signs::other;
}

/// Where min(a, b) + share noise falls through 0, once (Alefeld, Potra & Shi 1995).
Real closed_in(const Row& a, const Row& b, const Row& noise, Real share) {
    const Row with_a = plus(a, noise, share);
    const Row with_b = plus(b, noise, share);
    const auto least = [&](Real x) {
        return std::min(value(with_a, x, 1.0L - x), value(with_b, x, 1.0L - x));
    };
    std::uintmax_t looks = 200;
    return boost::math::tools::toms748_solve(least, 0.0L, 1.0L,
                                             boost::math::tools::eps_tolerance<Real>(), looks)
        .second;
}

bool first_of(Row a, Row b, Row noise, Real from, Real width, int halvings, Roots& roots) {
    const Signs of_a = signs_of(a, noise);
    const Signs of_b = signs_of(b, noise);
    if (of_a == Signs::above && of_b == Signs::above) {
        return false;
    }
    if (of_a != Signs::other && of_b != Signs::other) {
        roots.at.push_back({from + width * closed_in(a, b, noise, -1.0L),
                            from + width * closed_in(a, b, noise, 1.0L)});
        return true;
    }
    const auto inside = [&](std::size_t i) {
        return std::min(a[i], b[i]) < -noise[i];
    };
    if (inside(0)) {
        roots.at.push_back({from, from});
        return true;
    }
    const auto blank = [&noise](const Row& f) {
        std::size_t i = 0;
        while (i < f.size() && std::fabs(f[i]) <= noise[i]) {
            ++i;
        }
        return i == f.size();
    };
    if (blank(a) || blank(b)) {
        roots.blank = true;  // as at the centre of an arc
        return true;
    }
    if (halvings == kMaxHalvings) {
        roots.at.push_back({from, from});  // a tie: here, or further on
        return inside(a.size() - 1);
    }
    const Row left_a = halved(a);
    const Row left_b = halved(b);
    const Row left_noise = halved(noise);
    width *= 0.5L;
    return first_of(left_a, left_b, left_noise, from, width, halvings + 1, roots) ||
           first_of(a, b, noise, from + width, width, halvings + 1, roots);
}

}  // namespace

Real turn(const Point& a, const Point& b) {
    return a.x * b.y - a.y * b.x;
}
Point unit(const Point& a) {
    return a / std::sqrt(glm::dot(a, a));
}

std::size_t repeats(const RationalBezier<2>& span, bool at_end) {
    const auto n = static_cast<std::size_t>(span.degree());
    std::size_t count = 0;
    while (count + 1 < n && span.local_point(at_end ? n - 1 - count : count + 1) ==
                                span.local_point(at_end ? n : 0)) {
        ++count;
    }
    return count;
}

SpanRows::SpanRows(const RationalBezier<2>& span, bool forwards)
    : first(repeats(span, !forwards)),
      last(repeats(span, forwards)),
      origin{span.origin().x, span.origin().y},
      forward(forwards) {
    const auto n = static_cast<std::size_t>(span.degree());
    for (std::size_t i = 0; i <= n; ++i) {
        const std::size_t k = forward ? i : n - i;
        w.push_back(span.weight(k));
        px.push_back(w[i] * span.local_point(k).x);
        py.push_back(w[i] * span.local_point(k).y);
    }
    const auto hodograph = [&](const Row& p, bool of_sizes) {
        return plus(times(slope(p, of_sizes), w, of_sizes), times(p, slope(w, of_sizes), of_sizes),
                    of_sizes ? 1.0L : -1.0L);
    };
    nx = hodograph(px, false);
    ny = hodograph(py, false);
    sizes = plus(hodograph(px, true), hodograph(py, true), 1.0L);
    tx = without(nx, first, last);
    ty = without(ny, first, last);
}

Point point_of(const SpanRows& span, Real x, Real y) {
    const Real w = value(span.w, x, y);
    return {span.origin.x + value(span.px, x, y) / w, span.origin.y + value(span.py, x, y) / w};
}

Point tangent_of(const SpanRows& span, Real x, Real y) {
    return unit({value(span.tx, x, y), value(span.ty, x, y)});
}

Real turned_in_doubles(const SpanRows& span, Real x, Real y) {
    const Real speed = std::hypot(value(span.nx, x, y), value(span.ny, x, y));
    const Real rounding = kDoubleNoise * value(span.sizes, x, y);
    return rounding < 2.0L * speed ? rounding / speed : 2.0L;
}

Ahead ahead_of(const SpanRows& span, const Vec2& h, Real mu, Real x, Real y) {
    Ahead out;
    out.span = &span;
    out.x = x;
    out.y = y;
    Row qx = span.px;  // w (C - h)
    Row qy = span.py;
    for (std::size_t i = 0; i < qx.size(); ++i) {
        qx[i] += span.w[i] * (span.origin.x - h.x);
        qy[i] += span.w[i] * (span.origin.y - h.y);
    }
    const auto cut = [&](const Row& f) {
        return without(f, span.first, span.last);
    };
    out.a = cut(plus(times(qx, span.nx, false), times(qy, span.ny, false), 1.0L));
    const Row load = cut(plus(times(qx, span.ny, false), times(qy, span.nx, false), -1.0L));
    out.noise = cut(plus(times(qx, span.sizes, true), times(qy, span.sizes, true), 1.0L));
    for (Real& v : out.a) {
        v = -v;
    }
    out.b = plus(out.a, load, span.forward ? mu : -mu);
    for (Real& v : out.noise) {
        v *= kNoise * (1.0L + mu);
    }
    if (x > 0.0L) {
        for (Row* row : {&out.a, &out.b, &out.noise}) {
            keep_end(*row, x, y);
        }
    }
    return out;
}

bool first_root_of(const Ahead& ahead, Roots& roots) {
    return first_of(ahead.a, ahead.b, ahead.noise, 0.0L, 1.0L, 0, roots);
}

}  // namespace palpate::stress

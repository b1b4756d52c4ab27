#include "tests/stress/exact_forms.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::stress {
namespace {

using engine::RationalBezier;
using engine::Vec2;

/// Rounding of a product of forms, relative to its terms.
constexpr Real kNoise = 0x1p-57L;

/// Roots nearer to each other than 2^-60 of a span are one.
constexpr int kMaxHalvings = 60;

Real choose(std::size_t n, std::size_t k) {
    Real value = 1.0L;
    for (std::size_t i = 1; i <= k; ++i) {
        value = value * static_cast<Real>(n - k + i) / static_cast<Real>(i);
    }
    return value;
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

/// Where min(a, b) + share noise changes its sign.
Real closed_in(const Row& a, const Row& b, const Row& noise, Real share) {
    Real lo = 0.0L;
    Real hi = 1.0L;
    for (int i = 0; i < 70 && hi - lo > 1e-19L * hi; ++i) {
        const Real middle = 0.5L * (lo + hi);
        const Real least = std::min(value(a, middle), value(b, middle));
        (least + share * value(noise, middle) > 0.0L ? lo : hi) = middle;
    }
    return hi;
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

Point place(const Vec2& a) {
    return {a.x, a.y};
}
Real dot(const Point& a, const Point& b) {
    return a.x * b.x + a.y * b.y;
}
Real turn(const Point& a, const Point& b) {
    return a.x * b.y - a.y * b.x;
}
Point unit(const Point& a) {
    const Real length = std::sqrt(dot(a, a));
    return {a.x / length, a.y / length};
}

Real value(Row f, Real x) {
    keep_end(f, x, 1.0L - x);
    return f[0];
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

Ahead ahead_of(
    const RationalBezier<2>& span, const Vec2& h, Real mu, Real x, Real y, bool forward) {
    Ahead out;
    const auto n = static_cast<std::size_t>(span.degree());
    Row qx;  // w (C - h)
    Row qy;
    out.origin = {span.origin().x, span.origin().y};
    for (std::size_t i = 0; i <= n; ++i) {
        const std::size_t k = forward ? i : n - i;
        const Real w = span.weight(k);
        out.w.push_back(w);
        out.px.push_back(w * span.local_point(k).x);
        out.py.push_back(w * span.local_point(k).y);
        qx.push_back(out.px[i] + w * (out.origin.x - h.x));
        qy.push_back(out.py[i] + w * (out.origin.y - h.y));
    }
    const std::size_t first = repeats(span, !forward);
    const std::size_t last = repeats(span, forward);
    const auto hodograph = [&](const Row& p, bool sizes) {
        return plus(times(slope(p, sizes), out.w, sizes), times(p, slope(out.w, sizes), sizes),
                    sizes ? 1.0L : -1.0L);
    };
    const Row nx = hodograph(out.px, false);
    const Row ny = hodograph(out.py, false);
    const Row sizes = plus(hodograph(out.px, true), hodograph(out.py, true), 1.0L);
    const Row drive = plus(times(qx, nx, false), times(qy, ny, false), 1.0L);
    const Row load = plus(times(qx, ny, false), times(qy, nx, false), -1.0L);
    const Row size = plus(times(qx, sizes, true), times(qy, sizes, true), 1.0L);
    out.a = without(drive, first, last);
    for (Real& v : out.a) {
        v = -v;
    }
    out.b = plus(out.a, without(load, first, last), forward ? mu : -mu);
    out.noise = without(size, first, last);
    for (Real& v : out.noise) {
        v *= kNoise * (1.0L + mu);
    }
    out.tx = without(nx, first, last);
    out.ty = without(ny, first, last);
    if (x > 0.0L) {
        for (Row* row : {&out.px, &out.py, &out.w, &out.a, &out.b, &out.noise, &out.tx, &out.ty}) {
            keep_end(*row, x, y);
        }
    }
    out.tangent = unit({out.tx[0], out.ty[0]});
    return out;
}

bool first_root_of(const Ahead& ahead, Roots& roots) {
    return first_of(ahead.a, ahead.b, ahead.noise, 0.0L, 1.0L, 0, roots);
}

}  // namespace palpate::stress

#include "engine/friction/cone_forms.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/math/bernstein.hpp"

namespace palpate::engine {
namespace {

using TwiceBernstein = std::vector<Twice>;

/// Rounding of a coefficient in double, relative to the sum of its terms' magnitudes: of the form,
/// of h, of two products and three sums, each 2^-53.
constexpr double kDoubleNoise = 0x1p-50;

/// The same in twice the digits, relative to all terms that the forms were made of: some 2^5
/// products and 2^7 halvings, each 2^-104.
constexpr double kTwiceNoise = 0x1p-94;

/// A span is tame where its speed is at least this share of its size, and its weights differ by no
/// more than the inverse: then the tangent of its derivatives is right to 1e-12.
constexpr double kTame = 1e-3;

/// A certificate with less than this left, of the span's size, is none: the root is not sharp.
constexpr double kSharp = 1e-4;

template <class Real>
constexpr double kUnit = 0x1p-53;
template <>
inline constexpr double kUnit<Twice> = kTwiceEpsilon;

/// Arrays of a piece in the store.
enum Row : std::size_t { kA, kQ, kBx, kBy, kLow, kSizeA = 8, kSizeB, kReach, kNoise, kNoiseB };

/// Control points that repeat the end of the span.
std::size_t repeats(const RationalBezier<2>& curve, bool at_end) {
    const auto n = static_cast<std::size_t>(curve.degree());
    const Vec2 end = curve.local_point(at_end ? n : 0);
    std::size_t count = 0;
    while (count + 1 < n && curve.local_point(at_end ? n - count - 1 : count + 1) == end) {
        ++count;
    }
    return count;
}

/// f / (u^start (1 - u)^end), whose first and last coefficients are 0.
template <class Real>
std::vector<Real> without_ends(const std::vector<Real>& f, std::size_t start, std::size_t end) {
    const std::size_t n = f.size() - 1;
    const std::size_t left = n - start - end;
    std::vector<Real> rest;
    for (std::size_t i = 0; i <= left; ++i) {
        rest.push_back(Real(binomial(n, i + start)) * f[i + start] / binomial(left, i));
    }
    return rest;
}

Bernstein sizes_of(const TwiceBernstein& f) {
    Bernstein size;
    for (const Twice& c : f) {
        size.push_back(std::fabs(c.hi));
    }
    return size;
}

/// What fall_slack() needs of two neighbours: how far HIP moves while the margin between them falls
/// by one, and rounding of the margin, by itself and per m of HIP.
template <class Part>
void store_fall(const Part& part, double mu, std::vector<double>& store) {
    const std::size_t n = part.a.size();
    const double cone = std::sqrt(1.0 + mu * mu);
    const auto add = [&store, n](const auto& of_pair) {
        for (std::size_t i = 0; i + 1 < n; ++i) {
            store.push_back(of_pair(i, i + 1));
        }
        store.push_back(0.0);
    };
    add([&](std::size_t i, std::size_t k) {
        const Vec2 b{part.bx[k].hi - part.bx[i].hi, part.by[k].hi - part.by[i].hi};
        return 1.0 / (cone * glm::length(b));
    });
    const double share = kDoubleNoise * (1.0 + mu);
    add([&](std::size_t i, std::size_t k) { return share * (part.size_a[i] + part.size_a[k]); });
    add([&](std::size_t i, std::size_t k) { return share * (part.size_b[i] + part.size_b[k]); });
}

}  // namespace

/// Forms over a stretch of a span.
struct ConeForms::Part {
    TwiceBernstein a;
    TwiceBernstein q;
    TwiceBernstein bx;
    TwiceBernstein by;
    Bernstein size_a;
    Bernstein size_b;
    Bernstein weight;

    /// Becomes its first half; the second half is returned.
    Part cut() {
        return {cut_in_half(a),      cut_in_half(q),      cut_in_half(bx),    cut_in_half(by),
                cut_in_half(size_a), cut_in_half(size_b), cut_in_half(weight)};
    }
};

ConeForms::ConeForms(const Outline& outline, const Pieces<2>& pieces, double mu)
    : outline_(&outline), mu_(mu) {
    for (std::size_t i = 0; i < outline.spans().size(); ++i) {
        const RationalBezier<2>& curve = outline.spans()[i];
        const auto [lightest, heaviest] = std::ranges::minmax(curve.weights());
        spans_.push_back({.first = pieces_.size(),
                          .tame = lightest >= kTame * heaviest && repeats(curve, false) == 0 &&
                                  repeats(curve, true) == 0,
                          .size = glm::length(curve.box().size())});
        add(pieces, whole(curve), 0.0, 1.0);
        spans_[i].arc = outline.arc(i);
        if (spans_[i].tame && spans_[i].arc == nullptr && curve.is_its_taylor_series()) {
            spans_[i].cubic = &curve;
        }
    }
    spans_.push_back({.first = pieces_.size()});
}

ConeForms::Part ConeForms::whole(const RationalBezier<2>& curve) {
    Part part;
    TwiceBernstein w;
    std::array<TwiceBernstein, 2> p;
    for (std::size_t i = 0; i <= static_cast<std::size_t>(curve.degree()); ++i) {
        const double weight = curve.weight(i);
        part.weight.push_back(weight);
        w.emplace_back(weight);
        for (int k = 0; k < 2; ++k) {
            p.at(static_cast<std::size_t>(k))
                .push_back(exact_product(weight, curve.local_point(i)[k]));
        }
    }
    const bool polynomial = curve.polynomial();
    const auto hodograph = [&](const TwiceBernstein& f) {
        return polynomial ? derivative(f) : wronskian(f, w);
    };
    const TwiceBernstein nx = hodograph(p[0]);
    const TwiceBernstein ny = hodograph(p[1]);
    const Bernstein size_p = sum(sizes_of(p[0]), sizes_of(p[1]));
    const Bernstein size_n =
        polynomial ? derivative_size(size_p) : wronskian_size(size_p, part.weight);
    const std::size_t start = repeats(curve, false);
    const std::size_t end = repeats(curve, true);
    part.a = without_ends(sum(product(p[0], nx), product(p[1], ny)), start, end);
    part.q = without_ends(difference(product(p[0], ny), product(p[1], nx)), start, end);
    part.bx = without_ends(polynomial ? nx : product(w, nx), start, end);
    part.by = without_ends(polynomial ? ny : product(w, ny), start, end);
    part.size_a = without_ends(product(size_p, size_n), start, end);
    part.size_b = without_ends(polynomial ? size_n : product(part.weight, size_n), start, end);
    if (polynomial) {  // product(p, nx) has the degree 2 p - 1, nx only p - 1
        for (TwiceBernstein* b : {&part.bx, &part.by}) {
            *b = product(*b, TwiceBernstein(part.a.size() - b->size() + 1, Twice(1.0)));
        }
        part.size_b = product(part.size_b, Bernstein(part.a.size() - part.size_b.size() + 1, 1.0));
    }
    return part;
}

void ConeForms::add(const Pieces<2>& pieces, Part part, double lo, double hi) {
    const std::size_t span = spans_.size() - 1;
    if (pieces[pieces_.size()].hi == hi) {
        store(part, span, lo, hi);
        return;
    }
    const double middle = 0.5 * (lo + hi);
    Part right = part.cut();
    add(pieces, std::move(part), lo, middle);
    add(pieces, std::move(right), middle, hi);
}

void ConeForms::store(const Part& part, std::size_t span, double lo, double hi) {
    pieces_.push_back({.first = store_.size(),
                       .span = static_cast<std::uint32_t>(span),
                       .count = static_cast<std::uint32_t>(part.a.size()),
                       .lo = lo,
                       .hi = hi});
    const std::array<const TwiceBernstein*, 4> rows{&part.a, &part.q, &part.bx, &part.by};
    for (double Twice::*const digits : {&Twice::hi, &Twice::lo}) {
        for (const TwiceBernstein* row : rows) {
            for (const Twice& c : *row) {
                store_.push_back(c.*digits);
            }
        }
    }
    store_.insert(store_.end(), part.size_a.begin(), part.size_a.end());
    store_.insert(store_.end(), part.size_b.begin(), part.size_b.end());
    store_fall(part, mu_, store_);
    Vec2 axis{};
    for (std::size_t i = 0; i < part.a.size(); ++i) {
        axis += Vec2{part.bx[i].hi, part.by[i].hi};
    }
    axis *= 1.0 / glm::length(axis);
    const double heavy = largest_magnitude(part.weight);
    const double least = kTame * spans_[span].size * heavy * heavy * heavy;
    for (std::size_t i = 0; i < part.a.size(); ++i) {
        const bool fast = glm::dot(axis, Vec2{part.bx[i].hi, part.by[i].hi}) >= least;
        spans_[span].tame = spans_[span].tame && fast;
    }
}

std::size_t ConeForms::ahead(std::size_t span, double u, double dir) const noexcept {
    std::size_t i = spans_[span].first;
    while (i + 1 < spans_[span + 1].first && (dir > 0.0 ? u >= pieces_[i].hi : u > pieces_[i].hi)) {
        ++i;
    }
    return i;
}

template <class Real>
void ConeForms::net(
    std::size_t piece, const Vec2& h, double mu, double dir, ConeNet<Real>& net) const noexcept {
    const Piece& p = pieces_[piece];
    const Vec2& origin = outline_->spans()[p.span].origin();
    const std::size_t n = p.count;
    const double* c = store_.data() + p.first;
    const auto at = [c, n](Row row, std::size_t i) -> Real {
        if constexpr (std::is_same_v<Real, Twice>) {
            return {c[row * n + i], c[(kLow + row) * n + i]};
        } else {
            return c[row * n + i];
        }
    };
    const auto local = [](double x, double from) -> Real {
        if constexpr (std::is_same_v<Real, Twice>) {
            return exact_sum(x, -from);
        } else {
            return x - from;
        }
    };
    const Real hx = local(h.x, origin.x);
    const Real hy = local(h.y, origin.y);
    const double away = std::fabs(head(hx)) + std::fabs(head(hy));
    net.count = n;
    for (std::size_t i = 0; i < n; ++i) {
        const std::size_t k = dir > 0.0 ? i : n - 1 - i;
        const Real a = at(kA, k);
        const Real q = at(kQ, k);
        const Real bx = at(kBx, k);
        const Real by = at(kBy, k);
        const Real drive = hx * bx + hy * by - a;
        const Real load = hx * by - hy * bx - q;
        net.a[i] = dir > 0.0 ? drive : -drive;
        net.b[i] = net.a[i] - Real(mu) * load;
        const double sizes = c[kSizeA * n + k] + away * c[kSizeB * n + k];
        net.noise[i] = kTwiceNoise * (1.0 + mu) * sizes;
        if constexpr (std::is_same_v<Real, double>) {
            const double products = away * (std::fabs(bx) + std::fabs(by));
            net.noise[i] +=
                kDoubleNoise * (std::fabs(a) + mu * std::fabs(q) + (1.0 + mu) * products);
        }
    }
}

double ConeForms::fall_slack(std::size_t piece, const Vec2& h) const noexcept {
    const Piece& p = pieces_[piece];
    const Vec2 local = h - outline_->spans()[p.span].origin();
    const double away = std::fabs(local.x) + std::fabs(local.y);
    const std::size_t n = p.count;
    const double* a = store_.data() + p.first;
    const double* q = a + kQ * n;
    const double* bx = a + kBx * n;
    const double* by = a + kBy * n;
    const double* reach = a + kReach * n;
    const double* noise = a + kNoise * n;
    const double* noise_b = a + kNoiseB * n;
    double slack = std::numeric_limits<double>::infinity();
    bool falls = true;
    for (std::size_t i = 0; i + 1 < n; ++i) {
        const Vec2 b{bx[i + 1] - bx[i], by[i + 1] - by[i]};
        const double rise = (a[i + 1] - a[i]) - (local.x * b.x + local.y * b.y);
        const double load = local.x * b.y - local.y * b.x - (q[i + 1] - q[i]);
        const double margin = rise - mu_ * std::fabs(load) - (noise[i] + away * noise_b[i]);
        falls = falls && margin > 0.0;
        slack = std::min(slack, margin * reach[i]);
    }
    return falls ? slack - kSharp * spans_[p.span].size : 0.0;
}

Vec2 ConeForms::heading(std::size_t span, double u, double v) const noexcept {
    const Piece& p = pieces_[ahead(span, u, 1.0)];
    const double width = p.hi - p.lo;
    const double x = p.lo == 0.0 ? u / width : (u - p.lo) / width;
    const double y = p.hi == 1.0 ? v / width : (p.hi - u) / width;
    const std::size_t n = p.count;
    std::array<Vec2, kMaxCoefficients> b;
    for (std::size_t i = 0; i < n; ++i) {
        const double* c = store_.data() + p.first + i;
        b[i] = {c[kBx * n], c[kBy * n]};
    }
    for (std::size_t left = n - 1; left > 0; --left) {
        for (std::size_t i = 0; i < left; ++i) {
            b[i] = y * b[i] + x * b[i + 1];
        }
    }
    return b[0];
}

template <class Real>
void cut_start(ConeNet<Real>& net, const Real& x, const Real& y) noexcept {
    const double of_x = 4.0 * kUnit<Real> * head(x);
    const double of_y = 4.0 * kUnit<Real> * head(y);
    for (std::size_t left = net.count - 1; left > 0; --left) {
        for (std::size_t i = 0; i < left; ++i) {
            const double size = std::max(std::fabs(head(net.a[i])), std::fabs(head(net.b[i])));
            const double next =
                std::max(std::fabs(head(net.a[i + 1])), std::fabs(head(net.b[i + 1])));
            net.noise[i] =
                head(y) * net.noise[i] + head(x) * net.noise[i + 1] + (of_y * size + of_x * next);
            net.a[i] = y * net.a[i] + x * net.a[i + 1];
            net.b[i] = y * net.b[i] + x * net.b[i + 1];
        }
    }
}

template <class Real>
void halve(ConeNet<Real>& net, ConeNet<Real>& left) noexcept {
    const std::size_t n = net.count;
    left.count = n;
    for (std::size_t level = 0; level < n; ++level) {
        left.a[level] = net.a[0];
        left.b[level] = net.b[0];
        left.noise[level] = net.noise[0];
        for (std::size_t i = 0; i + 1 < n - level; ++i) {
            net.a[i] = 0.5 * (net.a[i] + net.a[i + 1]);
            net.b[i] = 0.5 * (net.b[i] + net.b[i + 1]);
            const double size = std::max(std::fabs(head(net.a[i])), std::fabs(head(net.b[i])));
            net.noise[i] = 0.5 * (net.noise[i] + net.noise[i + 1]) + 2.0 * kUnit<Real> * size;
        }
    }
}

template void ConeForms::net<double>(
    std::size_t, const Vec2&, double, double, ConeNet<double>&) const noexcept;
template void ConeForms::net<Twice>(
    std::size_t, const Vec2&, double, double, ConeNet<Twice>&) const noexcept;
template void cut_start<double>(ConeNet<double>&, const double&, const double&) noexcept;
template void cut_start<Twice>(ConeNet<Twice>&, const Twice&, const Twice&) noexcept;
template void halve<double>(ConeNet<double>&, ConeNet<double>&) noexcept;
template void halve<Twice>(ConeNet<Twice>&, ConeNet<Twice>&) noexcept;

}  // namespace palpate::engine

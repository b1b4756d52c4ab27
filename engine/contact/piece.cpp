#include "engine/contact/piece.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/math/bernstein.hpp"

namespace palpate::engine {
namespace {

/// A stretch is straight enough when its capsule is this thin against its chord: then half-planes
/// and bounds are nearly as good as they can be, and an 80 mm arc of 20 1/m has 8 pieces.
constexpr double kFlat = 0.03;

/// 64 pieces a span at most: near a cusp a piece never gets flat.
constexpr int kMaxCuts = 6;

/// Coefficients below this share of their terms' size are rounding noise.
constexpr double kNoise = 16.0 * kEpsilon;

/// Rounding of a bound, relative to the lengths in it.
constexpr double kBoundMargin = 16.0 * kEpsilon;

/// One stretch on its way to a Piece: Bernstein coefficients over it.
template <int D>
struct Part {
    double lo = 0.0;
    double hi = 1.0;
    std::vector<Vec<D>> weighted;  ///< w (P - origin)
    Bernstein weight;
    Bernstein a;  ///< f = a - h . b
    std::vector<Vec<D>> b;
    Bernstein size_a;  ///< the same with every term positive: what rounding is relative to
    Bernstein size_b;
};

template <int D>
Bernstein component(const std::vector<Vec<D>>& values, int k) {
    Bernstein one;
    for (const Vec<D>& v : values) {
        one.push_back(v[k]);
    }
    return one;
}

/// a and b of f over the whole span: with W of degree p, W^2 C' = P' W - P W' =: N, and
/// f = (P - h W) . N. For a polynomial W = 1 and N = P'.
template <int D>
Part<D> whole(const RationalBezier<D>& curve) {
    Part<D> s;
    const auto points = static_cast<std::size_t>(curve.degree()) + 1;
    for (std::size_t i = 0; i < points; ++i) {
        s.weight.push_back(curve.weight(i));
        s.weighted.push_back(curve.weight(i) * curve.local_point(i));
    }
    const auto add = [](Bernstein& to, const Bernstein& more) {
        to = to.empty() ? more : sum(std::move(to), more);
    };
    for (int k = 0; k < D; ++k) {
        const Bernstein p = component(s.weighted, k);
        const Bernstein n = curve.polynomial() ? derivative(p) : wronskian(p, s.weight);
        add(s.a, product(p, n));
        const Bernstein size_p = magnitudes(p);
        const Bernstein size_n =
            curve.polynomial() ? derivative_size(size_p) : wronskian_size(size_p, s.weight);
        add(s.size_a, product(size_p, size_n));
        add(s.size_b, product(s.weight, size_n));
        const Bernstein wn = product(s.weight, n);
        s.b.resize(wn.size(), Vec<D>{});
        for (std::size_t i = 0; i < wn.size(); ++i) {
            s.b[i][k] = wn[i];
        }
    }
    return s;
}

/// `s` becomes its first half; the second half is returned.
template <int D>
Part<D> cut(Part<D>& s) {
    Part<D> right;
    right.hi = s.hi;
    right.lo = s.hi = 0.5 * (s.lo + s.hi);
    right.weighted = cut_in_half(s.weighted);
    right.weight = cut_in_half(s.weight);
    right.a = cut_in_half(s.a);
    right.b = cut_in_half(s.b);
    right.size_a = cut_in_half(s.size_a);
    right.size_b = cut_in_half(s.size_b);
    return right;
}

/// Chord, capsule and box of a stretch.
template <int D>
Piece<D> capsule(const Part<D>& s, const Vec<D>& origin) {
    std::vector<Vec<D>> points;
    for (std::size_t i = 0; i < s.weighted.size(); ++i) {
        points.push_back(origin + s.weighted[i] / s.weight[i]);
    }
    Piece<D> piece;
    piece.lo = s.lo;
    piece.hi = s.hi;
    piece.origin = origin;
    piece.start = points.front();
    piece.axis = points.back() - points.front();
    const double length2 = glm::dot(piece.axis, piece.axis);
    piece.inverse_length2 = length2 > 0.0 ? 1.0 / length2 : 0.0;
    piece.box = box_of<D>(points);
    double radius = 0.0;
    for (const Vec<D>& p : points) {
        radius = std::max(radius, piece.bound(p));
    }
    const double size = glm::length(piece.box.size());
    piece.radius = radius + kBoundMargin * (size + glm::length(piece.box.middle()));
    return piece;
}

}  // namespace

template <int D>
double Piece<D>::bound(const Vec<D>& h) const noexcept {
    const Vec<D> gap = h - start;
    const double along = glm::dot(gap, axis) * inverse_length2;
    const double t = along < 0.0 ? 0.0 : along > 1.0 ? 1.0 : along;
    const Vec<D> rest = gap - t * axis;
    return std::sqrt(glm::dot(rest, rest)) - radius;
}

template <int D>
Pieces<D>::Pieces(const std::vector<RationalBezier<D>>& spans) {
    for (std::size_t i = 0; i < spans.size(); ++i) {
        first_.push_back(pieces_.size());
        add_span(spans[i], static_cast<std::uint32_t>(i));
    }
    first_.push_back(pieces_.size());
}

template <int D>
void Pieces<D>::add_span(const RationalBezier<D>& curve, std::uint32_t index) {
    const Part<D> all = whole(curve);
    struct Waiting {
        Part<D> part;
        int cuts;
    };
    std::vector<Waiting> stack{{all, 0}};
    while (!stack.empty()) {
        Waiting at = std::move(stack.back());
        stack.pop_back();
        Piece<D> piece = capsule(at.part, curve.origin());
        if (piece.radius > kFlat * glm::length(piece.axis) && at.cuts < kMaxCuts) {
            Part<D> right = cut(at.part);
            stack.push_back({std::move(right), at.cuts + 1});
            stack.push_back({std::move(at.part), at.cuts + 1});
            continue;
        }
        const Bernstein& a = at.part.a;
        const std::vector<Vec<D>>& b = at.part.b;
        const double noise = kNoise * largest_magnitude(at.part.size_a);
        const double noise_h = kNoise * largest_magnitude(at.part.size_b);
        piece.span = index;
        piece.count = static_cast<std::uint32_t>(a.size());
        piece.noise = noise;
        piece.noise_h = noise_h;
        piece.first = store_.size();
        store_.insert(store_.end(), a.begin(), a.end());
        for (int k = 0; k < D; ++k) {
            const Bernstein one = component(b, k);
            store_.insert(store_.end(), one.begin(), one.end());
        }
        for (const Bernstein* size : {&at.part.size_a, &at.part.size_b}) {
            for (const double c : *size) {
                store_.push_back(kNoise * c);
            }
        }
        std::vector<Vec<D>> normals;
        for (std::size_t i = 0; i + 1 < a.size(); ++i) {
            const Vec<D> n = b[i + 1] - b[i];
            const double length = glm::length(n);
            const double rise = a[i + 1] - a[i] - noise;
            const bool turns = length > noise_h;
            const double never = std::numeric_limits<double>::infinity();
            store_.push_back(turns ? rise / length : rise > 0.0 ? never : -never);
            normals.push_back(turns ? n / length : Vec<D>{});
        }
        for (int k = 0; k < D; ++k) {
            const Bernstein one = component(normals, k);
            store_.insert(store_.end(), one.begin(), one.end());
        }
        pieces_.push_back(piece);
    }
}

template <int D>
std::size_t Pieces<D>::holding(std::size_t span, double u, const PieceRange& other) const noexcept {
    std::size_t i = first_[span];
    while (i + 1 < first_[span + 1] &&
           (u > pieces_[i].hi || (u == pieces_[i].hi && other.holds(i, pieces_.size())))) {
        ++i;
    }
    return i;
}

template <int D>
void Pieces<D>::coefficients(const Piece<D>& piece, const Vec<D>& h, double* f) const noexcept {
    const Vec<D> local = h - piece.origin;
    const double* a = store_.data() + piece.first;
    const std::size_t n = piece.count;
    for (std::size_t i = 0; i < n; ++i) {
        double value = a[i];
        for (int k = 0; k < D; ++k) {
            value -= local[k] * a[n * (static_cast<std::size_t>(k) + 1) + i];
        }
        f[i] = value;
    }
}

template <int D>
void Pieces<D>::noise_levels(const Piece<D>& piece, const Vec<D>& h, double* noise) const noexcept {
    const std::size_t n = piece.count;
    const double* of_a = store_.data() + piece.first + static_cast<std::size_t>(D + 1) * n;
    const double away = glm::length(h - piece.origin);
    for (std::size_t i = 0; i < n; ++i) {
        noise[i] = of_a[i] + away * of_a[n + i];
    }
}

template <int D>
double Pieces<D>::rise_slack(const Piece<D>& piece, const Vec<D>& h) const noexcept {
    const Vec<D> local = h - piece.origin;
    const std::size_t n = piece.count - 1;
    const double* offset =
        store_.data() + piece.first + static_cast<std::size_t>(D + 3) * piece.count;
    double slack = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < n; ++i) {
        double value = offset[i];
        for (int k = 0; k < D; ++k) {
            value -= local[k] * offset[n * (static_cast<std::size_t>(k) + 1) + i];
        }
        slack = std::min(slack, value);
    }
    return slack;
}

template struct Piece<2>;
template struct Piece<3>;
template class Pieces<2>;
template class Pieces<3>;

}  // namespace palpate::engine

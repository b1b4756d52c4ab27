#include "engine/contact/piece_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace palpate::engine {
namespace {

/// Pieces in a leaf of the tree.
constexpr std::uint32_t kLeaf = 4;

/// Depth of the tree: 2^48 pieces.
constexpr std::size_t kMaxDepth = 48;

/// Splitting stops here: 2^-45 of u is 2e-15 m on an 80 mm curve, below every rounding error.
constexpr int kMaxSplits = 45;

/// Newton's steps in a bracket; bisection alone would need 53, or more beside a root at 0.
constexpr int kMaxSteps = 128;

/// Golden sections of a flat stretch: down to 1e-8 of it, where a parabola has no digits left.
constexpr int kFlatSteps = 40;

/// Newton's iteration starts this share of a bracket or more away from its ends.
constexpr double kFromEnds = 0x1p-6;

/// What Descartes' rule says of a list of coefficients.
struct Signs {
    int changes = 0;
    double first = 0.0;    ///< first that is not zero
    double largest = 0.0;  ///< magnitude
};

Signs signs_of(const double* f, std::size_t count) noexcept {
    Signs s;
    double last = 0.0;
    for (std::size_t k = 0; k < count; ++k) {
        const double c = f[k];
        s.largest = std::max(s.largest, std::fabs(c));
        if (c == 0.0) {
            continue;
        }
        s.first = s.first == 0.0 ? c : s.first;
        s.changes += (last != 0.0 && (last < 0.0) != (c < 0.0)) ? 1 : 0;
        last = c;
    }
    return s;
}

/// A stretch of a piece on the stack of splits: coefficients and their rounding levels. Both are
/// halved alike, because beside a control point of little weight f may be 1e-15 of what it is
/// elsewhere.
struct RootPart {
    std::array<double, kMaxCoefficients> f;
    std::array<double, kMaxCoefficients> noise;
    double lo;
    double width;
    int splits;
};

bool is_noise(const RootPart& part, std::size_t count) noexcept {
    for (std::size_t k = 0; k < count; ++k) {
        if (std::fabs(part.f[k]) > part.noise[k]) {
            return false;
        }
    }
    return true;
}

/// De Casteljau at the middle: `left` gets the left half, `f` becomes the right half.
void halve(double* f, double* left, std::size_t count) noexcept {
    for (std::size_t level = 0; level < count; ++level) {
        left[level] = f[0];
        for (std::size_t k = 0; k + 1 < count - level; ++k) {
            f[k] = 0.5 * (f[k] + f[k + 1]);
        }
    }
}

}  // namespace

template <int D>
PieceTree<D>::PieceTree(std::vector<RationalBezier<D>> spans)
    : spans_(std::move(spans)), pieces_(spans_) {
    build(0, static_cast<std::uint32_t>(pieces_.size()));
}

template <int D>
std::uint32_t PieceTree<D>::build(std::uint32_t begin, std::uint32_t end) {
    const auto index = static_cast<std::uint32_t>(nodes_.size());
    nodes_.push_back({pieces_[begin].box, begin, end, 0});
    for (std::uint32_t i = begin + 1; i < end; ++i) {
        nodes_[index].box.add(pieces_[i].box);
    }
    if (end - begin > kLeaf) {
        const std::uint32_t middle = begin + (end - begin) / 2;
        build(begin, middle);
        nodes_[index].right = build(middle, end);
    }
    return index;
}

/// Calls visit(piece index) for every piece whose box is nearer than `best2` (which visit may
/// lower), nearer boxes first.
template <int D>
template <class Visit>
void PieceTree<D>::descend(const Vec<D>& h, const double& best2, Visit&& visit) const noexcept {
    struct Waiting {
        std::uint32_t node;
        double distance2;
    };
    std::array<Waiting, kMaxDepth> stack;
    std::size_t top = 0;
    stack[top++] = {0, nodes_[0].box.distance2(h)};
    while (top > 0) {
        const Waiting at = stack[--top];
        if (at.distance2 >= best2) {
            continue;
        }
        const Node& node = nodes_[at.node];
        if (node.right == 0) {
            for (std::uint32_t i = node.begin; i < node.end; ++i) {
                visit(i);
            }
            continue;
        }
        Waiting near{at.node + 1, nodes_[at.node + 1].box.distance2(h)};
        Waiting far{node.right, nodes_[node.right].box.distance2(h)};
        if (far.distance2 < near.distance2) {
            std::swap(near, far);
        }
        stack[top++] = far;
        stack[top++] = near;
    }
}

template <int D>
Foot<D> PieceTree<D>::closest(const Vec<D>& h, const PieceRange& left_out) const noexcept {
    Foot<D> best;
    descend(h, best.distance2, [&](std::uint32_t i) {
        if (left_out.holds(i, pieces_.size())) {
            return;
        }
        const Piece<D>& piece = pieces_[i];
        const double bound = piece.bound(h);
        if (bound <= 0.0 || bound * bound < best.distance2) {
            offer_piece(h, piece, best);
        }
    });
    return best;
}

template <int D>
double PieceTree<D>::bound_without(const Vec<D>& h,
                                   const PieceRange& left_out,
                                   const PieceRange& and_this) const noexcept {
    double best = std::numeric_limits<double>::infinity();
    double best2 = best;
    const std::size_t n = pieces_.size();
    descend(h, best2, [&](std::uint32_t i) {
        if (left_out.holds(i, n) || and_this.holds(i, n)) {
            return;
        }
        best = std::min(best, std::max(pieces_[i].bound(h), 0.0));
        best2 = best * best;
    });
    return best;
}

template <int D>
void PieceTree<D>::offer(const Vec<D>& h,
                         std::size_t span,
                         double u,
                         Foot<D>& best) const noexcept {
    const RationalBezier<D>& curve = spans_[span];
    const Vec<D> point = curve.local_at(u, 1.0 - u).point;
    const Vec<D> gap = point - (h - curve.origin());
    const double distance2 = glm::dot(gap, gap);
    if (distance2 < best.distance2) {
        best = {span, u, curve.origin() + point, distance2};
    }
}

/// Newton's iteration on the distance' derivative, g = (C - h) . C', between g(lo) < 0 < g(hi). In
/// the second half of a span it runs in v = 1 - u, which has all its digits next to the end.
template <int D>
void PieceTree<D>::offer_root(const Vec<D>& h,
                              std::size_t span,
                              double lo,
                              double hi,
                              double guess,
                              Foot<D>& best) const noexcept {
    const RationalBezier<D>& curve = spans_[span];
    const bool from_end = lo >= 0.5;
    if (from_end) {
        guess = 1.0 - guess;
        const double low = 1.0 - hi;
        hi = 1.0 - lo;
        lo = low;
    }
    const Vec<D> local = h - curve.origin();
    const auto jet_at = [&curve, from_end](double s) {
        if (!from_end) {
            return curve.local_at(s, 1.0 - s);
        }
        Jet<D> jet = curve.local_at(1.0 - s, s);
        jet.first = -jet.first;
        return jet;
    };
    // Not from an end: where the curve stands still there, the sign of g is rounding.
    const double margin = (hi - lo) * kFromEnds;
    double s = guess > lo + margin && guess < hi - margin ? guess : 0.5 * (lo + hi);
    Jet<D> jet = jet_at(s);
    for (int i = 0; i < kMaxSteps; ++i) {
        const Vec<D> gap = jet.point - local;
        const double g = glm::dot(gap, jet.first);
        const double slope = glm::dot(jet.first, jet.first) + glm::dot(gap, jet.second);
        (g < 0.0 ? lo : hi) = s;
        double next = slope > 0.0 ? s - g / slope : 0.5 * (lo + hi);
        if (!(next > lo && next < hi)) {
            if (g == 0.0 || std::fabs(next - s) <= kEpsilon * s) {
                break;
            }
            next = 0.5 * (lo + hi);
        }
        const double step = std::fabs(next - s);
        s = next;
        jet = jet_at(s);
        if (step <= 0.5 * kEpsilon * s) {
            break;
        }
    }
    const Vec<D> gap = jet.point - local;
    const double distance2 = glm::dot(gap, gap);
    if (distance2 < best.distance2) {
        best = {span, from_end ? 1.0 - s : s, curve.origin() + jet.point, distance2};
    }
}

/// The best of a piece: its ends and every foot that Descartes' rule isolates.
template <int D>
void PieceTree<D>::offer_piece(const Vec<D>& h,
                               const Piece<D>& piece,
                               Foot<D>& best) const noexcept {
    std::array<double, kMaxCoefficients> f;
    pieces_.coefficients(piece, h, f.data());
    const std::size_t n = piece.count;
    const double noise = piece.noise + piece.noise_h * glm::length(h - piece.origin);
    // f > 0 at an end: the distance grows away from it, so that the end may be nearest.
    if (!(f[0] < -noise)) {
        offer(h, piece.span, piece.lo, best);
    }
    if (!(f[n - 1] > noise)) {
        offer(h, piece.span, piece.hi, best);
    }
    const Signs signs = signs_of(f.data(), n);
    if (signs.changes == 0 && signs.largest > noise) {
        return;
    }
    if (signs.changes == 1 && std::fabs(f[0]) > noise && std::fabs(f[n - 1]) > noise) {
        if (signs.first < 0.0) {  // from - to +: the one root is a minimum
            const double share = f[0] / (f[0] - f[n - 1]);
            offer_root(h, piece.span, piece.lo, piece.hi, piece.lo + share * (piece.hi - piece.lo),
                       best);
        }
        return;
    }
    offer_splits(h, piece, f.data(), best);
}

/// Where f is rounding, the distance itself still has digits: golden section on it (Kiefer 1953).
/// All that can be lost here is what f cannot tell, an error of the distance squared near its last
/// bit.
template <int D>
void PieceTree<D>::offer_flat(
    const Vec<D>& h, std::size_t span, double lo, double hi, Foot<D>& best) const noexcept {
    constexpr double kGolden = 0.6180339887498949;
    const Vec<D> local = h - spans_[span].origin();
    const auto distance2 = [&](double u) {
        const Vec<D> gap = spans_[span].local_at(u, 1.0 - u).point - local;
        return glm::dot(gap, gap);
    };
    offer(h, span, lo, best);
    offer(h, span, hi, best);
    double a = hi - kGolden * (hi - lo);
    double b = lo + kGolden * (hi - lo);
    double at_a = distance2(a);
    double at_b = distance2(b);
    for (int i = 0; i < kFlatSteps; ++i) {
        const bool left = at_a <= at_b;
        (left ? hi : lo) = left ? b : a;
        (left ? b : a) = left ? a : b;
        (left ? at_b : at_a) = left ? at_a : at_b;
        double& fresh = left ? a : b;
        fresh = left ? hi - kGolden * (hi - lo) : lo + kGolden * (hi - lo);
        (left ? at_a : at_b) = distance2(fresh);
    }
    offer(h, span, at_a <= at_b ? a : b, best);
}

/// The same for a piece with more than one root, or with roots close to its ends.
template <int D>
void PieceTree<D>::offer_splits(const Vec<D>& h,
                                const Piece<D>& piece,
                                const double* f,
                                Foot<D>& best) const noexcept {
    std::array<RootPart, kMaxSplits + 2> stack;  // each split leaves one sibling behind
    const std::size_t n = piece.count;
    std::copy_n(f, n, stack[0].f.begin());
    pieces_.noise_levels(piece, h, stack[0].noise.data());
    stack[0].lo = piece.lo;
    stack[0].width = piece.hi - piece.lo;
    stack[0].splits = 0;
    std::size_t top = 1;
    while (top > 0) {
        RootPart& part = stack[top - 1];
        const Signs signs = signs_of(part.f.data(), n);
        if (is_noise(part, n) || part.splits >= kMaxSplits) {
            offer_flat(h, piece.span, part.lo, part.lo + part.width, best);
            --top;
            continue;
        }
        if (signs.changes <= 1) {
            if (signs.changes == 1 && signs.first < 0.0) {
                offer_root(h, piece.span, part.lo, part.lo + part.width, part.lo + 0.5 * part.width,
                           best);
            }
            --top;
            continue;
        }
        RootPart& left = stack[top];
        left.lo = part.lo;
        left.width = part.width = 0.5 * part.width;
        left.splits = part.splits = part.splits + 1;
        halve(part.f.data(), left.f.data(), n);
        halve(part.noise.data(), left.noise.data(), n);
        part.lo += part.width;
        ++top;
        if (left.f[n - 1] == 0.0) {
            offer(h, piece.span, part.lo,
                  best);  // a root exactly on the cut belongs to neither half
        }
    }
}

template class PieceTree<2>;
template class PieceTree<3>;

}  // namespace palpate::engine

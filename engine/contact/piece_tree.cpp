#include "engine/contact/piece_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace palpate::engine {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// Pieces in a leaf of the tree.
constexpr std::uint32_t kLeaf = 4;

/// Depth of the tree: 2^48 pieces.
constexpr std::size_t kMaxDepth = 48;

/// Splitting stops here: 2^-45 of u is 2e-15 m on an 80 mm curve, below every rounding error.
constexpr int kMaxSplits = 45;

/// Newton's steps in a bracket; bisection alone would need 53.
constexpr int kMaxSteps = 64;

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

/// A stretch of a piece on the stack of splits.
struct Part {
    std::array<double, kMaxCoefficients> f;
    double lo;
    double width;
    int splits;
};

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

/// Calls visit(piece index) for every piece whose box is nearer than `best2` (which visit may lower),
/// nearer boxes first.
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
Foot<D> PieceTree<D>::closest(const Vec<D>& h, const Foot<D>& known) const noexcept {
    Foot<D> best = known;
    descend(h, best.distance2, [&](std::uint32_t i) {
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
                                   std::size_t first,
                                   std::size_t count) const noexcept {
    double best = std::numeric_limits<double>::infinity();
    double best2 = best;
    const std::size_t n = pieces_.size();
    descend(h, best2, [&](std::uint32_t i) {
        const std::size_t place = i >= first ? i - first : i + n - first;
        if (place < count) {
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
    const Vec<D> point = spans_[span].at(u).point;
    const Vec<D> gap = point - h;
    const double distance2 = glm::dot(gap, gap);
    if (distance2 < best.distance2) {
        best = {span, u, point, distance2};
    }
}

/// Newton's iteration on g(u) = (C - h) . C', kept inside the bracket g(lo) < 0 < g(hi).
template <int D>
void PieceTree<D>::offer_root(const Vec<D>& h,
                              std::size_t span,
                              double lo,
                              double hi,
                              double guess,
                              Foot<D>& best) const noexcept {
    const RationalBezier<D>& curve = spans_[span];
    double u = guess > lo && guess < hi ? guess : 0.5 * (lo + hi);
    Jet<D> jet = curve.at(u);
    for (int i = 0; i < kMaxSteps; ++i) {
        const Vec<D> gap = jet.point - h;
        const double g = glm::dot(gap, jet.first);
        const double slope = glm::dot(jet.first, jet.first) + glm::dot(gap, jet.second);
        (g < 0.0 ? lo : hi) = u;
        double next = slope > 0.0 ? u - g / slope : 0.5 * (lo + hi);
        if (!(next > lo && next < hi)) {
            if (g == 0.0 || std::fabs(next - u) <= kEpsilon * std::fabs(u)) {
                break;
            }
            next = 0.5 * (lo + hi);
        }
        const double step = std::fabs(next - u);
        u = next;
        jet = curve.at(u);
        if (step <= 0.5 * kEpsilon * std::fabs(u)) {
            break;
        }
    }
    const Vec<D> gap = jet.point - h;
    const double distance2 = glm::dot(gap, gap);
    if (distance2 < best.distance2) {
        best = {span, u, jet.point, distance2};
    }
}

/// The best of a piece: its ends and every foot that Descartes' rule isolates.
template <int D>
void PieceTree<D>::offer_piece(const Vec<D>& h,
                               const Piece<D>& piece,
                               Foot<D>& best) const noexcept {
    std::array<Part, kMaxSplits + 2> stack;  // each split leaves one sibling behind
    std::size_t top = 1;
    stack[0].lo = piece.lo;
    stack[0].width = piece.hi - piece.lo;
    stack[0].splits = 0;
    pieces_.coefficients(piece, h, stack[0].f.data());
    const std::size_t n = piece.count;
    const double noise = piece.noise + piece.noise_h * glm::length(h - piece.origin);
    // f > 0 at an end: the distance grows away from it, so that the end may be nearest.
    if (!(stack[0].f[0] < -noise)) {
        offer(h, piece.span, piece.lo, best);
    }
    if (!(stack[0].f[n - 1] > noise)) {
        offer(h, piece.span, piece.hi, best);
    }
    while (top > 0) {
        Part& part = stack[top - 1];
        const Signs signs = signs_of(part.f.data(), n);
        if (signs.changes == 0 && signs.largest > noise) {
            --top;
            continue;
        }
        if (signs.largest <= noise || part.splits >= kMaxSplits) {
            // Flat within rounding: any place will do.
            offer(h, piece.span, part.lo + 0.5 * part.width, best);
            --top;
            continue;
        }
        if (signs.changes == 1) {
            if (signs.first < 0.0) {  // from - to +: the one root is a minimum
                const double share = part.f[0] / (part.f[0] - part.f[n - 1]);
                offer_root(h, piece.span, part.lo, part.lo + part.width,
                           part.lo + share * part.width, best);
            }
            --top;
            continue;
        }
        // De Casteljau at the middle: left half on top of the stack, right half stays below it.
        Part& left = stack[top];
        left.lo = part.lo;
        left.width = part.width = 0.5 * part.width;
        left.splits = part.splits = part.splits + 1;
        for (std::size_t level = 0; level < n; ++level) {
            left.f[level] = part.f[0];
            for (std::size_t k = 0; k + 1 < n - level; ++k) {
                part.f[k] = 0.5 * (part.f[k] + part.f[k + 1]);
            }
        }
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

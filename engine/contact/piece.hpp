#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/geometry/rational_bezier.hpp"

namespace palpate::engine {

/// A short stretch of a span, with what a proof about its closest point needs.
///
/// * A capsule around the chord holds the whole stretch: its control points lie in it, and with
///   positive weights the curve lies in their hull.
/// * The foot points of h are the roots of f(u) = (C - h) . C' W^k (k = 0 for polynomials, 3 else),
///   a polynomial whose Bernstein coefficients are linear in h: f_k = a_k - h . b_k. Descartes'
///   rule on them tells where there is no root, exactly one, or a need to split.
/// * f rises over the whole stretch while every f_k+1 > f_k. Each of these is a half-plane of HIPs,
///   kept as an offset and a unit normal, so that the distance to leave it is one scalar product.
template <int D>
struct Piece {
    std::uint32_t span = 0;
    std::uint32_t count = 0;  ///< number of coefficients
    double lo = 0.0;          ///< of the span's parameter
    double hi = 1.0;
    Vec<D> start{};  ///< C(lo)
    Vec<D> axis{};   ///< C(hi) - C(lo)
    double inverse_length2 = 0.0;
    double radius = 0.0;  ///< of the capsule, m
    double noise = 0.0;   ///< rounding level of f: noise + noise_h |h - origin|
    double noise_h = 0.0;
    std::size_t first = 0;  ///< of its numbers in the store
    Vec<D> origin{};        ///< local origin of a_k and b_k
    Box<D> box{};           ///< of its control points

    /// Lower bound of |C(u) - h| over the stretch, m.
    [[nodiscard]] double bound(const Vec<D>& h) const noexcept;
};

/// `count` pieces from `first` on, wrapping around at the end of all.
struct PieceRange {
    std::size_t first = 0;
    std::size_t count = 0;

    /// Whether a piece is one of them. @param total  of all pieces, round which they wrap
    [[nodiscard]] bool holds(std::size_t piece, std::size_t total) const noexcept {
        return (piece >= first ? piece - first : piece + total - first) < count;
    }
};

/// Stretches of all spans in order, and their numbers.
template <int D>
class Pieces {
public:
    /// Cuts every span until it is nearly straight (kFlat), or kMaxCuts times.
    explicit Pieces(const std::vector<RationalBezier<D>>& spans);

    /// All pieces of all spans.
    [[nodiscard]] std::size_t size() const noexcept { return pieces_.size(); }
    [[nodiscard]] const Piece<D>& operator[](std::size_t i) const noexcept { return pieces_[i]; }
    /// Index of the piece of `span` that holds u; where two pieces meet, the one not in `other`.
    [[nodiscard]] std::size_t holding(std::size_t span,
                                      double u,
                                      const PieceRange& other) const noexcept;

    /// Bernstein coefficients of f over the piece for HIP h.
    void coefficients(const Piece<D>& piece, const Vec<D>& h, double* f) const noexcept;

    /// Rounding level of each of them.
    void noise_levels(const Piece<D>& piece, const Vec<D>& h, double* noise) const noexcept;

    /// How far h may move, m, before f might stop rising over the piece; <= 0: it may not rise at
    /// all.
    [[nodiscard]] double rise_slack(const Piece<D>& piece, const Vec<D>& h) const noexcept;

private:
    void add_span(const RationalBezier<D>& curve, std::uint32_t index);

    std::vector<Piece<D>> pieces_;
    std::vector<std::size_t> first_;  ///< piece of each span; and size()
    /// Of each piece: a (count), b (D x count), rounding of a, of b (count each), offsets (count -
    /// 1), normals (D x (count - 1)).
    std::vector<double> store_;
};

extern template struct Piece<2>;
extern template struct Piece<3>;
extern template class Pieces<2>;
extern template class Pieces<3>;

/// Most coefficients of f: degree 3 * 9 - 1.
inline constexpr std::size_t kMaxCoefficients = 3 * kMaxDegree;

}  // namespace palpate::engine

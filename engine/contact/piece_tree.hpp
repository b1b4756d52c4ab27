#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "engine/contact/piece.hpp"

namespace palpate::engine {

/// Where on a set of spans a point lies.
template <int D>
struct Foot {
    std::size_t span = 0;
    double u = 0.0;  ///< in [0, 1]
    Vec<D> point{};
    double distance2 = std::numeric_limits<double>::infinity();  ///< m^2
};

/// Curves prepared once for questions about the closest point, with a proof instead of samples.
///
/// The pieces of all spans lie in a tree of boxes. A question goes down the nearest boxes first and
/// leaves out what is provably further than the best foot known: a box, a capsule, or a piece whose
/// Bernstein coefficients show no foot (Descartes' rule). What is left is solved by Newton's
/// iteration inside a bracket with exactly one root. Nothing is missed between samples: there are
/// none.
///
/// Error of the distance: about one unit in the last place of the curve's size. Any curve will do:
/// kinks, cusps, loops, any degree and weights.
template <int D>
class PieceTree {
public:
    /// Keeps the spans; takes n log n for n pieces. Not for the tick.
    explicit PieceTree(std::vector<RationalBezier<D>> spans);

    /// As they were given; a place names them by their index. And the pieces that they were cut
    /// into.
    [[nodiscard]] const std::vector<RationalBezier<D>>& spans() const noexcept { return spans_; }
    [[nodiscard]] const Pieces<D>& pieces() const noexcept { return pieces_; }

    /// Global closest point over all spans, end points included, or of everything but `left_out`.
    /// Ties go to either. Distance infinite when nothing is there.
    [[nodiscard]] Foot<D> closest(const Vec<D>& h, const PieceRange& left_out = {}) const noexcept;

    /// Lower bound, m, of the distance from h to everything but two ranges of pieces. Infinite when
    /// nothing else is there.
    [[nodiscard]] double bound_without(const Vec<D>& h,
                                       const PieceRange& left_out,
                                       const PieceRange& and_this = {}) const noexcept;

private:
    struct Node {
        Box<D> box{};
        std::uint32_t begin = 0;  ///< pieces [begin, end)
        std::uint32_t end = 0;
        std::uint32_t right = 0;  ///< second child; the first is the next node; 0: a leaf
    };

    std::uint32_t build(std::uint32_t begin, std::uint32_t end);
    template <class Visit>
    void descend(const Vec<D>& h, const double& best2, Visit&& visit) const noexcept;
    void offer_piece(const Vec<D>& h, const Piece<D>& piece, Foot<D>& best) const noexcept;
    void offer_splits(const Vec<D>& h,
                      const Piece<D>& piece,
                      const double* f,
                      Foot<D>& best) const noexcept;
    void offer_flat(
        const Vec<D>& h, std::size_t span, double lo, double hi, Foot<D>& best) const noexcept;
    void offer(const Vec<D>& h, std::size_t span, double u, Foot<D>& best) const noexcept;
    void offer_root(const Vec<D>& h,
                    std::size_t span,
                    double lo,
                    double hi,
                    double guess,
                    Foot<D>& best) const noexcept;

    std::vector<RationalBezier<D>> spans_;
    Pieces<D> pieces_;
    std::vector<Node> nodes_;
};

extern template class PieceTree<2>;
extern template class PieceTree<3>;

}  // namespace palpate::engine

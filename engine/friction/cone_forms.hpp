#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "engine/contact/piece.hpp"
#include "engine/geometry/outline.hpp"
#include "engine/math/twice.hpp"

namespace palpate::engine {

/// Two polynomials on [0, 1] in the direction of a walk, by their Bernstein coefficients: outside
/// of the cone is where both are > 0. Real: double, or Twice where doubles cannot tell.
template <class Real>
struct ConeNet {
    std::size_t count;
    std::array<Real, kMaxCoefficients> a;        ///< dir tau, up to a factor > 0
    std::array<Real, kMaxCoefficients> b;        ///< dir tau - mu nu, up to the same factor
    std::array<double, kMaxCoefficients> noise;  ///< no coefficient is further from the truth
};

/// What the cone condition is along an outline, compiled once.
///
/// With r = h - C = h - P / W and N = P' W - P W', the drive r . C' and the load's form r x C' are
///
///     (h W - P) . N   and   (h W - P) x N        times 1 / W^3 > 0,
///
/// polynomials whose Bernstein coefficients are linear in h. The god-object lies outside of its
/// cone in direction dir where A = dir r . C' > 0 and B = A - mu r x C' > 0. Where control points
/// repeat at an end, C' vanishes there as u^m, and both forms are divided by it: no end stands
/// still. Coefficients are kept to 32 digits, with a bound of their rounding.
class ConeForms {
public:
    /// @param outline  must live as long as this
    /// @param pieces   of its spans
    /// @param mu       the largest coefficient that will be asked for
    ConeForms(const Outline& outline, const Pieces<2>& pieces, double mu);

    struct Piece {
        std::size_t first = 0;  ///< of its numbers in the store
        std::uint32_t span = 0;
        std::uint32_t count = 0;  ///< of coefficients
        double lo = 0.0;          ///< of the span's parameter
        double hi = 1.0;
    };

    /// Whose spans these forms are.
    [[nodiscard]] const Outline& outline() const noexcept { return *outline_; }
    [[nodiscard]] const Piece& operator[](std::size_t i) const noexcept { return pieces_[i]; }
    /// Index of the piece of `span` ahead of u in direction `dir`.
    [[nodiscard]] std::size_t ahead(std::size_t span, double u, double dir) const noexcept;
    /// The span's own derivatives tell direction and drive to the last digits: it stands nowhere
    /// nearly still, and no weight is heavy.
    [[nodiscard]] bool tame(std::size_t span) const noexcept { return spans_[span].tame; }
    /// The span, if it is tame, no arc, and its own Taylor series; else null.
    [[nodiscard]] const RationalBezier<2>* cubic(std::size_t span) const noexcept {
        return spans_[span].cubic;
    }
    /// The span, if it is an arc; else null.
    [[nodiscard]] const Arc* arc(std::size_t span) const noexcept { return spans_[span].arc; }
    /// Size of the span's control points, m.
    [[nodiscard]] double size(std::size_t span) const noexcept { return spans_[span].size; }

    /// Both forms over a piece for HIP h, in the direction of a walk.
    template <class Real>
    void net(
        std::size_t piece, const Vec2& h, double mu, double dir, ConeNet<Real>& net) const noexcept;

    /// How far h may move, m, while A and B fall strictly over the whole piece, in either direction
    /// and for every coefficient up to the largest; <= 0: they may not.
    [[nodiscard]] double fall_slack(std::size_t piece, const Vec2& h) const noexcept;

    /// A vector along C' at u = 1 - v, also where C' = 0: m^2, or m^2 times weights.
    [[nodiscard]] Vec2 heading(std::size_t span, double u, double v) const noexcept;

private:
    struct Span {
        std::size_t first = 0;  ///< piece
        bool tame = true;
        double size = 0.0;
        const RationalBezier<2>* cubic = nullptr;
        const Arc* arc = nullptr;
    };
    struct Part;

    void add(const Pieces<2>& pieces, Part part, double lo, double hi);
    void store(const Part& part, std::size_t span, double lo, double hi);
    [[nodiscard]] static Part whole(const RationalBezier<2>& curve);

    const Outline* outline_;
    double mu_;
    std::vector<Span> spans_;
    std::vector<Piece> pieces_;
    /// Of each piece, `count` of each: a, q, b.x, b.y to 16 digits, what is missing of each to 32,
    /// sizes of a and of b.
    std::vector<double> store_;
};

/// Cuts [0, x] off a net, x = 1 - y.
template <class Real>
void cut_start(ConeNet<Real>& net, const Real& x, const Real& y) noexcept;

/// `net` becomes its second half, `left` the first.
template <class Real>
void halve(ConeNet<Real>& net, ConeNet<Real>& left) noexcept;

}  // namespace palpate::engine

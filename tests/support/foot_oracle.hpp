#pragma once

#include <queue>

#include "tests/support/nurbs_oracle.hpp"

/// The closest point of a NURBS curve, in long double and proved from both sides; shares no code
/// with the engine.
namespace palpate::tests {

struct OracleFoot {
    long double distance = 0.0L;         ///< of a point of the curve, m
    long double u = 0.0L;                ///< its parameter, in the curve's knots
    std::array<long double, 2> point{};  ///< m
    long double proved = 0.0L;           ///< no point of the curve is closer than this, m

    [[nodiscard]] engine::Vec2 foot() const {
        return {static_cast<double>(point[0]), static_cast<double>(point[1])};
    }
};

/// Branch and bound over Bezier pieces.
///
/// A curve is split into Bezier spans once (blossoms, Cox-de Boor). For a query h each piece of a
/// span is the homogeneous polygon g_i = w_i (P_i - h), w_i, cut by de Casteljau. |C - h|^2 = |g|^2
/// / w^2, and with Bernstein coefficients n_k of |g|^2 and v_k > 0 of w^2 it is at least min n_k /
/// v_k on the whole piece. Every cut is a point of the curve, from above; Newton's iteration, which
/// may go anywhere, sharpens it. What the bound leaves open is halved, best first, until
///
///     distance - proved <= 1e-17 max(size, distance)
///
/// so cusps, kinks, loops, ties and weights of any ratio need no special case: nothing is sampled.
class FootOracle {
public:
    explicit FootOracle(const NurbsData<2>& curve) {
        engine::Vec2 low = curve.points[0];
        engine::Vec2 high = low;
        for (const engine::Vec2& p : curve.points) {
            low = glm::min(low, p);
            high = glm::max(high, p);
        }
        origin_ = {0.5L * (static_cast<long double>(low.x) + high.x),
                   0.5L * (static_cast<long double>(low.y) + high.y)};
        size_ = std::hypot(static_cast<long double>(high.x) - low.x,
                           static_cast<long double>(high.y) - low.y);
        degree_ = static_cast<std::size_t>(curve.degree);
        for (std::size_t i = 0; i <= 2 * degree_; ++i) {
            const std::size_t first = i > degree_ ? i - degree_ : 0;
            for (std::size_t k = first; k <= std::min(i, degree_); ++k) {
                share_[i][k] =
                    binomial(degree_, k) * binomial(degree_, i - k) / binomial(2 * degree_, i);
            }
        }
        for (std::size_t k = degree_; k < curve.points.size(); ++k) {
            if (curve.knots[k] < curve.knots[k + 1]) {
                spans_.push_back(bezier(curve, k));
            }
        }
    }

    /// Diagonal of the box of the control points, m.
    [[nodiscard]] long double size() const { return size_; }

    /// C, C' and C'' at u, m and per unit of u.
    [[nodiscard]] std::array<std::array<long double, 2>, 3> at(long double u) const {
        std::size_t s = 0;
        while (s + 1 < spans_.size() && u >= spans_[s].hi) {
            ++s;
        }
        const long double width = spans_[s].hi - spans_[s].lo;
        const auto jet = evaluate(s, (u - spans_[s].lo) / width);
        std::array<std::array<long double, 2>, 3> out{};
        for (std::size_t c = 0; c < 2; ++c) {
            out[0][c] = origin_[c] + jet[0][c];
            out[1][c] = jet[1][c] / width;
            out[2][c] = jet[2][c] / (width * width);
        }
        return out;
    }

    [[nodiscard]] OracleFoot closest(const engine::Vec2& h) const {
        const Point query{h.x - origin_[0], h.y - origin_[1]};
        Search search{.query = query};
        for (std::size_t s = 0; s < spans_.size(); ++s) {
            Piece piece{.span = s};
            for (std::size_t i = 0; i <= degree_; ++i) {
                const Homogeneous& b = spans_[s].polygon[i];
                piece.g[i] = {b[0] - b[2] * query[0], b[1] - b[2] * query[1], b[2]};
            }
            offer(search, s, piece.lo, piece.g[0]);
            offer(search, s, piece.lo + piece.width, piece.g[degree_]);
            open(search, piece);
        }
        for (int cuts = 0; cuts < kMaxCuts && !done(search); ++cuts) {
            const Piece whole = search.open.top();
            search.open.pop();
            cut(search, whole);
        }
        const long double left = search.open.empty() ? search.best : search.open.top().bound;
        const Span& span = spans_[search.span];
        const Homogeneous p = evaluate(search.span, search.t)[0];
        return {.distance = search.best,
                .u = span.lo + (span.hi - span.lo) * search.t,
                .point = {origin_[0] + p[0], origin_[1] + p[1]},
                .proved = std::min(left, search.best)};
    }

private:
    using Point = std::array<long double, 2>;
    using Homogeneous = std::array<long double, 3>;  ///< w x, w y, w
    using Polygon = std::array<Homogeneous, 10>;

    static constexpr int kMaxCuts = 200000;
    static constexpr long double kGap = 1e-17L;
    static constexpr long double kNarrow = 0x1p-100L;

    struct Span {
        Polygon polygon{};  ///< about origin_
        long double lo = 0.0L;
        long double hi = 0.0L;
    };
    struct Piece {
        Polygon g{};  ///< about the query
        std::size_t span = 0;
        long double lo = 0.0L;  ///< t in [0, 1] of the span
        long double width = 1.0L;
        long double bound = 0.0L;  ///< lower bound of the distance, m

        friend bool operator<(const Piece& a, const Piece& b) { return a.bound > b.bound; }
    };
    struct Search {
        Point query{};
        long double best = std::numeric_limits<long double>::infinity();
        std::size_t span = 0;
        long double t = 0.0L;
        std::priority_queue<Piece> open{};
    };

    static long double binomial(std::size_t n, std::size_t k) {
        long double value = 1.0L;
        for (std::size_t i = 1; i <= k; ++i) {
            value = value * static_cast<long double>(n - k + i) / static_cast<long double>(i);
        }
        return value;
    }

    /// Span from knot k to k + 1: the blossom at (lo, ..., lo, hi, ..., hi).
    [[nodiscard]] Span bezier(const NurbsData<2>& curve, std::size_t k) const {
        Span span{.lo = curve.knots[k], .hi = curve.knots[k + 1]};
        for (std::size_t j = 0; j <= degree_; ++j) {
            Polygon d{};
            for (std::size_t i = 0; i <= degree_; ++i) {
                const std::size_t at = k - degree_ + i;
                const long double w = curve.weights[at];
                d[i] = {w * (curve.points[at].x - origin_[0]),
                        w * (curve.points[at].y - origin_[1]), w};
            }
            for (std::size_t level = 1; level <= degree_; ++level) {
                const long double u = level <= j ? span.hi : span.lo;
                for (std::size_t i = degree_; i >= level; --i) {
                    const long double lo = curve.knots[k - degree_ + i];
                    const long double hi = curve.knots[k + i - level + 1];
                    for (std::size_t c = 0; c < 3; ++c) {
                        d[i][c] = ((hi - u) * d[i - 1][c] + (u - lo) * d[i][c]) / (hi - lo);
                    }
                }
            }
            span.polygon[j] = d[degree_];
        }
        return span;
    }

    static Homogeneous mix(const Homogeneous& a, const Homogeneous& b, long double t) {
        return {(1.0L - t) * a[0] + t * b[0], (1.0L - t) * a[1] + t * b[1],
                (1.0L - t) * a[2] + t * b[2]};
    }

    /// C, C', C'' at t of a span, about origin_ (x, y, 1).
    [[nodiscard]] std::array<Homogeneous, 3> evaluate(std::size_t s, long double t) const {
        Polygon d = spans_[s].polygon;
        const auto n = static_cast<long double>(degree_);
        std::array<Homogeneous, 3> h{};  // homogeneous derivatives
        for (std::size_t level = degree_; level > 0; --level) {
            for (std::size_t c = 0; c < 3; ++c) {
                if (level == 2) {
                    h[2][c] = n * (n - 1.0L) * ((d[2][c] - d[1][c]) - (d[1][c] - d[0][c]));
                } else if (level == 1) {
                    h[1][c] = n * (d[1][c] - d[0][c]);
                }
            }
            for (std::size_t i = 0; i < level; ++i) {
                d[i] = mix(d[i], d[i + 1], t);
            }
        }
        h[0] = d[0];
        std::array<Homogeneous, 3> jet{};
        for (std::size_t c = 0; c < 2; ++c) {
            jet[0][c] = h[0][c] / h[0][2];
            jet[1][c] = (h[1][c] - h[1][2] * jet[0][c]) / h[0][2];
            jet[2][c] = (h[2][c] - 2.0L * h[1][2] * jet[1][c] - h[2][2] * jet[0][c]) / h[0][2];
        }
        return jet;
    }

    /// A point of the curve, about the query: better than the best?
    void offer(Search& search, std::size_t s, long double t, const Homogeneous& g) const {
        const long double distance = std::hypot(g[0], g[1]) / g[2];
        if (distance < search.best) {
            search.best = distance;
            search.span = s;
            search.t = t;
            polish(search, s, t);
        }
    }

    /// Newton's iteration on (C - h) . C' = 0, as long as it does not go up. The distance is flat
    /// at its minimum and cannot tell when u is right: steps go on until they are below the last
    /// bit.
    void polish(Search& search, std::size_t s, long double t) const {
        const long double last_bit = 4.0L * std::numeric_limits<long double>::epsilon();
        for (int i = 0; i < 60; ++i) {
            const auto jet = evaluate(s, t);
            const Point gap{jet[0][0] - search.query[0], jet[0][1] - search.query[1]};
            const long double distance = std::hypot(gap[0], gap[1]);
            if (!(distance <= search.best + last_bit * (size_ + search.best))) {
                return;
            }
            search.best = std::min(search.best, distance);
            search.t = t;
            const long double g = gap[0] * jet[1][0] + gap[1] * jet[1][1];
            const long double speed2 = jet[1][0] * jet[1][0] + jet[1][1] * jet[1][1];
            const long double slope = speed2 + gap[0] * jet[2][0] + gap[1] * jet[2][1];
            const long double by = slope > 0.0L ? slope : speed2;
            if (!(by > 0.0L)) {
                return;
            }
            const long double next = std::clamp(t - g / by, 0.0L, 1.0L);
            if (std::fabs(next - t) <= last_bit * t) {
                return;
            }
            t = next;
        }
    }

    /// Puts a piece on the heap with its lower bound, unless it cannot hold a closer point.
    void open(Search& search, Piece& piece) const {
        long double least = std::numeric_limits<long double>::infinity();
        for (std::size_t i = 0; i <= 2 * degree_; ++i) {
            long double n = 0.0L;
            long double v = 0.0L;
            const std::size_t first = i > degree_ ? i - degree_ : 0;
            for (std::size_t k = first; k <= std::min(i, degree_); ++k) {
                const Homogeneous& a = piece.g[k];
                const Homogeneous& b = piece.g[i - k];
                n += share_[i][k] * (a[0] * b[0] + a[1] * b[1]);
                v += share_[i][k] * a[2] * b[2];
            }
            least = std::min(least, n / v);
        }
        // |g|^2 may have negative coefficients although it is none itself. The box never has.
        Point low{piece.g[0][0] / piece.g[0][2], piece.g[0][1] / piece.g[0][2]};
        Point high = low;
        for (std::size_t i = 1; i <= degree_; ++i) {
            for (std::size_t c = 0; c < 2; ++c) {
                low[c] = std::min(low[c], piece.g[i][c] / piece.g[i][2]);
                high[c] = std::max(high[c], piece.g[i][c] / piece.g[i][2]);
            }
        }
        const long double box =
            std::hypot(std::max({low[0], 0.0L, -high[0]}), std::max({low[1], 0.0L, -high[1]}));
        piece.bound = std::max(box, std::sqrt(std::max(least, 0.0L)));
        if (piece.bound < search.best && piece.width > kNarrow) {
            search.open.push(piece);
        }
    }

    void cut(Search& search, const Piece& whole) const {
        Piece left = whole;
        Piece right = whole;
        left.width = right.width = 0.5L * whole.width;
        right.lo += right.width;
        for (std::size_t level = 0; level <= degree_; ++level) {
            left.g[level] = right.g[0];
            for (std::size_t i = 0; i + level < degree_; ++i) {
                for (std::size_t c = 0; c < 3; ++c) {
                    right.g[i][c] = 0.5L * (right.g[i][c] + right.g[i + 1][c]);
                }
            }
        }
        offer(search, whole.span, right.lo, right.g[0]);
        open(search, left);
        open(search, right);
    }

    [[nodiscard]] bool done(const Search& search) const {
        return search.open.empty() ||
               search.best - search.open.top().bound <= kGap * std::max(size_, search.best);
    }

    Point origin_{};
    long double size_ = 0.0L;
    std::size_t degree_ = 1;
    std::array<std::array<long double, 10>, 19> share_{};
    std::vector<Span> spans_;
};

}  // namespace palpate::tests

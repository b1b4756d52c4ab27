#include "engine/geometry/arc_length.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace palpate::engine {
namespace {

/// Gauss-Legendre points on 0 to 1 (Abramowitz & Stegun, table 25.4).
struct GaussPoint {
    double at;
    double weight;
};
constexpr std::array<GaussPoint, 5> kGauss{
    {{.at = 0.0469100770306680, .weight = 0.1184634425280945},
     {.at = 0.2307653449471585, .weight = 0.2393143352496832},
     {.at = 0.5, .weight = 64.0 / 225.0},
     {.at = 0.7692346550528415, .weight = 0.2393143352496832},
     {.at = 0.9530899229693320, .weight = 0.1184634425280945}}};

/// Halves differ from the whole by no more than this share of the way.
constexpr double kAgreed = 1e-13;

/// Halvings at most: beside a cusp the rule does not get right, and the way is short.
constexpr int kMaxHalvings = 8;

double by_gauss(const RationalBezier<2>& curve, const Parameter& a, const Parameter& b) noexcept {
    double mean = 0.0;
    for (const GaussPoint& g : kGauss) {
        const Parameter p = between(a, b, g.at);
        mean += g.weight * glm::length(curve.local_at(p.u, p.rest).first);
    }
    return mean * distance(a, b);
}

/// @param whole  what the rule gives for all of it
double refined(const RationalBezier<2>& curve,
               const Parameter& a,
               const Parameter& b,
               double whole,
               double error,
               int halvings) noexcept {
    const Parameter middle = between(a, b, 0.5);
    const double first = by_gauss(curve, a, middle);
    const double second = by_gauss(curve, middle, b);
    const double both = first + second;
    if (std::fabs(both - whole) <= error || halvings == 0) {
        return both;
    }
    return refined(curve, a, middle, first, error, halvings - 1) +
           refined(curve, middle, b, second, error, halvings - 1);
}

/// A place of a span where its table has a length.
Parameter node(std::size_t i, std::size_t pieces) noexcept {
    const double u = static_cast<double>(i) / static_cast<double>(pieces);
    return {.u = u, .rest = 1.0 - u};
}

}  // namespace

double way_along(const RationalBezier<2>& curve,
                 const Parameter& from,
                 const Parameter& to) noexcept {
    const double whole = by_gauss(curve, from, to);
    return refined(curve, from, to, whole, kAgreed * whole, kMaxHalvings);
}

ArcLength::ArcLength(const Outline& outline) : outline_(&outline), nodes_{0.0} {
    nodes_.reserve(outline.spans().size() * kPieces + 1);
    for (const RationalBezier<2>& span : outline.spans()) {
        for (std::size_t i = 0; i < kPieces; ++i) {
            nodes_.push_back(nodes_.back() +
                             way_along(span, node(i, kPieces), node(i + 1, kPieces)));
        }
    }
}

double ArcLength::at(std::size_t span, double u) const noexcept {
    const double last = std::floor(u * static_cast<double>(kPieces));
    const auto i = static_cast<std::size_t>(std::clamp(last, 0.0, static_cast<double>(kPieces)));
    return nodes_[span * kPieces + i] +
           way_along(outline_->spans()[span], node(i, kPieces), {u, 1.0 - u});
}

}  // namespace palpate::engine

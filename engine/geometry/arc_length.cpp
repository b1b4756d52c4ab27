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
constexpr std::array<GaussPoint, 3> kGauss{{{.at = 0.1127016653792583, .weight = 5.0 / 18.0},
                                            {.at = 0.5, .weight = 8.0 / 18.0},
                                            {.at = 0.8872983346207417, .weight = 5.0 / 18.0}}};

}  // namespace

ArcLength::ArcLength(const Outline& outline) {
    constexpr double kPiece = 1.0 / static_cast<double>(kPieces);
    nodes_.reserve(outline.spans().size() * (kPieces + 1));
    double length = 0.0;
    for (const RationalBezier<2>& span : outline.spans()) {
        const auto rate = [&span](double piece) {
            return kPiece * glm::length(span.at(kPiece * piece).first);
        };
        for (std::size_t i = 0; i <= kPieces; ++i) {
            const auto piece = static_cast<double>(i);
            nodes_.push_back({.at = length, .rate = rate(piece)});
            for (const GaussPoint& g : kGauss) {
                length += i < kPieces ? g.weight * rate(piece + g.at) : 0.0;
            }
        }
    }
}

/// By the cubic that has the lengths and the rates of the two nodes.
double ArcLength::at(std::size_t span, double u) const noexcept {
    const double piece = u * static_cast<double>(kPieces);
    const auto i =
        static_cast<std::size_t>(std::clamp(piece, 0.0, static_cast<double>(kPieces - 1)));
    const Node& a = nodes_[span * (kPieces + 1) + i];
    const Node& b = nodes_[span * (kPieces + 1) + i + 1];
    const double t = piece - static_cast<double>(i);
    const double step = b.at - a.at;
    return a.at + t * (a.rate + t * (3.0 * step - 2.0 * a.rate - b.rate +
                                     t * (a.rate + b.rate - 2.0 * step)));
}

}  // namespace palpate::engine

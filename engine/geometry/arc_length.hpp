#pragma once

#include <cmath>
#include <vector>

#include "engine/geometry/outline.hpp"

namespace palpate::engine {

/// A parameter of a span, with 1 - u: beside a heavy last control point u has lost its digits.
struct Parameter {
    double u = 0.0;
    double rest = 1.0;
};

/// From a to b by a share of what the parameter goes by, 0 to 1.
[[nodiscard]] inline Parameter between(const Parameter& a,
                                       const Parameter& b,
                                       double share) noexcept {
    return {.u = a.u + share * (b.u - a.u), .rest = a.rest + share * (b.rest - a.rest)};
}
/// What the parameter goes by from a to b, >= 0.
[[nodiscard]] inline double distance(const Parameter& a, const Parameter& b) noexcept {
    return std::fabs(a.u + b.u < 1.0 ? b.u - a.u : a.rest - b.rest);
}

/// Way along a span between two of its places, m, to 1e-12 of itself where the span moves at all
/// evenly: by Gauss' rule, on halves where these do not agree with the whole.
[[nodiscard]] double way_along(const RationalBezier<2>& curve,
                               const Parameter& from,
                               const Parameter& to) noexcept;

/// How long an outline is up to each of its places, whatever its parameter: a table, made once.
class ArcLength {
public:
    /// Of no outline.
    ArcLength() = default;
    /// @param outline  must live as long as this
    explicit ArcLength(const Outline& outline);

    /// From the outline's beginning to u on a span, m; as right as way_along(). @param u  0 to 1
    [[nodiscard]] double at(std::size_t span, double u) const noexcept;
    /// Of the whole outline, m.
    [[nodiscard]] double whole() const noexcept { return nodes_.empty() ? 0.0 : nodes_.back(); }

private:
    static constexpr std::size_t kPieces = 64;  ///< of each span, evenly by u

    const Outline* outline_ = nullptr;
    std::vector<double> nodes_;  ///< m, of each span kPieces, and at the end
};

}  // namespace palpate::engine

#pragma once

#include <cmath>

namespace palpate::engine {

/// How the slope of a function changes, as one search for its root saw it, for the next search near
/// by: the first step of Newton's then goes along a parabola, and its error is of third order in
/// the step.
class Bend {
public:
    /// Newton's step, bent; as it is where more than a half of it would be bent.
    [[nodiscard]] double step(double newton) const noexcept {
        const double share = half_ * newton;
        if (std::fabs(share) > 0.5) {
            return newton;
        }
        return newton - share * newton;
    }
    /// The slope was `before`, and is `after` a step of `du` further.
    void see(double before, double after, double du) noexcept {
        const double half = 0.5 * (after - before) / (before * du);
        half_ = std::fabs(half) < kMax ? half : 0.0;
    }

private:
    static constexpr double kMax = 64.0;  ///< beyond it nothing is foretold
    double half_ = 0.0;                   ///< share of the slope that half a unit of u changes
};

}  // namespace palpate::engine

#pragma once

#include <limits>

namespace palpate::engine {

/// From where a contact may begin: through the surface alone. The distance from an object changes
/// by no more than HIP moves, so that a HIP which has come through its surface lies no deeper than
/// its way since the last tick. One that is deeper was led round an open end, or round a border,
/// to the back, and feels nothing until it has been outside again: no contact begins at full depth.
class Approach {
public:
    /// A tick without contact. @param depth  m, of HIP inside; 0 outside
    void stay(double depth) noexcept {
        if (depth == 0.0 || depth_ >= 0.0) {
            depth_ = depth;
        }
    }

    /// HIP is inside, out of contact so far. @param depth  m  @param moved  since the last tick, m
    /// @param rounding  of both, m
    /// @return whether a contact begins; the first tick of all may begin anywhere
    [[nodiscard]] bool enters(double depth, double moved, double rounding) noexcept {
        if (!(depth > depth_ + moved + rounding)) {
            return true;
        }
        depth_ = -std::numeric_limits<double>::infinity();
        return false;
    }

private:
    /// Of the last tick, m: 0 outside; infinity before the first; -infinity behind the surface.
    double depth_ = std::numeric_limits<double>::infinity();
};

/// What two distances and a way may be off by, m: a followed closest point lies up to 1e-12 beside.
/// @param depth  m  @param size  of HIP's coordinates, m
[[nodiscard]] inline double rounding_of(double depth, double size) noexcept {
    return 1e-9 * (1.0 + depth + size);
}

}  // namespace palpate::engine

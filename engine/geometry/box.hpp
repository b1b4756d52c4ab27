#pragma once

#include <span>

#include <glm/common.hpp>

#include "engine/geometry/vec.hpp"

namespace palpate::engine {

/// Axis-aligned box, m.
template <int D>
struct Box {
    Vec<D> low{};
    Vec<D> high{};

    [[nodiscard]] Vec<D> middle() const noexcept { return low + 0.5 * (high - low); }
    [[nodiscard]] Vec<D> size() const noexcept { return high - low; }

    /// Squared distance from `h`, m^2: 0 inside.
    [[nodiscard]] double distance2(const Vec<D>& h) const noexcept {
        double sum = 0.0;
        for (int k = 0; k < D; ++k) {
            const double below = low[k] - h[k];
            const double above = h[k] - high[k];
            const double gap = below > 0.0 ? below : above > 0.0 ? above : 0.0;
            sum += gap * gap;
        }
        return sum;
    }

    void add(const Box& other) noexcept {
        low = glm::min(low, other.low);
        high = glm::max(high, other.high);
    }
};

/// Box of at least one point.
template <int D>
[[nodiscard]] Box<D> box_of(std::span<const Vec<D>> points) noexcept {
    Box<D> box{points[0], points[0]};
    for (const Vec<D>& p : points) {
        box.low = glm::min(box.low, p);
        box.high = glm::max(box.high, p);
    }
    return box;
}

}  // namespace palpate::engine

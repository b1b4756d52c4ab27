#pragma once

#include "engine/geometry/vec.hpp"

namespace palpate::ui {

/// From pixels of the window to the object's frame: 0.25 mm a unit of the display, y up, and the
/// middle of the window is the point (0, 30 mm), so that the whole object and the start pose fit
/// into 800 x 600 of them. A unit is a pixel, or the `scale` pixels that a desktop makes of one
/// where they are small.
struct PointerMap {
    static constexpr double kMetresPerUnit = 0.25e-3;
    static constexpr engine::Vec2 kMiddle{0.0, 0.030};

    engine::Vec2 window{};  ///< size, pixels
    double scale = 1.0;     ///< Window::scale()

    /// Pixels, y down, to the object frame, m, y up; to_pixel() is its inverse but for rounding.
    [[nodiscard]] engine::Vec2 to_object(const engine::Vec2& pixel) const {
        const engine::Vec2 d = pixel - 0.5 * window;
        return kMiddle + kMetresPerUnit / scale * engine::Vec2{d.x, -d.y};
    }
    [[nodiscard]] engine::Vec2 to_pixel(const engine::Vec2& object) const {
        const engine::Vec2 d = (object - kMiddle) * (scale / kMetresPerUnit);
        return 0.5 * window + engine::Vec2{d.x, -d.y};
    }
};

}  // namespace palpate::ui

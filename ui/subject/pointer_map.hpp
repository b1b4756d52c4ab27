#pragma once

#include "engine/geometry/vec.hpp"

namespace palpate::ui {

/// From pixels of the window to the object's frame: 0.25 mm a pixel, y up, and the middle of the window
/// is the point (0, 30 mm), so that the whole object and the start pose fit into 800 x 600 pixels.
struct PointerMap {
    static constexpr double kMetresPerPixel = 0.25e-3;
    static constexpr engine::Vec2 kMiddle{0.0, 0.030};

    engine::Vec2 window{};  ///< size, pixels

    [[nodiscard]] engine::Vec2 to_object(const engine::Vec2& pixel) const {
        const engine::Vec2 d = pixel - 0.5 * window;
        return kMiddle + kMetresPerPixel * engine::Vec2{d.x, -d.y};
    }
    [[nodiscard]] engine::Vec2 to_pixel(const engine::Vec2& object) const {
        const engine::Vec2 d = (object - kMiddle) / kMetresPerPixel;
        return 0.5 * window + engine::Vec2{d.x, -d.y};
    }
};

}  // namespace palpate::ui

#pragma once

#include "ui/subject/window.hpp"

/// Colours and sizes of the subject's screen: light type on a dark, even grey, so that the room stays
/// dim and nothing flickers from screen to screen.
namespace palpate::ui {

inline constexpr Colour kBackground{24, 27, 33};
inline constexpr Colour kText{232, 234, 238};
inline constexpr Colour kQuiet{146, 152, 164};
inline constexpr Colour kAccent{255, 190, 92};
inline constexpr Colour kCard{244, 242, 236};
inline constexpr Colour kShape{198, 210, 222};
inline constexpr Colour kOutline{32, 44, 60};

/// Height of running text, pixels: 1/34 of the smaller side's reference, legible from 80 cm.
[[nodiscard]] inline double type_size(const engine::Vec2& window) {
    const double by_height = window.y / 32.0;
    const double by_width = window.x / 48.0;
    return by_height < by_width ? by_height : by_width;
}

}  // namespace palpate::ui

#pragma once

#include "ui/subject/window.hpp"

/// Colours and sizes of the subject's screen: light type on a dark, even grey, so that the room
/// stays dim and nothing flickers from screen to screen.
namespace palpate::ui {

inline constexpr Colour kBackground{24, 27, 33};
inline constexpr Colour kText{232, 234, 238};
inline constexpr Colour kQuiet{146, 152, 164};
inline constexpr Colour kAccent{255, 190, 92};
inline constexpr Colour kCard{244, 242, 236};
inline constexpr Colour kShape{198, 210, 222};
inline constexpr Colour kOutline{32, 44, 60};
inline constexpr Colour kWall{120, 132, 148};

/// Height of running text, pixels: on a screen of 24 inches its small letters are 5.1 mm high,
/// which is 22 minutes of arc from 80 cm. Narrow windows have smaller type, so that sentences keep
/// their rows.
[[nodiscard]] inline double type_size(const engine::Vec2& window) {
    const double by_height = window.y / 32.0;
    const double by_width = window.x / 48.0;
    return by_height < by_width ? by_height : by_width;
}

/// What the experimenter reads from 1 m, in type sizes. On a screen of 24 inches, 0.30 m high, its
/// small letters are 6.7 mm high, 23 minutes of arc; ISO 9241-303 asks for 16 at least, and for 20
/// to 22.
inline constexpr double kFromAfar = 1.3;
/// The bar of the experimenter's desk begins here, as a share of the window's height: nothing that
/// a participant has to read stands below.
inline constexpr double kBarTop = 0.89;

}  // namespace palpate::ui

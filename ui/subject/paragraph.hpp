#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "ui/subject/window.hpp"

namespace palpate::ui {

/// A rectangle of the window, pixels from the top left.
struct Area {
    engine::Vec2 corner{};
    engine::Vec2 size{};
};

/// `text` in rows of at most `width` pixels, broken at line breaks and between words; a word that
/// is wider by itself is cut. An empty line stays an empty row.
/// @param height  of the type, pixels
[[nodiscard]] std::vector<std::string> wrapped(Window& window,
                                               std::string_view text,
                                               double height,
                                               double width);

/// The height of write_into()'s type, pixels: at most `height`, smaller if the rows would not fit.
[[nodiscard]] double fitting_height(Window& window,
                                    std::string_view text,
                                    const engine::Vec2& size,
                                    double height);

/// Writes `text` into the middle of `area`, wrapped, its rows aligned at the left edge, centre or
/// right edge. Type of `height` pixels, smaller in steps of a tenth if the rows would not fit, but
/// not below kSmallestType. Returns the height taken.
double write_into(Window& window,
                  std::string_view text,
                  const Area& area,
                  double height,
                  Colour colour,
                  Align align = Align::centre);

/// Pixels, of type: smaller is no longer read.
inline constexpr double kSmallestType = 8.0;
/// From row to row, of the type's height.
inline constexpr double kLeading = 1.35;

}  // namespace palpate::ui

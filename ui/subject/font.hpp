#pragma once

#include <string>
#include <string_view>

namespace palpate::ui {

/// `asked` if it opens as a font; for an empty one DejaVu Sans where Linux systems keep it.
/// @throws std::runtime_error with the remedy; of `asked` std::invalid_argument
[[nodiscard]] std::string find_font(const std::string& asked);

/// What a screen does not show as it was meant.
struct Unshown {
    std::string character;    ///< UTF-8; empty: all is shown
    bool from_right = false;  ///< of a script from right to left, which is not drawn so
};
/// The first character of `text` that the font `file` lacks, or that runs from right to left.
/// @throws std::runtime_error if the font does not open
[[nodiscard]] Unshown unshown(std::string_view text, const std::string& file);

}  // namespace palpate::ui

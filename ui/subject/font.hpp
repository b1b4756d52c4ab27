#pragma once

#include <string>
#include <string_view>

namespace palpate::ui {

/// `asked` if it opens as a font; for an empty one DejaVu Sans where Linux systems keep it.
/// @throws std::runtime_error with the remedy; of `asked` std::invalid_argument
[[nodiscard]] std::string find_font(const std::string& asked);

/// What a screen does not show as it was meant.
struct Unshown {
    std::string lacking;     ///< the first character that the font lacks, UTF-8; empty: none
    std::string from_right;  ///< and of a script from right to left, which is not drawn so
};
/// Of `text` in the font `file`.
/// @throws std::runtime_error if the font does not open
[[nodiscard]] Unshown unshown(std::string_view text, const std::string& file);

}  // namespace palpate::ui

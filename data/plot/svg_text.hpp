#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace palpate::data {

/// `text` for XML: the five special characters as entities, control characters left out, bytes that
/// are no UTF-8 as U+FFFD.
[[nodiscard]] std::string xml_escaped(std::string_view text);

/// A coordinate or size with two decimals, never "-0.00".
[[nodiscard]] std::string px(double value);

/// Width of `text` in a sans-serif font of `size` px, from a table of letter classes: DejaVu Sans,
/// which is wide, so that most other fonts take less.
[[nodiscard]] double text_width(std::string_view text, double size);

/// Lines of at most `width` px, broken at spaces (a longer word stands alone) and at "\n".
[[nodiscard]] std::vector<std::string> wrapped(std::string_view text, double width, double size);

/// `n` in superscript digits: "⁻³".
[[nodiscard]] std::string superscript(int n);

enum class Anchor { start, middle, end };

/// One <text> element; `text` is escaped here. `extra`: further attributes, as they are.
[[nodiscard]] std::string svg_text(double x,
                                   double y,
                                   std::string_view text,
                                   double size,
                                   Anchor anchor = Anchor::start,
                                   std::string_view extra = {});

}  // namespace palpate::data

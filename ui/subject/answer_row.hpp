#pragma once

#include <optional>
#include <string>
#include <vector>

#include "protocols/trial/observer.hpp"
#include "ui/subject/picture_row.hpp"
#include "ui/subject/window.hpp"

/// The answers of a question as cards side by side, whatever they show.
namespace palpate::ui {

/// Cards for the answers of `question` in a window of `window` pixels: pictures, two wide cards
/// with words, or the squares of a scale.
[[nodiscard]] std::vector<Card> lay_out_answers(const protocols::Question& question,
                                                const engine::Vec2& window);
/// Squares for the levels 1 .. `levels` of a scale.
[[nodiscard]] std::vector<Card> lay_out_scale(std::size_t levels, const engine::Vec2& window);

/// Draws the cards of lay_out_answers(). @param selected  the card to highlight
void draw_answers(Window& window,
                  const protocols::Question& question,
                  std::optional<std::size_t> selected);
/// Draws the squares of lay_out_scale() with their numbers, and the words of both ends below.
void draw_scale(Window& window,
                std::size_t levels,
                const std::string& low,
                const std::string& high,
                std::optional<std::size_t> selected);

}  // namespace palpate::ui

#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocols/trial/observer.hpp"
#include "ui/subject/window.hpp"

/// The answers of a question as cards side by side, whatever they show.
namespace palpate::ui {

/// Where a picture's card stands, pixels.
struct Card {
    engine::Vec2 corner{};  ///< top left
    engine::Vec2 size{};

    /// Its middle; and whether a pixel is on it, the right and lower edges not.
    [[nodiscard]] engine::Vec2 centre() const { return corner + 0.5 * size; }
    [[nodiscard]] bool contains(const engine::Vec2& p) const {
        return p.x >= corner.x && p.y >= corner.y && p.x < corner.x + size.x &&
               p.y < corner.y + size.y;
    }
};

/// Cards of `count` pictures side by side in the middle of a window of `window` pixels, all alike
/// and as wide as it has room for.
[[nodiscard]] std::vector<Card> lay_out_cards(std::size_t count, const engine::Vec2& window);

/// Which card is at `pixel`.
[[nodiscard]] std::optional<std::size_t> card_at(std::span<const Card> cards,
                                                 const engine::Vec2& pixel);

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

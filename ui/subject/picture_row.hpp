#pragma once

#include <optional>
#include <span>
#include <vector>

#include "protocols/trial/observer.hpp"
#include "ui/subject/window.hpp"

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

/// An empty card, with a frame if it is chosen.
void draw_blank(Window& window, const Card& card, bool chosen);

/// Draws the pictures on their cards, all at one scale and about one centre, with their numbers
/// below.
/// @param selected  the card to highlight
void draw_pictures(Window& window,
                   std::span<const Card> cards,
                   std::span<const protocols::Picture> pictures,
                   std::optional<std::size_t> selected);

}  // namespace palpate::ui

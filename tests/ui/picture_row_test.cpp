#include "ui/subject/picking.hpp"
#include "tests/support/catch.hpp"

using namespace palpate::ui;
using palpate::engine::Vec2;

TEST_CASE("cards lie side by side inside the window, all alike, for 2 to 9 pictures",
          "[pictures][law]") {
    for (const Vec2& window :
         {Vec2{1024.0, 768.0}, Vec2{1280.0, 800.0}, Vec2{1920.0, 1080.0}, Vec2{800.0, 1200.0}}) {
        for (std::size_t n = 2; n <= 9; ++n) {
            CAPTURE(window.x, window.y, n);
            const std::vector<Card> cards = lay_out_cards(n, window);
            REQUIRE(cards.size() == n);
            for (std::size_t i = 0; i < n; ++i) {
                CHECK(cards[i].corner.x >= 0.0);
                CHECK(cards[i].corner.x + cards[i].size.x <= window.x);
                CHECK(cards[i].corner.y > 0.2 * window.y);
                CHECK(cards[i].corner.y + cards[i].size.y < 0.8 * window.y);
                CHECK(cards[i].size == cards[0].size);
                if (i > 0) {
                    CHECK(cards[i].corner.x > cards[i - 1].corner.x + cards[i - 1].size.x);
                }
                CHECK(card_at(cards, cards[i].centre()) == i);
                CHECK_FALSE(card_at(cards, cards[i].corner - Vec2{2.0, 2.0}).has_value());
            }
        }
    }
}

TEST_CASE("a pixel goes to the object's frame and back, y up, the middle at (0, 30 mm)",
          "[pointer][law]") {
    const PointerMap map{{1280.0, 800.0}};
    CHECK(map.to_object({640.0, 400.0}) == Vec2{0.0, 0.030});
    CHECK(map.to_object({644.0, 396.0}).x > 0.0);
    CHECK(map.to_object({644.0, 396.0}).y > 0.030);
    for (int i = 0; i < 100; ++i) {
        const Vec2 pixel{i * 12.8, i * 8.0};
        CHECK(glm::length(map.to_pixel(map.to_object(pixel)) - pixel) < 1e-9);
    }
}

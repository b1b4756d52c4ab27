#include "ui/subject/picture_row.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "ui/subject/stroke.hpp"
#include "ui/subject/style.hpp"

namespace palpate::ui {
namespace {

using engine::Vec2;

/// One box around all pictures: they share scale and centre, so that only the shape differs.
struct Box {
    Vec2 lo{1e9, 1e9};
    Vec2 hi{-1e9, -1e9};
};

Box box_of(std::span<const protocols::Picture> pictures) {
    Box box;
    for (const protocols::Picture& picture : pictures) {
        const auto hold = [&box](std::span<const Vec2> line) {
            for (const Vec2& p : line) {
                box.lo = Vec2{std::min(box.lo.x, p.x), std::min(box.lo.y, p.y)};
                box.hi = Vec2{std::max(box.hi.x, p.x), std::max(box.hi.y, p.y)};
            }
        };
        hold(picture.outline);
        for (const auto& wall : picture.walls) {
            hold(wall);
        }
    }
    return box;
}

std::vector<Vec2> on_card(std::span<const Vec2> drawn, const Box& box, const Card& card) {
    const Vec2 extent = box.hi - box.lo;
    const double scale = 0.90 * std::min(card.size.x / extent.x, card.size.y / extent.y);
    std::vector<Vec2> points;
    points.reserve(drawn.size());
    for (const Vec2& p : drawn) {
        const Vec2 d = (p - 0.5 * (box.lo + box.hi)) * scale;
        points.push_back(card.centre() +
                         Vec2{d.x, -d.y});  // y is up in the object, down on the screen
    }
    return points;
}

/// An open line as a closed one.
std::vector<Vec2> there_and_back(std::vector<Vec2> line) {
    for (std::size_t i = line.size() - 1; i-- > 1;) {
        line.push_back(line[i]);
    }
    return line;
}

void draw_shape(Window& window,
                const protocols::Picture& picture,
                const Box& box,
                const Card& card) {
    const std::vector<Vec2> outline = on_card(picture.outline, box, card);
    const double width = std::max(3.0, 0.018 * card.size.x);
    const double thin = picture.walls.empty() ? width : 0.6 * width;
    for (const auto& wall : picture.walls) {
        const std::vector<Vec2> edge = on_card(wall, box, card);
        window.triangles(fill(edge), kWall);
        window.triangles(stroke(edge, thin), kOutline);
    }
    window.triangles(fill(outline), kShape);
    if (!picture.shade.empty()) {
        std::vector<Vec2> points;
        for (const auto& one : picture.shade) {
            points.push_back(one.point);
        }
        points = on_card(points, box, card);
        std::vector<Corner> corners;
        for (std::size_t i = 0; i < points.size(); ++i) {
            corners.push_back({points[i], picture.shade[i].dark});
        }
        window.triangles(corners, kOutline);
    }
    for (const auto& line : picture.lines) {
        window.triangles(stroke(there_and_back(on_card(line, box, card)), 0.25 * width), kOutline);
    }
    window.triangles(stroke(outline, thin), kOutline);
}

}  // namespace

std::vector<Card> lay_out_cards(std::size_t count, const Vec2& window) {
    const auto n = static_cast<double>(count);
    const double gap = 0.016 * window.x;
    const double width = (0.96 * window.x - (n - 1.0) * gap) / n;
    const double height = std::min(width, 0.46 * window.y);
    const double left = 0.02 * window.x;
    std::vector<Card> cards;
    for (std::size_t i = 0; i < count; ++i) {
        cards.push_back(
            {Vec2{left + static_cast<double>(i) * (width + gap), 0.49 * window.y - 0.5 * height},
             Vec2{width, height}});
    }
    return cards;
}

std::optional<std::size_t> card_at(std::span<const Card> cards, const Vec2& pixel) {
    for (std::size_t i = 0; i < cards.size(); ++i) {
        if (cards[i].contains(pixel)) {
            return i;
        }
    }
    return std::nullopt;
}

void draw_blank(Window& window, const Card& card, bool chosen) {
    if (chosen) {
        const double frame = 0.2 * type_size(window.size());
        window.triangles(
            rectangle(card.corner - Vec2{frame, frame}, card.size + 2.0 * Vec2{frame, frame}),
            kAccent);
    }
    window.triangles(rectangle(card.corner, card.size), kCard);
}

void draw_pictures(Window& window,
                   std::span<const Card> cards,
                   std::span<const protocols::Picture> pictures,
                   std::optional<std::size_t> selected) {
    const Box box = box_of(pictures);
    const double type = type_size(window.size());
    for (std::size_t i = 0; i < pictures.size(); ++i) {
        const Card& card = cards[i];
        const bool chosen = selected == i;
        draw_blank(window, card, chosen);
        window.fine(card.corner, card.size, [&] { draw_shape(window, pictures[i], box, card); });
        window.text(fmt::format("{}", i + 1),
                    {card.centre().x, card.corner.y + card.size.y + 1.2 * type}, 1.3 * type,
                    chosen ? kAccent : kText);
    }
}

}  // namespace palpate::ui

#include "ui/subject/answer_row.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "ui/subject/paragraph.hpp"
#include "ui/subject/stroke.hpp"

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

using protocols::Question;
using protocols::ResponseKind;

/// @param middle  of the cards, as a share of the window's height
std::vector<Card> in_a_row(
    std::size_t count, const Vec2& size, double gap, const Vec2& window, double middle = 0.5) {
    const auto n = static_cast<double>(count);
    const double left = 0.5 * (window.x - n * size.x - (n - 1.0) * gap);
    const double top = middle * window.y - 0.5 * size.y;
    std::vector<Card> cards;
    for (std::size_t i = 0; i < count; ++i) {
        cards.push_back({Vec2{left + static_cast<double>(i) * (size.x + gap), top}, size});
    }
    return cards;
}

std::vector<Card> lay_out_words(std::size_t count, const Vec2& window) {
    const auto n = static_cast<double>(count);
    const double gap = 0.05 * window.x;
    const double width = std::min(0.30 * window.x, (0.90 * window.x - (n - 1.0) * gap) / n);
    return in_a_row(count, {width, 0.24 * window.y}, gap, window);
}

/// An empty card, with a frame if it is chosen.
void draw_blank(Window& window, const Card& card, bool chosen) {
    if (chosen) {
        const double frame = 0.2 * type_size(window.size());
        window.triangles(
            rectangle(card.corner - Vec2{frame, frame}, card.size + 2.0 * Vec2{frame, frame}),
            kAccent);
    }
    window.triangles(rectangle(card.corner, card.size), kCard);
}

/// Which key takes a card, below it. @param down  in lines of type
void write_number(Window& window, const Card& card, std::size_t index, double down, bool chosen) {
    const double type = type_size(window.size());
    window.text(fmt::format("{}", index + 1),
                {card.centre().x, card.corner.y + card.size.y + down * type}, 1.3 * type,
                chosen ? kAccent : kText);
}

/// The pictures on their cards, all at one scale and about one centre, with their numbers below.
void draw_pictures(Window& window,
                   std::span<const Card> cards,
                   std::span<const protocols::Picture> pictures,
                   std::optional<std::size_t> selected) {
    const Box box = box_of(pictures);
    for (std::size_t i = 0; i < pictures.size(); ++i) {
        const Card& card = cards[i];
        draw_blank(window, card, selected == i);
        window.fine(card.corner, card.size, [&] { draw_shape(window, pictures[i], box, card); });
        write_number(window, card, i, 1.2, selected == i);
    }
}

/// A card with text in its middle.
void draw_card(
    Window& window, const Card& card, std::string_view text, double height, bool chosen) {
    draw_blank(window, card, chosen);
    write_into(window, text, {card.corner + 0.06 * card.size, 0.88 * card.size}, height, kOutline);
}

void draw_words(Window& window,
                const std::vector<std::string>& words,
                std::optional<std::size_t> selected) {
    const double type = type_size(window.size());
    const std::vector<Card> cards = lay_out_words(words.size(), window.size());
    for (std::size_t i = 0; i < cards.size(); ++i) {
        draw_card(window, cards[i], words[i], 1.9 * type, selected == i);
        write_number(window, cards[i], i, 1.5, selected == i);
    }
}

/// The protocol's label, or the screen's own word.
std::string label(const Question& question, std::size_t index, std::string_view own) {
    const bool given = index < question.labels.size() && !question.labels[index].empty();
    return given ? question.labels[index] : std::string(own);
}

}  // namespace

std::vector<Card> lay_out_cards(std::size_t count, const Vec2& window) {
    const auto n = static_cast<double>(count);
    const double gap = 0.016 * window.x;
    const double width = (0.96 * window.x - (n - 1.0) * gap) / n;
    return in_a_row(count, {width, std::min(width, 0.46 * window.y)}, gap, window, 0.49);
}

std::optional<std::size_t> card_at(std::span<const Card> cards, const Vec2& pixel) {
    const auto at =
        std::ranges::find_if(cards, [&](const Card& card) { return card.contains(pixel); });
    return at == cards.end() ? std::nullopt
                             : std::optional(static_cast<std::size_t>(at - cards.begin()));
}

std::vector<Card> lay_out_scale(std::size_t levels, const Vec2& window) {
    const auto n = static_cast<double>(levels);
    const double narrow = 0.014 * window.x;
    const double side =
        std::min({0.10 * window.x, 0.16 * window.y, (0.88 * window.x - (n - 1.0) * narrow) / n});
    // A short scale is drawn out, to leave room for the words of its ends.
    const double gap = std::max(narrow, (0.42 * window.x - n * side) / (n - 1.0));
    return in_a_row(levels, {side, side}, gap, window);
}

std::vector<Card> lay_out_answers(const Question& question, const Vec2& window) {
    switch (question.kind) {
        case ResponseKind::identification:
            return lay_out_cards(question.answers, window);
        case ResponseKind::rating:
            return lay_out_scale(question.answers, window);
        case ResponseKind::two_interval:
        case ResponseKind::yes_no:
            break;
    }
    return lay_out_words(question.answers, window);
}

void draw_scale(Window& window,
                std::size_t levels,
                const std::string& low,
                const std::string& high,
                std::optional<std::size_t> selected) {
    const double type = type_size(window.size());
    const std::vector<Card> cards = lay_out_scale(levels, window.size());
    for (std::size_t i = 0; i < cards.size(); ++i) {
        draw_card(window, cards[i], fmt::format("{}", i + 1), 1.7 * type, selected == i);
    }
    // The words of an end stand below its card, as wide as the margin and the window's middle
    // permit.
    const double below = cards.front().corner.y + cards.front().size.y + 0.6 * type;
    const auto area = [&](double x) {
        const double room = std::min(x, window.size().x - x) - type;
        const double half = std::min(room, std::abs(0.5 * window.size().x - x) - 0.5 * type);
        return Area{{x - half, below}, {2.0 * half, 0.14 * window.size().y}};
    };
    const Area left = area(cards.front().centre().x);
    const Area right = area(cards.back().centre().x);
    const double height =  // the longer one's: neither end is to look weightier
        std::min(fitting_height(window, low, left.size, 1.1 * type),
                 fitting_height(window, high, right.size, 1.1 * type));
    write_into(window, low, left, height, kText);
    write_into(window, high, right, height, kText);
}

void draw_answers(Window& window, const Question& question, std::optional<std::size_t> selected) {
    const Words& words = window.words();
    switch (question.kind) {
        case ResponseKind::identification:
            draw_pictures(window, lay_out_cards(question.pictures.size(), window.size()),
                          question.pictures, selected);
            return;
        case ResponseKind::rating:
            draw_scale(window, question.answers, label(question, 0, words.least),
                       label(question, 1, words.most), selected);
            return;
        case ResponseKind::two_interval:
            draw_words(window, {std::string(words.first), std::string(words.second)}, selected);
            return;
        case ResponseKind::yes_no:
            draw_words(window, {label(question, 0, words.no), label(question, 1, words.yes)},
                       selected);
            return;
    }
}

}  // namespace palpate::ui

#include "ui/subject/answer_row.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "ui/subject/paragraph.hpp"
#include "ui/subject/stroke.hpp"
#include "ui/subject/style.hpp"

namespace palpate::ui {
namespace {

using engine::Vec2;
using protocols::Question;
using protocols::ResponseKind;

std::vector<Card> in_a_row(std::size_t count, const Vec2& size, double gap, const Vec2& window) {
    const auto n = static_cast<double>(count);
    const double left = 0.5 * (window.x - n * size.x - (n - 1.0) * gap);
    std::vector<Card> cards;
    for (std::size_t i = 0; i < count; ++i) {
        cards.push_back(
            {Vec2{left + static_cast<double>(i) * (size.x + gap), 0.5 * (window.y - size.y)},
             size});
    }
    return cards;
}

std::vector<Card> lay_out_words(std::size_t count, const Vec2& window) {
    const auto n = static_cast<double>(count);
    const double gap = 0.05 * window.x;
    const double width = std::min(0.30 * window.x, (0.90 * window.x - (n - 1.0) * gap) / n);
    return in_a_row(count, {width, 0.24 * window.y}, gap, window);
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
        const Card& card = cards[i];
        const bool chosen = selected == i;
        draw_card(window, card, words[i], 1.9 * type, chosen);
        window.text(fmt::format("{}", i + 1),
                    {card.centre().x, card.corner.y + card.size.y + 1.5 * type}, 1.3 * type,
                    chosen ? kAccent : kText);
    }
}

/// The protocol's label, or the screen's own word.
std::string label(const Question& question, std::size_t index, std::string_view own) {
    const bool given = index < question.labels.size() && !question.labels[index].empty();
    return given ? question.labels[index] : std::string(own);
}

}  // namespace

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

#include "ui/subject/faces.hpp"

#include <sstream>
#include <vector>

#include <fmt/format.h>

#include "ui/subject/stroke.hpp"
#include "ui/subject/style.hpp"
#include "ui/subject/words.hpp"

namespace palpate::ui {
namespace {

using engine::Vec2;

/// A place in the window by shares of its size.
Vec2 at(const Window& window, double x, double y) {
    const Vec2 size = window.size();
    return {x * size.x, y * size.y};
}

void line(Window& window, std::string_view text, double y, double height, Colour colour) {
    window.text(text, at(window, 0.5, y), height * type_size(window.size()), colour);
}

/// `text` in rows of at most `width` pixels, broken between words; a longer word has a row of its own.
std::vector<std::string> wrapped(Window& window,
                                 const std::string& text,
                                 double height,
                                 double width) {
    std::vector<std::string> rows(1);
    std::istringstream words(text);
    for (std::string word; words >> word;) {
        const std::string longer = rows.back().empty() ? word : rows.back() + ' ' + word;
        if (rows.back().empty() ||
            window.text_width(longer, height * type_size(window.size())) <= width) {
            rows.back() = longer;
        } else {
            rows.push_back(word);
        }
    }
    return rows;
}

/// A sentence with its numbers.
template <class... Numbers>
std::string with(std::string_view sentence, const Numbers&... numbers) {
    return fmt::format(fmt::runtime(sentence), numbers...);
}

void trial_number(Window& window, std::size_t number, std::size_t total, bool practice) {
    const Words& words = window.words();
    line(window, with(practice ? words.practice_trial : words.trial, number, total), 0.10, 1.0,
         kQuiet);
}

}  // namespace

void draw(Window& window, const WelcomeFace& face) {
    const Words& words = window.words();
    line(window, face.resumed ? words.welcome_back : words.welcome, 0.18, 2.2, kText);
    line(window, words.you_feel, 0.34, 1.15, kText);
    line(window, words.you_choose, 0.41, 1.15, kText);
    if (face.moves_pointer) {
        line(window, words.pointer_is_handle, 0.48, 1.15, kText);
    }
    line(window, words.take_time, 0.55, 1.15, kText);
    line(window, with(face.resumed ? words.trials_resumed : words.trials, face.trials), 0.66, 1.0,
         kQuiet);
    line(window, words.begin, 0.84, 1.3, kAccent);
}

void draw(Window& window, const ReadyFace& face) {
    const Words& words = window.words();
    trial_number(window, face.number, face.total, face.practice);
    line(window, words.ready, 0.42, 2.4, kText);
    line(window, words.hold_handle, 0.54, 1.15, kText);
    line(window, face.dead_man ? words.hold_to_feel : words.press_to_feel, 0.84, 1.3, kAccent);
}

void draw(Window& window, const ExploreFace& face) {
    const Words& words = window.words();
    trial_number(window, face.number, face.total, face.practice);
    line(window, words.feel, 0.42, 2.4, kText);
    line(window, words.both_sides, 0.54, 1.15, kText);
    if (face.prompt) {
        line(window, words.decide_soon, 0.70, 1.3, kAccent);
    }
    if (face.dead_man) {
        line(window, words.keep_down, 0.61, 1.15, kText);
    }
    line(window, face.dead_man ? words.enter_when_known : words.space_when_known, 0.84, 1.3,
         face.may_finish ? kAccent : kQuiet);
}

void draw(Window& window, const ChooseFace& face) {
    const Words& words = window.words();
    line(window, words.which, 0.13, 1.9, kText);
    draw_pictures(window, lay_out_cards(face.pictures.size(), window.size()), face.pictures,
                  face.selected);
    line(window,
         face.watched ? std::string(words.observer_chooses)
                      : with(words.choose, face.pictures.size()),
         0.88, 1.0, kQuiet);
}

void draw(Window& window, const BreakFace& face) {
    const Words& words = window.words();
    line(window, words.rest, 0.36, 2.2, kText);
    line(window, words.let_go, 0.48, 1.15, kText);
    line(window, with(words.next_trial, face.next, face.total), 0.58, 1.0, kQuiet);
    if (face.seconds_left > 0) {
        line(window, with(words.wait, face.seconds_left), 0.84, 1.3, kQuiet);
    } else {
        line(window, words.go_on, 0.84, 1.3, kAccent);
    }
}

void draw(Window& window, const TroubleFace& face) {
    constexpr double kSmall = 0.75;
    constexpr double kLine = 0.035;  // of the window's height
    const Words& words = window.words();
    const double width = 0.8 * window.size().x;
    line(window, face.solved ? words.can_go_on : words.moment, 0.36, 2.2, kText);
    line(window, face.solved ? words.thank_you_for_waiting : words.help_comes, 0.48, 1.15, kText);
    if (face.solved) {
        line(window, words.go_on, 0.84, 1.3, kAccent);
    }
    double y = 0.62;
    for (const std::string& row :
         wrapped(window, std::string(words.for_experimenter) + face.sentence, kSmall, width)) {
        line(window, row, y, kSmall, kQuiet);
        y += kLine;
    }
}

void draw(Window& /*window*/, const GapFace& /*face*/) {}

void draw(Window& window, const EndFace& /*face*/) {
    line(window, window.words().end, 0.42, 2.2, kText);
    line(window, window.words().tell_experimenter, 0.84, 1.15, kQuiet);
}

void draw_watermark(Window& window, const std::string& text) {
    const Vec2 size = window.size();
    const double type = type_size(size);
    window.text(text, {size.x - type, 1.2 * type}, 0.8 * type, kQuiet, Align::right);
}

void draw_stop_question(Window& window) {
    const Vec2 size = window.size();
    const double type = type_size(size);
    window.triangles(rectangle({0.0, size.y - 2.6 * type}, {size.x, 2.6 * type}), kAccent);
    window.text(window.words().stop_question, {0.5 * size.x, size.y - 1.3 * type}, type,
                kBackground);
}

}  // namespace palpate::ui

#include "ui/subject/faces.hpp"

#include <sstream>
#include <vector>

#include <fmt/format.h>

#include "ui/subject/stroke.hpp"
#include "ui/subject/style.hpp"

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

void trial_number(Window& window, std::size_t number, std::size_t total, bool practice) {
    line(window, fmt::format("{}{} of {}", practice ? "Practice: trial " : "Trial ", number, total),
         0.10, 1.0, kQuiet);
}

}  // namespace

void draw(Window& window, const WelcomeFace& face) {
    line(window, face.resumed ? "Welcome back" : "Welcome", 0.18, 2.2, kText);
    line(window, "You will feel objects that you cannot see.", 0.34, 1.15, kText);
    line(window, "After each one, say which of the pictures it was.", 0.41, 1.15, kText);
    if (face.moves_pointer) {
        line(window, "The pointer is the handle; it stays hidden while you feel.", 0.48, 1.15,
             kText);
    }
    line(window, "Take the time you need.", 0.55, 1.15, kText);
    line(window,
         fmt::format("{}{} trials, with breaks.", face.resumed ? "The session goes on. " : "",
                     face.trials),
         0.66, 1.0, kQuiet);
    line(window, "Press Space to begin", 0.84, 1.3, kAccent);
}

void draw(Window& window, const ReadyFace& face) {
    trial_number(window, face.number, face.total, face.practice);
    line(window, "Ready?", 0.42, 2.4, kText);
    line(window, "Hold the handle. It starts above the tip of the object.", 0.54, 1.15, kText);
    line(window,
         face.dead_man ? "Hold Space down as long as you feel the object"
                       : "Press Space to feel the object",
         0.84, 1.3, kAccent);
}

void draw(Window& window, const ExploreFace& face) {
    trial_number(window, face.number, face.total, face.practice);
    line(window, "Feel the object", 0.42, 2.4, kText);
    line(window, "Go along both sides, as often as you like.", 0.54, 1.15, kText);
    if (face.prompt) {
        line(window, "Please decide soon", 0.70, 1.3, kAccent);
    }
    if (face.dead_man) {
        line(window, "Keep Space down; without it there is no force.", 0.61, 1.15, kText);
    }
    line(window,
         face.dead_man ? "Press Enter when you know its shape"
                       : "Press Space when you know its shape",
         0.84, 1.3, face.may_finish ? kAccent : kQuiet);
}

void draw(Window& window, const ChooseFace& face) {
    line(window, "Which one was it?", 0.13, 1.9, kText);
    draw_pictures(window, lay_out_cards(face.pictures.size(), window.size()), face.pictures,
                  face.selected);
    if (face.watched) {
        line(window, "The simulated observer is choosing", 0.88, 1.0, kQuiet);
    } else {
        line(window,
             fmt::format("Press 1 to {}, or click a picture, or use the arrows and Enter",
                         face.pictures.size()),
             0.88, 1.0, kQuiet);
    }
}

void draw(Window& window, const BreakFace& face) {
    line(window, "Time for a break", 0.36, 2.2, kText);
    line(window, "Let go of the handle and rest your hand.", 0.48, 1.15, kText);
    line(window, fmt::format("Next: trial {} of {}", face.next, face.total), 0.58, 1.0, kQuiet);
    if (face.seconds_left > 0) {
        line(window, fmt::format("You can go on in {} s", face.seconds_left), 0.84, 1.3, kQuiet);
    } else {
        line(window, "Press Space to go on", 0.84, 1.3, kAccent);
    }
}

void draw(Window& window, const TroubleFace& face) {
    constexpr double kSmall = 0.75;
    constexpr double kLine = 0.035;  // of the window's height
    const double width = 0.8 * window.size().x;
    line(window, face.solved ? "We can go on" : "One moment, please", 0.36, 2.2, kText);
    line(window, face.solved ? "Thank you for waiting." : "The experimenter will help.", 0.48, 1.15,
         kText);
    if (face.solved) {
        line(window, "Press Space to go on", 0.84, 1.3, kAccent);
    }
    double y = 0.62;
    for (const std::string& row :
         wrapped(window, "For the experimenter: " + face.sentence, kSmall, width)) {
        line(window, row, y, kSmall, kQuiet);
        y += kLine;
    }
}

void draw(Window& /*window*/, const GapFace& /*face*/) {}

void draw(Window& window, const EndFace& /*face*/) {
    line(window, "That was all. Thank you!", 0.42, 2.2, kText);
    line(window, "Please tell the experimenter. Space closes this window.", 0.84, 1.15, kQuiet);
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
    window.text("Experimenter: press Y to stop the session, any other key to go on",
                {0.5 * size.x, size.y - 1.3 * type}, type, kBackground);
}

}  // namespace palpate::ui

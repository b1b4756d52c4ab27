#include "ui/subject/faces.hpp"

#include <fmt/format.h>

#include "ui/subject/answer_row.hpp"
#include "ui/subject/paragraph.hpp"
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

/// `text` wrapped into the window's middle 84 % between two shares of its height.
void block(Window& window,
           std::string_view text,
           double top,
           double bottom,
           double height,
           Colour colour) {
    const Vec2 size = window.size();
    write_into(window, text, {at(window, 0.08, top), {0.84 * size.x, (bottom - top) * size.y}},
               height * type_size(size), colour);
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

/// Which of the two of a trial; nothing where there is but one.
void interval_number(Window& window, std::size_t interval, std::size_t intervals) {
    if (intervals == 2) {
        line(window, interval == 1 ? window.words().first_of_two : window.words().second_of_two,
             0.24, 1.6, kAccent);
    }
}

}  // namespace

void draw(Window& window, const WelcomeFace& face) {
    const Words& words = window.words();
    const std::string& instruction = window.instructions().welcome;
    line(window, face.resumed ? words.welcome_back : words.welcome, 0.18, 2.2, kText);
    if (!instruction.empty()) {
        block(window, instruction, 0.26, face.moves_pointer ? 0.56 : 0.62, 1.15, kText);
    } else {
        const bool two = face.asks == protocols::ResponseKind::two_interval;
        const bool shape = face.asks == protocols::ResponseKind::identification;
        line(window, two ? words.you_feel_two : words.you_feel, 0.34, 1.15, kText);
        line(window,
             two     ? words.which_of_both
             : shape ? words.you_choose
                     : words.a_question,
             0.41, 1.15, kText);
        line(window, words.take_time, face.moves_pointer ? 0.55 : 0.48, 1.15, kText);
    }
    if (face.moves_pointer) {
        line(window, words.pointer_is_handle, instruction.empty() ? 0.48 : 0.60, 1.15, kText);
    }
    line(window,
         with(face.trials == 1 ? words.one_trial
              : face.resumed   ? words.trials_resumed
                               : words.trials,
              face.trials),
         0.66, 1.0, kQuiet);
    line(window, words.begin, 0.84, 1.3, kAccent);
}

void draw(Window& window, const ReadyFace& face) {
    const Words& words = window.words();
    const std::string& instruction = window.instructions().ready;
    trial_number(window, face.number, face.total, face.practice);
    interval_number(window, face.interval, face.intervals);
    line(window, words.ready, 0.42, 2.4, kText);
    if (instruction.empty()) {
        line(window, words.hold_handle, 0.54, 1.15, kText);
    } else {
        block(window, instruction, 0.50, 0.78, 1.15, kText);
    }
    line(window, face.dead_man ? words.hold_to_feel : words.press_to_feel, 0.84, 1.3, kAccent);
}

void draw(Window& window, const ExploreFace& face) {
    const Words& words = window.words();
    trial_number(window, face.number, face.total, face.practice);
    interval_number(window, face.interval, face.intervals);
    line(window, words.feel, 0.42, 2.4, kText);
    line(window, words.both_sides, 0.54, 1.15, kText);
    if (face.prompt) {
        line(window, words.decide_soon, 0.70, 1.3, kAccent);
    }
    if (face.dead_man) {
        line(window, words.keep_down, 0.61, 1.15, kText);
    }
    const std::string_view by_space =
        face.asks_shape ? words.space_when_known : words.space_when_felt;
    const std::string_view by_enter =
        face.asks_shape ? words.enter_when_known : words.enter_when_felt;
    line(window, face.dead_man ? by_enter : by_space, 0.84, 1.3,
         face.may_finish ? kAccent : kQuiet);
}

void draw(Window& window, const ChooseFace& face) {
    using protocols::ResponseKind;
    const Words& words = window.words();
    const protocols::Question& question = face.question;
    const ResponseKind kind = question.kind;
    const std::string& instruction = window.instructions().choose;
    block(window,
          !instruction.empty()                 ? std::string_view(instruction)
          : !question.text.empty()             ? std::string_view(question.text)
          : kind == ResponseKind::two_interval ? words.first_or_second
                                               : words.which,
          0.04, 0.24, 1.9, kText);
    draw_answers(window, question, face.selected);
    const std::string_view keys = kind == ResponseKind::identification ? words.choose
                                : kind == ResponseKind::rating         ? words.choose_level
                                                                       : words.choose_of_two;
    line(window, face.watched ? std::string(words.observer_chooses) : with(keys, question.answers),
         0.88, 1.0, kQuiet);
}

void draw(Window& window, const ConfidenceFace& face) {
    constexpr auto kLevels = static_cast<std::size_t>(protocols::kMostConfidence);
    const Words& words = window.words();
    line(window, words.how_sure, 0.14, 1.9, kText);
    draw_scale(window, kLevels, std::string(words.a_guess), std::string(words.certain),
               face.selected);
    line(window, with(words.choose_level, kLevels), 0.88, 1.0, kQuiet);
}

void draw(Window& window, const FeedbackFace& face) {
    line(window, face.right ? window.words().right : window.words().wrong, 0.42, 2.4,
         face.right ? kAccent : kText);
}

void draw(Window& window, const BreakFace& face) {
    const Words& words = window.words();
    const std::string& instruction = window.instructions().rest;
    if (instruction.empty()) {
        line(window, words.rest, 0.36, 2.2, kText);
        line(window, words.let_go, 0.48, 1.15, kText);
        line(window, with(words.next_trial, face.next, face.total), 0.58, 1.0, kQuiet);
    } else {
        line(window, words.rest, 0.20, 2.2, kText);
        block(window, instruction, 0.28, 0.64, 1.15, kText);
        line(window, with(words.next_trial, face.next, face.total), 0.70, 1.0, kQuiet);
    }
    if (face.seconds_left > 0) {
        line(window, with(words.wait, face.seconds_left), 0.84, 1.3, kQuiet);
    } else {
        line(window, words.go_on, 0.84, 1.3, kAccent);
    }
}

void draw(Window& window, const TroubleFace& face) {
    constexpr double kSmall = 0.75;
    const Words& words = window.words();
    const double type = kSmall * type_size(window.size());
    const bool participant = face.solved && !face.by_chord;
    line(window, participant ? words.can_go_on : words.moment, 0.36, 2.2, kText);
    line(window, participant ? words.thank_you_for_waiting : words.help_comes, 0.48, 1.15, kText);
    if (face.solved && face.by_chord) {
        line(window, words.end_of_pause, 0.88, 0.75, kQuiet);
    } else if (participant) {
        line(window, words.go_on, 0.84, 1.3, kAccent);
    }
    double y = 0.62 * window.size().y;
    for (const std::string& row :
         wrapped(window, std::string(words.for_experimenter) + face.sentence, type,
                 0.8 * window.size().x)) {
        window.text(row, {0.5 * window.size().x, y}, type, kQuiet);
        y += kLeading * type;
    }
}

void draw(Window& window, const PauseFace& /*face*/) {
    const Words& words = window.words();
    line(window, words.pause, 0.36, 2.2, kText);
    line(window, words.please_wait, 0.48, 1.15, kText);
    line(window, words.end_of_pause, 0.88, 0.75, kQuiet);
}

void draw(Window& /*window*/, const GapFace& /*face*/) {}

void draw(Window& window, const EndFace& /*face*/) {
    const std::string& instruction = window.instructions().end;
    if (instruction.empty()) {
        line(window, window.words().end, 0.42, 2.2, kText);
    } else {
        block(window, instruction, 0.22, 0.72, 1.6, kText);
    }
    line(window, window.words().tell_experimenter, 0.84, 1.15, kQuiet);
}

void draw_watermark(Window& window, const std::string& text) {
    const Vec2 size = window.size();
    const double type = type_size(size);
    window.text(text, {size.x - type, 1.2 * type}, 0.8 * type, kQuiet, Align::right);
}

void draw_bar(Window& window, std::string_view sentence) {
    const Vec2 size = window.size();
    const double type = type_size(size);
    window.triangles(rectangle({0.0, size.y - 2.6 * type}, {size.x, 2.6 * type}), kAccent);
    window.text(sentence, {0.5 * size.x, size.y - 1.3 * type}, type, kBackground);
}

}  // namespace palpate::ui

#include "ui/subject/faces.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "engine/math/elementary.hpp"
#include "ui/subject/answer_row.hpp"
#include "ui/subject/paragraph.hpp"
#include "ui/subject/stroke.hpp"
#include "ui/subject/words.hpp"

namespace palpate::ui {
namespace {

using engine::Vec2;

/// `text` wrapped into the window's middle 92 % between two shares of its height, in smaller type
/// where it would not fit. Bands of one face never overlap, so neither does what stands in them.
void band(Window& window,
          std::string_view text,
          double top,
          double bottom,
          double height,
          Colour colour) {
    const Vec2 size = window.size();
    write_into(window, text,
               {{0.04 * size.x, top * size.y}, {0.92 * size.x, (bottom - top) * size.y}},
               height * type_size(size), colour);
}

/// A heading, and below it what the protocol or the screen says, down to `bottom`. Where that is
/// long it takes what is free above from `free` on, and the heading goes up.
void headed(Window& window,
            std::string_view heading,
            std::string_view text,
            double free,
            double top,
            double bottom) {
    constexpr double kHeading = 0.11;
    constexpr double kLowHeading = 0.06;
    constexpr double kType = 1.15;
    const Vec2 size = window.size();
    const double type = kType * type_size(size);
    const double rows = static_cast<double>(wrapped(window, text, type, 0.92 * size.x).size());
    const double from = std::clamp(bottom - rows * kLeading * type / size.y,
                                   free + kLowHeading + 0.01, top + kHeading + 0.01);
    const double end = from - 0.01;
    band(window, heading, std::max(free, end - kHeading), end, 2.4, kText);
    band(window, text, from, bottom, kType, kText);
}

/// What to press, at the same place on every face, above the bar.
void press(Window& window, std::string_view text, Colour colour) {
    band(window, text, 0.78, 0.88, 1.3, colour);
}

std::vector<Vec2> circle(const Vec2& middle, double radius) {
    constexpr int kCorners = 48;
    std::vector<Vec2> points;
    for (int i = 0; i < kCorners; ++i) {
        const double angle = 2.0 * engine::kPi * i / kCorners;
        points.push_back(middle + radius * Vec2{std::cos(angle), std::sin(angle)});
    }
    return points;
}

/// A sentence with its numbers.
template <class... Numbers>
std::string with(std::string_view sentence, const Numbers&... numbers) {
    return fmt::format(fmt::runtime(sentence), numbers...);
}

/// The trial's number, and which of its two intervals it is; nothing of that where there is but
/// one.
void trial_number(Window& window, const protocols::TrialView& trial) {
    const Words& words = window.words();
    band(window,
         with(trial.practice ? words.practice_trial : words.trial, trial.number, trial.total), 0.07,
         0.13, 1.0, kQuiet);
    if (trial.intervals == 2) {
        band(window, trial.interval == 1 ? words.first_of_two : words.second_of_two, 0.17, 0.28,
             1.6, kAccent);
    }
}

/// Where nothing stands below both, as a share of the height.
double free_from(std::size_t intervals) {
    return intervals == 2 ? 0.28 : 0.14;
}

/// The protocol's sentence, or the screen's own.
std::string_view either(const std::string& instruction, std::string_view own) {
    return instruction.empty() ? own : std::string_view(instruction);
}

/// What a session of such questions is about, where the protocol does not say it.
std::string about(const Words& words, protocols::ResponseKind asks) {
    const bool two = asks == protocols::ResponseKind::two_interval;
    const bool shape = asks == protocols::ResponseKind::identification;
    return fmt::format("{}\n{}\n\n{}", two ? words.you_feel_two : words.you_feel,
                       two     ? words.which_of_both
                       : shape ? words.you_choose
                               : words.a_question,
                       words.take_time);
}

/// A ring for the start and a dot for the handle in a frame that is kReach around it; a handle
/// farther away is at the edge. Height stands beside it, by itself.
void draw_start(Window& window, const StartMark& mark) {
    constexpr double kReach = 0.040;  // m
    const Vec2 size = window.size();
    const double half = 0.105 * size.y;
    const double scale = half / kReach;
    const double line = std::max(2.0, 0.06 * type_size(size));
    const double dot = 0.28 * type_size(size);
    const double ring = std::max(scale * mark.radius, dot + 2.0 * line);
    const Vec2 middle{0.5 * size.x, 0.66 * size.y};
    const Vec2 corner = middle - Vec2{1.4 * half, 1.2 * half};
    const auto edge = [&](double d) {
        return std::clamp(scale * d, -half, half);
    };
    const Colour colour = mark.open ? kAccent : kText;
    window.fine(corner, Vec2{3.4 * half, 2.4 * half}, [&] {
        window.triangles(stroke(circle(middle, ring), line), kQuiet);
        window.triangles(fill(circle(middle + Vec2{edge(mark.away.x), -edge(mark.away.y)}, dot)),
                         colour);
        if (mark.in_space) {
            const Vec2 beside = middle + Vec2{1.6 * half, 0.0};
            window.triangles(rectangle(beside - Vec2{ring, 0.5 * line}, Vec2{2.0 * ring, line}),
                             kQuiet);
            window.triangles(fill(circle(beside - Vec2{0.0, edge(mark.away.z)}, dot)), colour);
        }
    });
}

/// What keeps the trial from beginning.
std::string_view bring(const Words& words, const StartMark& mark) {
    const bool in_ring = mark.in_space && glm::length(Vec2(mark.away)) <= mark.radius;
    return mark.inside ? words.bring_out : in_ring ? words.bring_to_height : words.bring_to_start;
}

}  // namespace

ExploreFace explore_face(const protocols::TrialView& trial,
                         double elapsed_s,
                         protocols::ResponseKind asks,
                         bool dead_man) {
    return {.trial = trial,
            .may_finish = elapsed_s >= trial.explore_min_s,
            .prompt = elapsed_s >= trial.explore_prompt_s,
            .dead_man = dead_man,
            .asks_shape = asks == protocols::ResponseKind::identification};
}

void draw(Window& window, const WelcomeFace& face) {
    const Words& words = window.words();
    const std::string& instruction = window.instructions().welcome;
    band(window, face.resumed ? words.welcome_back : words.welcome, 0.10, 0.23, 2.2, kText);
    band(window, instruction.empty() ? about(words, face.asks) : instruction, 0.25,
         face.moves_pointer ? 0.55 : 0.63, 1.15, kText);
    if (face.moves_pointer) {
        band(window, words.pointer_is_handle, 0.56, 0.64, 1.15, kText);
    }
    const std::string count =
        face.practice > 0 ? with(words.practice_first, face.practice, face.trials)
                          : with(face.trials == 1 ? words.one_trial : words.trials, face.trials);
    band(window,
         (face.resumed ? std::string(words.goes_on) + ' ' : "") + count +
             (face.breaks ? ' ' + std::string(words.breaks) : ""),
         0.66, 0.74, 1.0, kQuiet);
    press(window, words.begin, kAccent);
}

void draw(Window& window, const ReadyFace& face) {
    const Words& words = window.words();
    trial_number(window, face.trial);
    headed(window, words.ready, either(window.instructions().ready, words.hold_handle),
           free_from(face.trial.intervals), face.start ? 0.29 : 0.335, face.start ? 0.54 : 0.76);
    if (face.start) {
        draw_start(window, *face.start);
    }
    if (face.start && !face.start->open) {
        press(window, bring(words, *face.start), face.start->refused ? kAccent : kText);
    } else {
        press(window, face.dead_man ? words.hold_to_feel : words.press_to_feel, kAccent);
    }
}

void draw(Window& window, const ExploreFace& face) {
    const Words& words = window.words();
    trial_number(window, face.trial);
    headed(window, words.feel, either(window.instructions().explore, words.along_surface),
           free_from(face.trial.intervals), 0.31, 0.62);
    if (face.dead_man) {
        band(window, words.keep_down, 0.62, 0.69, 1.15, kText);
    }
    if (face.prompt) {
        band(window, words.decide_soon, 0.70, 0.77, 1.3, kAccent);
    }
    const std::string_view by_space =
        face.asks_shape ? words.space_when_known : words.space_when_felt;
    const std::string_view by_enter =
        face.asks_shape ? words.enter_when_known : words.enter_when_felt;
    press(window, face.dead_man ? by_enter : by_space, face.may_finish ? kAccent : kQuiet);
}

void draw(Window& window, const ChooseFace& face) {
    using protocols::ResponseKind;
    const Words& words = window.words();
    const protocols::Question& question = face.question;
    const ResponseKind kind = question.kind;
    const std::string_view own =
        kind == ResponseKind::two_interval ? words.first_or_second : words.which;
    band(window, either(window.instructions().choose, either(question.text, own)), 0.07, 0.25, 1.9,
         kText);
    draw_answers(window, question, face.selected);
    const std::string_view keys = question.answers == 2                ? words.choose_of_two
                                : kind == ResponseKind::identification ? words.choose
                                                                       : words.choose_level;
    const bool in_space = !question.pictures.empty() && !question.pictures.front().walls.empty();
    band(window,
         (in_space ? std::string(words.seen_from_above) + '\n' : std::string()) +
             (face.watched                        ? std::string(words.observer_chooses)
              : face.selected && question.confirm ? std::string(words.confirm)
                                                  : with(keys, question.answers)),
         in_space ? 0.77 : 0.80, 0.88, 1.0, kQuiet);
}

void draw(Window& window, const ConfidenceFace& face) {
    constexpr auto kLevels = static_cast<std::size_t>(protocols::kMaxConfidence);
    const Words& words = window.words();
    band(window, words.how_sure, 0.07, 0.25, 1.9, kText);
    draw_scale(window, kLevels, std::string(words.a_guess), std::string(words.certain),
               face.selected);
    band(window,
         face.selected && face.confirm ? std::string(words.confirm)
                                       : with(words.choose_level, kLevels),
         0.80, 0.88, 1.0, kQuiet);
}

void draw(Window& window, const FeedbackFace& face) {
    band(window, face.right ? window.words().right : window.words().wrong, 0.32, 0.52, 2.4,
         face.right ? kAccent : kText);
}

void draw(Window& window, const BreakFace& face) {
    const Words& words = window.words();
    band(window, words.rest, 0.14, 0.27, 2.2, kText);
    band(window, either(window.instructions().rest, words.let_go), 0.29, 0.64, 1.15, kText);
    band(window,
         with(face.next.practice ? words.next_practice : words.next_trial, face.next.number,
              face.next.total),
         0.66, 0.74, 1.0, kQuiet);
    if (face.seconds_left > 0) {
        press(window, with(words.wait, face.seconds_left), kQuiet);
    } else {
        press(window, face.awaits_handle ? words.home_first : words.go_on, kAccent);
    }
}

void draw(Window& window, const TroubleFace& face) {
    const Words& words = window.words();
    const bool participant = face.solved && !face.by_chord;
    band(window, participant ? words.can_go_on : words.moment, 0.14, 0.27, 2.2, kText);
    band(window, participant ? words.thank_you_for_waiting : words.help_comes, 0.28, 0.37, 1.15,
         kText);
    band(window,
         std::string(words.for_experimenter) +
             std::string(trip_in(window.language(), face.sentence)),
         0.42, 0.74, kFromAfar, kText);
    if (face.solved) {
        press(window, face.by_chord ? words.end_of_pause : words.go_on, kAccent);
    }
}

void draw(Window& window, const PauseFace& /*face*/) {
    const Words& words = window.words();
    band(window, words.pause, 0.28, 0.41, 2.2, kText);
    band(window, words.please_wait, 0.43, 0.54, 1.15, kText);
    press(window, words.end_of_pause, kQuiet);
}

void draw(Window& /*window*/, const GapFace& /*face*/) {}

void draw(Window& window, const EndFace& /*face*/) {
    const std::string& instruction = window.instructions().end;
    if (instruction.empty()) {
        band(window, window.words().end, 0.32, 0.52, 2.2, kText);
    } else {
        band(window, instruction, 0.14, 0.74, 1.6, kText);
    }
    press(window, window.words().tell_experimenter, kQuiet);
}

void draw_watermark(Window& window, const std::string& text) {
    const Vec2 size = window.size();
    const double type = type_size(size);
    window.text(text, {size.x - type, 1.2 * type}, 0.8 * type, kQuiet, Align::right);
}

void draw_bar(Window& window, std::string_view sentence) {
    const Vec2 size = window.size();
    const Vec2 corner{0.0, kBarTop * size.y};
    window.triangles(rectangle(corner, size - corner), kAccent);
    write_into(window, sentence,
               {corner + Vec2{0.02 * size.x, 0.0}, {0.96 * size.x, size.y - corner.y}},
               kFromAfar * type_size(size), kBackground);
}

}  // namespace palpate::ui

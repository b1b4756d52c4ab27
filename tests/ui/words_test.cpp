#include <cstdlib>
#include <string>

#include <fmt/format.h>

#include "ui/subject/style.hpp"
#include "ui/subject/window.hpp"
#include "ui/subject/words.hpp"
#include "tests/support/catch.hpp"

using namespace palpate;
using protocols::Language;
using ui::Words;

namespace {

struct Row {
    std::string_view Words::*sentence;
    int numbers;    ///< that it has to say
    double height;  ///< of its type on the screen, as in faces.cpp
};

constexpr Row kRows[] = {
    {&Words::welcome, 0, 2.2},
    {&Words::welcome_back, 0, 2.2},
    {&Words::you_feel, 0, 1.15},
    {&Words::you_feel_two, 0, 1.15},
    {&Words::you_choose, 0, 1.15},
    {&Words::a_question, 0, 1.15},
    {&Words::which_of_both, 0, 1.15},
    {&Words::pointer_is_handle, 0, 1.15},
    {&Words::take_time, 0, 1.15},
    {&Words::one_trial, 0, 1.0},
    {&Words::trials, 1, 1.0},
    {&Words::trials_resumed, 1, 1.0},
    {&Words::begin, 0, 1.3},
    {&Words::trial, 2, 1.0},
    {&Words::practice_trial, 2, 1.0},
    {&Words::first_of_two, 0, 1.6},
    {&Words::second_of_two, 0, 1.6},
    {&Words::ready, 0, 2.4},
    {&Words::hold_handle, 0, 1.15},
    {&Words::press_to_feel, 0, 1.3},
    {&Words::hold_to_feel, 0, 1.3},
    {&Words::feel, 0, 2.4},
    {&Words::both_sides, 0, 1.15},
    {&Words::decide_soon, 0, 1.3},
    {&Words::keep_down, 0, 1.15},
    {&Words::space_when_known, 0, 1.3},
    {&Words::enter_when_known, 0, 1.3},
    {&Words::space_when_felt, 0, 1.3},
    {&Words::enter_when_felt, 0, 1.3},
    {&Words::which, 0, 1.9},
    {&Words::choose, 1, 1.0},
    {&Words::observer_chooses, 0, 1.0},
    {&Words::first_or_second, 0, 1.9},
    {&Words::first, 0, 1.9},
    {&Words::second, 0, 1.9},
    {&Words::no, 0, 1.9},
    {&Words::yes, 0, 1.9},
    {&Words::least, 0, 1.1},
    {&Words::most, 0, 1.1},
    {&Words::choose_of_two, 0, 1.0},
    {&Words::choose_level, 1, 1.0},
    {&Words::how_sure, 0, 1.9},
    {&Words::a_guess, 0, 1.1},
    {&Words::certain, 0, 1.1},
    {&Words::right, 0, 2.4},
    {&Words::wrong, 0, 2.4},
    {&Words::rest, 0, 2.2},
    {&Words::let_go, 0, 1.15},
    {&Words::next_trial, 2, 1.0},
    {&Words::wait, 1, 1.3},
    {&Words::go_on, 0, 1.3},
    {&Words::moment, 0, 2.2},
    {&Words::can_go_on, 0, 2.2},
    {&Words::help_comes, 0, 1.15},
    {&Words::thank_you_for_waiting, 0, 1.15},
    {&Words::for_experimenter, 0, 0.75},
    {&Words::end, 0, 2.2},
    {&Words::tell_experimenter, 0, 1.15},
    {&Words::stop_question, 0, 1.0},
    {&Words::mark_question, 0, 1.0},
    {&Words::pause_comes, 0, 1.0},
    {&Words::pause, 0, 2.2},
    {&Words::please_wait, 0, 1.15},
    {&Words::end_of_pause, 0, 0.75},
};
static_assert(std::size(kRows) * sizeof(std::string_view) == sizeof(Words), "a row each");

}  // namespace

TEST_CASE("every sentence of every language is there, says its numbers, and fits the screen",
          "[words][law]") {
    setenv("SDL_VIDEODRIVER", "dummy", 1);
    const Language language = GENERATE(Language::en, Language::tr);
    ui::Window window({.font = {}, .language = language});
    REQUIRE(&window.words() == &ui::words_in(language));
    for (const Row& row : kRows) {
        const std::string_view sentence = window.words().*row.sentence;
        const std::string text = fmt::format(fmt::runtime(sentence), 1997, 2000);
        CAPTURE(text);
        CHECK_FALSE(text.empty());
        CHECK((text.find("1997") != std::string::npos) == (row.numbers > 0));
        CHECK((text.find("2000") != std::string::npos) == (row.numbers > 1));
        CHECK(window.text_width(text, row.height * ui::type_size(window.size())) <
              0.95 * window.size().x);
    }
    CHECK(ui::words_in(Language::en).welcome != ui::words_in(Language::tr).welcome);
}

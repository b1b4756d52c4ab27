#include "engine/safety/trip.hpp"
#include "protocols/session/operator_desk.hpp"
#include "protocols/session/trouble.hpp"
#include "ui/subject/words.hpp"
#include "tests/support/catch.hpp"

using namespace palpate;
using protocols::Language;
using ui::Words;

namespace {

struct Row {
    std::string_view Words::*sentence;
    int numbers;  ///< that it has to say
};

constexpr Row kRows[] = {
    {&Words::welcome, 0},
    {&Words::welcome_back, 0},
    {&Words::you_feel, 0},
    {&Words::you_feel_two, 0},
    {&Words::you_choose, 0},
    {&Words::a_question, 0},
    {&Words::which_of_both, 0},
    {&Words::pointer_is_handle, 0},
    {&Words::take_time, 0},
    {&Words::one_trial, 0},
    {&Words::trials, 1},
    {&Words::trials_resumed, 1},
    {&Words::practice_first, 2},
    {&Words::practice_first_resumed, 2},
    {&Words::begin, 0},
    {&Words::trial, 2},
    {&Words::practice_trial, 2},
    {&Words::first_of_two, 0},
    {&Words::second_of_two, 0},
    {&Words::ready, 0},
    {&Words::hold_handle, 0},
    {&Words::press_to_feel, 0},
    {&Words::hold_to_feel, 0},
    {&Words::bring_to_start, 0},
    {&Words::bring_out, 0},
    {&Words::feel, 0},
    {&Words::along_surface, 0},
    {&Words::decide_soon, 0},
    {&Words::keep_down, 0},
    {&Words::space_when_known, 0},
    {&Words::enter_when_known, 0},
    {&Words::space_when_felt, 0},
    {&Words::enter_when_felt, 0},
    {&Words::which, 0},
    {&Words::choose, 1},
    {&Words::seen_from_above, 0},
    {&Words::observer_chooses, 0},
    {&Words::first_or_second, 0},
    {&Words::first, 0},
    {&Words::second, 0},
    {&Words::no, 0},
    {&Words::yes, 0},
    {&Words::least, 0},
    {&Words::most, 0},
    {&Words::choose_of_two, 0},
    {&Words::choose_level, 1},
    {&Words::confirm, 0},
    {&Words::how_sure, 0},
    {&Words::a_guess, 0},
    {&Words::certain, 0},
    {&Words::right, 0},
    {&Words::wrong, 0},
    {&Words::rest, 0},
    {&Words::let_go, 0},
    {&Words::home_first, 0},
    {&Words::next_trial, 2},
    {&Words::next_practice, 2},
    {&Words::wait, 1},
    {&Words::go_on, 0},
    {&Words::moment, 0},
    {&Words::can_go_on, 0},
    {&Words::help_comes, 0},
    {&Words::thank_you_for_waiting, 0},
    {&Words::for_experimenter, 0},
    {&Words::end, 0},
    {&Words::tell_experimenter, 0},
    {&Words::stop_question, 0},
    {&Words::mark_question, 0},
    {&Words::mark_last_question, 0},
    {&Words::pause_comes, 0},
    {&Words::no_pause, 0},
    {&Words::session_over, 0},
    {&Words::keyboard_elsewhere, 0},
    {&Words::marked, 2},
    {&Words::practice_marked, 2},
    {&Words::nothing_to_mark, 0},
    {&Words::runs_again, 0},
    {&Words::not_again, 0},
    {&Words::pause, 0},
    {&Words::please_wait, 0},
    {&Words::end_of_pause, 0},
};
static_assert(std::size(kRows) * sizeof(std::string_view) == sizeof(Words), "a row each");

}  // namespace

TEST_CASE("every sentence of every language is there and says its numbers", "[words][law]") {
    const Language language = GENERATE(Language::en, Language::tr);
    for (const Row& row : kRows) {
        const std::string_view sentence = ui::words_in(language).*row.sentence;
        const std::string text = fmt::format(fmt::runtime(sentence), 1997, 2000);
        CAPTURE(text);
        CHECK_FALSE(text.empty());
        CHECK((text.find("1997") != std::string::npos) == (row.numbers > 0));
        CHECK((text.find("2000") != std::string::npos) == (row.numbers > 1));
    }
    CHECK(ui::words_in(Language::en).welcome != ui::words_in(Language::tr).welcome);
}

TEST_CASE("what a trip says is said in the screen's language, and other sentences as they are",
          "[words][law]") {
    for (int i = 1; i <= static_cast<int>(engine::Trip::stopped); ++i) {
        const std::string_view english = explanation(static_cast<engine::Trip>(i));
        const std::string_view turkish = ui::trip_in(Language::tr, english);
        CAPTURE(english, turkish);
        CHECK(ui::trip_in(Language::en, english) == english);
        CHECK(turkish != english);
        CHECK(turkish.find(": ") != std::string_view::npos);  // what happened, and what to do
        for (const std::string_view as_it_is :
             {"stiffness_n_per_m", "rate_hz", "explore_timeout_s", "palpate doctor"}) {
            const bool said = english.find(as_it_is) != std::string_view::npos;
            CHECK((!said || turkish.find(as_it_is) != std::string_view::npos));
        }
        for (int k = 1; k < i; ++k) {
            CHECK(turkish != ui::trip_in(Language::tr, explanation(static_cast<engine::Trip>(k))));
        }
    }
    for (const char* rig : {protocols::kAnother, protocols::kNotProved, protocols::kProofComes,
                            protocols::kButtonGone, protocols::kButtonDown}) {
        CHECK(ui::trip_in(Language::tr, rig) != rig);
        CHECK(ui::trip_in(Language::en, rig) == rig);
    }
    CHECK(ui::trip_in(Language::tr, "the board at /dev/one is gone") ==
          "the board at /dev/one is gone");
}

TEST_CASE("no sentence of the participant's screen gives away the experimenter's chords",
          "[words][law]") {
    const Language language = GENERATE(Language::en, Language::tr);
    std::vector<std::string_view> sentences;
    for (const Row& row : kRows) {
        sentences.push_back(ui::words_in(language).*row.sentence);
    }
    for (int i = 1; i <= static_cast<int>(engine::Trip::stopped); ++i) {
        sentences.push_back(ui::trip_in(language, explanation(static_cast<engine::Trip>(i))));
    }
    for (const std::string_view sentence : sentences) {
        CAPTURE(sentence);
        for (const std::string_view key : {"Ctrl", "Shift", "ctrl", "shift"}) {
            CHECK(sentence.find(key) == std::string_view::npos);
        }
    }
    CHECK(ui::words_in(language).end_of_pause.find("terminal") != std::string_view::npos);
}

#include "protocols/session/trouble.hpp"
#include "ui/subject/words.hpp"
#include "tests/support/catch.hpp"

using protocols::Language;
using ui::Words;

namespace {

/// Those that say numbers, and how many.
constexpr std::pair<std::string_view Words::*, int> kNumbers[] = {
    {&Words::trials, 1},
    {&Words::trials_resumed, 1},
    {&Words::practice_first, 2},
    {&Words::practice_first_resumed, 2},
    {&Words::trial, 2},
    {&Words::practice_trial, 2},
    {&Words::choose, 1},
    {&Words::choose_level, 1},
    {&Words::next_trial, 2},
    {&Words::next_practice, 2},
    {&Words::wait, 1},
    {&Words::marked, 2},
    {&Words::practice_marked, 2},
};

/// Every sentence: the words are nothing else.
auto sentences_of(const Words& words) {
    return std::bit_cast<std::array<std::string_view, sizeof(Words) / sizeof(std::string_view)>>(
        words);
}

}  // namespace

TEST_CASE("every sentence of every language is there and says its numbers", "[words][law]") {
    const Language language = GENERATE(Language::en, Language::tr);
    const Words& words = ui::words_in(language);
    for (const std::string_view sentence : sentences_of(words)) {
        const auto* row = std::ranges::find_if(kNumbers, [&](const auto& one) {
            return (words.*one.first).data() == sentence.data();
        });
        const int numbers = row == std::end(kNumbers) ? 0 : row->second;
        const std::string text = fmt::format(fmt::runtime(sentence), 1997, 2000);
        CAPTURE(text);
        CHECK_FALSE(text.empty());
        CHECK((text.find("1997") != std::string::npos) == (numbers > 0));
        CHECK((text.find("2000") != std::string::npos) == (numbers > 1));
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
    const auto words = sentences_of(ui::words_in(language));
    std::vector<std::string_view> sentences(words.begin(), words.end());
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

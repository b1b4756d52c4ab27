#pragma once

#include <string_view>

#include "protocols/protocol/protocol.hpp"

/// Every sentence of the subject's screen, in each language that a protocol may ask for.
namespace palpate::ui {

/// {0} and {1} stand for numbers.
struct Words {
    std::string_view welcome, welcome_back;
    std::string_view you_feel, you_feel_two, you_choose, a_question, which_of_both,
        pointer_is_handle, take_time;
    std::string_view one_trial, goes_on, trials;  ///< {0} trials
    std::string_view practice_first, breaks;      ///< {0} for practice, then {1}
    std::string_view begin;
    std::string_view trial, practice_trial;  ///< {0} of {1}
    std::string_view first_of_two, second_of_two;
    std::string_view ready, hold_handle, press_to_feel, hold_to_feel, bring_to_start,
        bring_to_height, bring_out;  ///< where the ring reaches into an object
    std::string_view feel, along_surface, decide_soon, keep_down, space_when_known,
        enter_when_known;
    std::string_view space_when_felt, enter_when_felt;
    std::string_view which, choose, seen_from_above, observer_chooses;  ///< choose: keys 1 to {0}
    std::string_view first_or_second, first, second, no, yes, least, most;
    std::string_view choose_of_two, choose_level;  ///< level: keys 1 to {0}
    std::string_view confirm;                      ///< once an answer is marked that may be changed
    std::string_view how_sure, a_guess, certain;
    std::string_view right, wrong;
    std::string_view rest, let_go, home_first, next_trial, next_practice;  ///< next: {0} of {1}
    std::string_view wait, go_on;                                          ///< wait: {0} s
    std::string_view moment, can_go_on, help_comes, thank_you_for_waiting, for_experimenter;
    std::string_view end, tell_experimenter;
    std::string_view stop_question, mark_question, mark_last_question, pause_comes, no_pause,
        session_over;
    std::string_view keyboard_elsewhere;
    /// Of a mark: {0} of {1}; and what becomes of the trial.
    std::string_view marked, practice_marked, nothing_to_mark, runs_again, not_again;
    std::string_view pause, please_wait, end_of_pause;
};

/// All words of the screens; static.
[[nodiscard]] const Words& words_in(protocols::Language language) noexcept;

/// What a trip says, in another language: of engine::explanation(), and what a session says of its
/// rig. Any other sentence, as those of devices, comes back as it is.
[[nodiscard]] std::string_view trip_in(protocols::Language language,
                                       std::string_view sentence) noexcept;

}  // namespace palpate::ui

#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "protocols/trial/observer.hpp"
#include "ui/subject/window.hpp"

/// What each screen looks like: pure functions from a few values to pixels. Each has a name, which
/// stands in the window's title for lists of windows and for whoever cannot see the screen; it
/// tells nothing of the condition.
namespace palpate::ui {

/// Not the study's title: it may tell a participant what is being compared.
struct WelcomeFace {
    static constexpr std::string_view kName = "welcome";
    std::size_t trials = 0;    ///< main and catch trials that are left
    std::size_t practice = 0;  ///< practice trials that are left
    bool resumed = false;
    bool breaks = false;         ///< there are some among them
    bool moves_pointer = false;  ///< the mouse is the handle
    protocols::ResponseKind asks = protocols::ResponseKind::identification;
};

/// Where the handle is, seen from the start. It knows the study, and nothing of the trial that
/// comes.
struct StartMark {
    engine::Vec3 away{};    ///< m, of the handle from the start
    double radius = 0.0;    ///< m, of the ring
    bool in_space = false;  ///< z is shown as well
    bool open = true;       ///< the trial may begin
    bool inside = false;    ///< of an object of the study, although it is in the ring
    bool refused = false;   ///< somebody wanted to begin before
};

/// Before an interval: the participant begins it.
struct ReadyFace {
    static constexpr std::string_view kName = "ready";
    protocols::TrialView trial{};
    bool dead_man = false;             ///< Space has to be held
    std::optional<StartMark> start{};  ///< none: nobody brings a handle there
};

/// All that the screen may depend on while an object is felt. Nothing of the condition is here, so
/// nothing of it can be seen.
struct ExploreFace {
    static constexpr std::string_view kName = "explore";
    protocols::TrialView trial{};
    bool may_finish = false;  ///< the least exploration time has passed
    bool prompt = false;      ///< time to decide
    bool dead_man = false;    ///< Space is held, Enter is done
    bool asks_shape = true;   ///< pictures will come; the same for all trials of a session

    friend bool operator==(const ExploreFace&, const ExploreFace&) = default;
};

/// Of a trial that is felt since `elapsed_s`. @param asks  what comes after it
[[nodiscard]] ExploreFace explore_face(const protocols::TrialView& trial,
                                       double elapsed_s,
                                       protocols::ResponseKind asks,
                                       bool dead_man = false);

/// The question with its answers, which are the same for every trial of a session.
struct ChooseFace {
    static constexpr std::string_view kName = "question";
    protocols::Question question;  ///< its pictures outlive the face
    std::optional<std::size_t> selected;
    bool watched = false;  ///< a simulated observer chooses, people only look on
};

/// After the answer: how sure, 1 to 4.
struct ConfidenceFace {
    static constexpr std::string_view kName = "confidence";
    std::optional<std::size_t> selected;
    bool confirm = false;  ///< what is selected may still be changed
};

/// After the answer, where the protocol says so.
struct FeedbackFace {
    static constexpr std::string_view kName = "feedback";
    bool right = false;
};

/// Between two trials: rest.
struct BreakFace {
    static constexpr std::string_view kName = "break";
    int seconds_left = 0;  ///< 0: the participant may go on
    protocols::TrialView next{};
    bool awaits_handle = false;  ///< home, where nobody holds it

    friend bool operator==(const BreakFace&, const BreakFace&) = default;
};

/// After a fault. The sentence comes from device and safety chain, which know nothing of the
/// condition.
struct TroubleFace {
    static constexpr std::string_view kName = "trouble";
    std::string sentence;   ///< for the experimenter: what happened and what to do
    bool solved = false;    ///< the session can go on
    bool by_chord = false;  ///< with the experimenter's chord, not by the participant

    friend bool operator==(const TroubleFace&, const TroubleFace&) = default;
};

/// Until the experimenter goes on.
struct PauseFace {
    static constexpr std::string_view kName = "pause";
};

/// Nothing to see: between two intervals or trials.
struct GapFace {
    static constexpr std::string_view kName = "gap";
};

/// After the last trial.
struct EndFace {
    static constexpr std::string_view kName = "end";
};

/// Each draws its screen into a window that was cleared.
void draw(Window& window, const WelcomeFace& face);
void draw(Window& window, const ReadyFace& face);
void draw(Window& window, const ExploreFace& face);
void draw(Window& window, const ChooseFace& face);
void draw(Window& window, const ConfidenceFace& face);
void draw(Window& window, const FeedbackFace& face);
void draw(Window& window, const BreakFace& face);
void draw(Window& window, const TroubleFace& face);
void draw(Window& window, const PauseFace& face);
void draw(Window& window, const GapFace& face);
void draw(Window& window, const EndFace& face);

/// In the upper right corner of every screen: SIMULATED or PILOT.
void draw_watermark(Window& window, const std::string& text);
/// A sentence for the experimenter at the lower edge, over whatever is shown.
void draw_bar(Window& window, std::string_view sentence);

}  // namespace palpate::ui

#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <utility>

#include "engine/safety/trip.hpp"
#include "protocols/session/operator_desk.hpp"
#include "ui/subject/faces.hpp"
#include "ui/subject/window.hpp"

union SDL_Event;

namespace palpate::ui {

/// One thing that somebody did, stamped with CLOCK_MONOTONIC when it was seen.
struct Input {
    enum class Kind : std::uint8_t {
        none,  ///< nothing within the time waited
        go,    ///< Space
        enter,
        digit,
        left,
        right,
        click,
        motion,
        release,  ///< Space was let go
        stop,     ///< Escape: on_stop was called
        lost,     ///< the window lost the keyboard, was hidden or was to be closed: the same
        abort,    ///< the experimenter's second step, the operating system's signal, no display
    } kind = Kind::none;
    int digit = 0;              ///< 1 to 9
    const char* way = nullptr;  ///< of lost: which
    engine::Vec2 pixel{};       ///< of click and motion
    std::int64_t seen_ns = 0;
    double uncertainty_s =
        0.0;  ///< time since the queue was last looked at: how late it may be seen
};

/// How a screen looks, and what ends it.
struct StageOptions {
    WindowOptions window{};
    std::string watermark{};                  ///< "SIMULATED", "PILOT" or nothing
    std::function<bool()> interrupted{};      ///< a signal asks the session to end
    protocols::OperatorDesk* desk = nullptr;  ///< outlives the screen; none: its keys do nothing
    /// The force off, now, for this cause and in this way: Escape on any screen, and while an
    /// object is felt whatever takes the window out of the participant's sight or reach.
    std::function<void(engine::Trip, const char*)> on_stop{};
    std::function<void()> on_close{};  ///< somebody wants to close the window, which stays
};

/// A window, what it shows now, and what people do. Knows the two-step stop: Ctrl+Shift+Q asks, Y
/// within 3 s stops; nothing else can end a session, closing the window neither. Escape is one
/// step, whatever is shown: no force is wanted, and it ends no more than a trial. For the
/// experimenter's desk, Ctrl+Shift+M and Y within 3 s
/// marks the trial, and Ctrl+Shift+P asks for a pause; both say so at the lower edge.
class Stage {
public:
    /// Opens the window. @throws as Window
    explicit Stage(StageOptions options);

    /// Shows `face` from now on, redrawn whenever the window needs it, and then names it in the
    /// window's title. Returns the time of presentation.
    template <class Face>
    std::int64_t show(Face face) {
        return show(Face::kName, [face = std::move(face)](Window& window) { draw(window, face); });
    }
    std::int64_t show(std::string_view name, std::function<void(Window&)> drawing);
    /// Whether a mark means the trial that runs, or the last one.
    void in_trial(bool runs) noexcept { in_trial_ = runs; }
    /// The session is over: the desk can mark and pause nothing any more, and its keys say so.
    void close_desk() { desk_closed_ = true; }
    /// Nothing at the lower edge from the next show() on.
    void drop_bar() { bar_ = Bar::none; }
    /// Waits up to `wait_ms` for something that matters.
    Input next(int wait_ms);
    /// Forgets presses and clicks that came before now, but Escape: they were meant for another
    /// screen. @return Space was let go
    bool forget_earlier();
    /// next() keeps back what might answer (keys and clicks, not Escape, a release or the chords)
    /// and may have come before this time. A key that is held on is no press afterwards either.
    void guard_until(std::int64_t ns);
    /// From now on next() keeps back Space and Enter while the keyboard is with another window, and
    /// the lower edge says so. A click takes it back where no window manager does.
    void need_keyboard(bool needed);
    /// How much it kept back since guard_until().
    [[nodiscard]] std::size_t early_presses() const noexcept { return early_; }
    /// No force: says so to whoever made the window.
    void stop(engine::Trip cause, const char* way) const;
    /// Waits, still showing the face. True if the session is to end.
    bool wait_or_abort(double seconds);
    /// Shows that the session pauses until the desk asks again, or somebody wants no force, which
    /// is shown then. True if the session is to end.
    bool pause_or_abort();

    /// Where faces are drawn.
    [[nodiscard]] Window& window() { return window_; }

private:
    void redraw();
    void mind_keyboard();
    [[nodiscard]] Input read_window(const SDL_Event& event);
    /// Of the canvas, from where the display says that the pointer is.
    [[nodiscard]] engine::Vec2 pixel(int x, int y) const;
    [[nodiscard]] Input read(const SDL_Event& event);
    [[nodiscard]] bool too_early(const Input& input);
    Input key(std::int32_t symbol, std::uint16_t modifiers, bool repeat);
    Input answer_question(std::int32_t symbol);
    /// What the bar at the lower edge says: questions to be answered by Y, and a notice.
    enum class Bar : std::uint8_t {
        none,
        stop,
        mark,
        marked,
        pause_comes,
        no_pause,
        over,
        elsewhere
    };
    void show_bar(Bar bar);
    [[nodiscard]] std::string sentence_of(Bar bar) const;
    void show_reply();
    bool chord(std::int32_t symbol, std::uint16_t modifiers);

    StageOptions options_;
    Window window_;
    std::function<void(Window&)> face_;
    std::int64_t looked_ns_ = 0;   ///< when the queue was last seen empty
    std::int64_t guarded_ns_ = 0;  ///< until then nothing answers
    std::size_t early_ = 0;
    protocols::MarkReply reply_{};  ///< of Bar::marked
    bool desk_closed_ = false;
    bool in_trial_ = false;
    bool needs_keyboard_ = false;
    Bar bar_ = Bar::none;
    std::int64_t bar_until_ns_ = 0;
};

}  // namespace palpate::ui

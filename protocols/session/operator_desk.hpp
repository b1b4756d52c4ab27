#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "protocols/session/progress.hpp"

namespace palpate::protocols {

/// Why a stop button bars every trial; a screen translates it.
inline constexpr const char* kButtonGone = "the stop button is gone: plug it in again";
inline constexpr const char* kButtonDown = "the stop button is pressed: release it";

/// The way of a stop that nobody wanted: it holds the force, and costs the rig no trust.
inline constexpr const char* kKeyboardElsewhere = "keyboard elsewhere";
/// The way of a stop at the participant's screen.
inline constexpr const char* kEscapeAtScreen = "Escape";

/// What a mark came to.
struct MarkReply {
    bool found = false;       ///< an answer that counted; else nothing is changed
    bool runs_again = false;  ///< its trial will
    TrialNumber number{};     ///< as its screens said
    TrialNumber next{};       ///< the trial that comes now
    std::int64_t trial = 0;   ///< its trial_id
    std::string reason{};     ///< in the experimenter's words; empty: none was given
};

/// What the experimenter asked for while a session runs, until the session does it. Screen and
/// session share the desk on one thread; stop(), bar() and what is said of the force are for any.
class OperatorDesk {
public:
    /// The running trial, or the last one where none is, shall not count.
    /// @param reason  in the experimenter's words, after those of marks that still wait; empty:
    /// none
    void mark(const std::string& reason = {}) {
        const std::string before = mark_.value_or("");
        mark_ = before + (before.empty() || reason.empty() ? "" : "; ") + reason;
        if (at_once_) {
            at_once_();
        }
    }
    /// Where a mark needs not wait for a trial's end: called by mark(). None: it waits.
    void answer_at_once(std::function<void()> answer) { at_once_ = std::move(answer); }
    /// Wait before the next trial; asked for again: go on, or do not wait after all.
    void pause() noexcept { pause_ = !pause_; }

    /// Somebody wants no force. The first way is kept until it is taken.
    /// @param way  kEscapeAtScreen, "terminal", ...: a literal
    void stop(const char* way) noexcept {
        const char* none = nullptr;
        stop_.compare_exchange_strong(none, way);
    }
    /// In a break: asked whether the handle still has to come home, until another is given; none:
    /// it has not.
    void await_handle(std::function<bool()> awaited) { handle_awaited_ = std::move(awaited); }
    [[nodiscard]] bool awaits_handle() const { return handle_awaited_ && handle_awaited_(); }
    /// No trial begins while this stands. @param why  a sentence, a literal; none: nothing any more
    void bar(const char* why) noexcept { barred_.store(why); }
    /// Whether the device may still give its last force (Apparatus::force_unproved).
    void doubt_force(bool doubted) noexcept { force_doubted_.store(doubted); }
    [[nodiscard]] bool force_doubted() const noexcept { return force_doubted_.load(); }

    /// Something was asked for that a session stops for between trials.
    [[nodiscard]] bool wants() const noexcept {
        return mark_.has_value() || pause_ || wants_stop();
    }
    /// Force is not wanted: stop() or bar().
    [[nodiscard]] bool wants_stop() const noexcept {
        return stop_.load() != nullptr || barred() != nullptr;
    }
    /// Why no trial may begin; null: it may.
    [[nodiscard]] const char* barred() const noexcept { return barred_.load(); }
    /// The way of the stop, which is forgotten then; null: there was none.
    [[nodiscard]] const char* take_stop() noexcept { return stop_.exchange(nullptr); }
    /// What became of the mark, for the screen to say.
    void reply(MarkReply reply) noexcept { reply_ = std::move(reply); }
    [[nodiscard]] std::optional<MarkReply> take_reply() noexcept {
        return std::exchange(reply_, std::nullopt);
    }
    [[nodiscard]] bool wants_pause() const noexcept { return pause_; }
    /// Its reason; none: nobody asked for a mark.
    [[nodiscard]] std::optional<std::string> take_mark() noexcept {
        return std::exchange(mark_, std::nullopt);
    }
    [[nodiscard]] bool take_pause() noexcept { return std::exchange(pause_, false); }

private:
    std::optional<std::string> mark_;  ///< why; empty: no reason was given
    bool pause_ = false;
    std::function<void()> at_once_;
    std::function<bool()> handle_awaited_;
    std::atomic<const char*> stop_{nullptr};
    std::atomic<const char*> barred_{nullptr};
    std::atomic<bool> force_doubted_{false};
    std::optional<MarkReply> reply_;
};

/// The reason that a mark at the desk leaves with a trial.
inline constexpr const char* kMarkedAtDesk = "marked by the experimenter while the session ran";

}  // namespace palpate::protocols

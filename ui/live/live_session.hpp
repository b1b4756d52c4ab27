#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "engine/base/clock.hpp"
#include "protocols/session/operator_desk.hpp"
#include "protocols/session/ports.hpp"
#include "protocols/trial/observer_beside.hpp"
#include "data/store/async_recorder.hpp"
#include "ui/live/live_board.hpp"
#include "ui/rig/control_line.hpp"
#include "ui/rig/interrupt.hpp"

namespace palpate::ui {

/// What others see of a running session, and what they may ask of it. Whatever is asked for goes
/// the way of the experimenter's chords: on the session's thread, through its desk and its events.
/// Nothing in here gives force, changes a limit, or answers for a participant.
class LiveSession {
public:
    /// @param desk  outlives this
    explicit LiveSession(protocols::OperatorDesk& desk) : desk_(desk) {}

    /// From here on it is shown. All outlive the session.
    void begin(LiveFacts facts,
               const protocols::Protocol& protocol,
               const protocols::Plan& plan,
               data::AsyncRecorder& recorder);
    /// What was asked for and not yet done is not done any more.
    /// @param how  "finished", "ended early", ...
    void end(std::string_view how);
    [[nodiscard]] LiveBoard& board() noexcept { return *board_; }
    [[nodiscard]] protocols::OperatorDesk& desk() noexcept { return desk_; }

    /// Does what was asked for; called again and again on the session's thread.
    void pump();
    /// @param look  called by pump() while nothing is felt and no answer is timed
    void beside(std::function<void()> look) { beside_ = std::move(look); }
    void marked(const protocols::MarkReply& reply, bool alarm);

    /// A line of the control socket, but for "stop": {"do": "pause" | "go on" | "mark" | "note" |
    /// "noted" | "end" | "reveal" | "state" | "page", "text": ..., "reason": ..., "word": ...}.
    /// "noted" is in the file already, and is shown. A mark may say of which "trial" (its trial_id)
    /// it is meant: of another one it is none. On the socket's thread.
    void hear(const std::string& line, const std::shared_ptr<Caller>& caller);

private:
    struct Asked {
        void (LiveSession::*obey)(const Asked&);
        std::string text;
        std::shared_ptr<Caller> caller;
        std::int64_t trial = 0;  ///< the trial_id that is meant; 0: the running or last one
        std::int64_t when_ns = monotonic_ns();
    };
    /// A second step: the word that has to come back, and until when.
    struct Word {
        std::string word;
        std::int64_t until_ns = 0;
    };
    [[nodiscard]] bool confirmed(Word& word,
                                 const std::string& given,
                                 const Caller& caller,
                                 std::string_view question) const;
    void answer_state(const Caller& caller) const;
    void answer_page(const Caller& caller);
    void end_early(const std::string& word, const Caller& caller);
    [[nodiscard]] bool may_reveal(const std::string& word, const Caller& caller);

    void obey_all();
    void pause(const Asked& asked);
    void go_on(const Asked& asked);
    void mark(const Asked& asked);
    void note(const Asked& asked);
    void noted(const Asked& asked);
    void reveal(const Asked& asked);

    protocols::OperatorDesk& desk_;
    data::AsyncRecorder* recorder_ = nullptr;
    std::unique_ptr<LiveBoard> board_;
    std::unique_ptr<LiveReader> reader_;  ///< of the board, for the socket's thread

    std::mutex mutex_;
    std::deque<Asked> inbox_;
    std::atomic<bool> asked_{false};
    std::atomic<bool> open_{false};
    std::atomic<bool> revealed_{false};
    Descriptor page_socket_{};  ///< listens where its pages are; < 0: nobody asked yet
    std::string page_;          ///< the answer to "page"
    Word end_{};
    Word reveal_{};

    std::function<void()> beside_;
    bool reveal_wanted_ = false;
    std::optional<protocols::MarkReply> reply_{};
    std::vector<std::shared_ptr<Caller>> marking_{};  ///< of marks that the session has yet to do
};

/// Whoever answers, with each step shown to those who look on. Where nobody sits at a screen, a
/// pause lasts until the experimenter goes on all the same.
class LiveObserver : public protocols::ObserverBeside {
    using Signal = protocols::Signal;

public:
    /// All outlive this one.
    LiveObserver(protocols::Observer& observer, LiveSession& live)
        : ObserverBeside(observer), live_(live) {}

    void feel(std::span<const engine::TickRecord> ticks) override {
        live_.board().feel(ticks);
        ObserverBeside::feel(ticks);
    }
    [[nodiscard]] Signal pause(const protocols::TrialView& next) override {
        enter(protocols::SessionStep::pause, &next);
        const bool waits = !live_.board().facts().screen;
        while (waits && !live_.desk().wants_stop() && !live_.desk().take_pause()) {
            if (interrupted()) {
                return Signal::abort;
            }
            protocols::sleep_for(0.02);
            live_.pump();
        }
        return ObserverBeside::pause(next);
    }
    [[nodiscard]] std::optional<Signal> trouble(const protocols::TroubleView& view) override {
        live_.board().enter(view);
        return ObserverBeside::trouble(view);
    }

protected:
    /// Shown, and what was asked for meanwhile done.
    void enter(protocols::SessionStep step, const protocols::TrialView* trial) override {
        if (step == protocols::SessionStep::ended) {
            live_.end("finished");
            return;
        }
        if (step != protocols::SessionStep::trouble) {
            live_.board().enter(step, trial);
        }
        live_.pump();
    }

private:
    LiveSession& live_;
};

}  // namespace palpate::ui

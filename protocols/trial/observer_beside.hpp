#pragma once

#include "protocols/trial/observer.hpp"

namespace palpate::protocols {

/// Where a session is, as whoever answers sees it.
enum class SessionStep : std::uint8_t {
    welcome,
    ready,
    explore,
    question,
    feedback,
    gap,
    rest,
    pause,
    trouble,
    ended
};

/// Whether masking noise is to be heard at a step: from Ready until the question, between two
/// intervals as well.
/// @param before  it was at the step before
[[nodiscard]] constexpr bool noise_at(SessionStep step, bool before) noexcept {
    return step == SessionStep::ready ||
           (before && (step == SessionStep::explore || step == SessionStep::gap));
}

/// Whoever answers, for somebody beside who hears of each step before it begins.
class ObserverBeside : public Observer {
public:
    /// @param observer  outlives this one
    explicit ObserverBeside(Observer& observer) : observer_(observer) {}

    [[nodiscard]] Signal welcome(const SessionView& session) override {
        enter(SessionStep::welcome, nullptr);
        return observer_.welcome(session);
    }
    [[nodiscard]] Signal ready(const TrialView& trial) override {
        enter(SessionStep::ready, &trial);
        return observer_.ready(trial);
    }
    [[nodiscard]] ExplorationStep explore(const TrialView& trial, double elapsed_s) override {
        enter(SessionStep::explore, &trial);
        return observer_.explore(trial, elapsed_s);
    }
    void feel(std::span<const engine::TickRecord> ticks) override { observer_.feel(ticks); }
    [[nodiscard]] Choice choose(const TrialView& trial, const Question& question) override {
        enter(SessionStep::question, &trial);
        return observer_.choose(trial, question);
    }
    [[nodiscard]] Signal feedback(const TrialView& trial, bool correct) override {
        enter(SessionStep::feedback, &trial);
        return observer_.feedback(trial, correct);
    }
    [[nodiscard]] Signal gap(double seconds) override {
        enter(SessionStep::gap, nullptr);
        return observer_.gap(seconds);
    }
    [[nodiscard]] Signal rest(double seconds, const TrialView& next) override {
        enter(SessionStep::rest, &next);
        return observer_.rest(seconds, next);
    }
    [[nodiscard]] Signal pause(const TrialView& next) override {
        enter(SessionStep::pause, &next);
        return observer_.pause(next);
    }
    [[nodiscard]] std::optional<Signal> trouble(const TroubleView& view) override {
        enter(SessionStep::trouble, nullptr);
        return observer_.trouble(view);
    }
    void finish(const SessionView& session) override {
        enter(SessionStep::ended, nullptr);
        observer_.finish(session);
    }

protected:
    /// @param trial  of the step, in a break or a pause the next one; null: the step has none
    virtual void enter(SessionStep step, const TrialView* trial) = 0;

private:
    Observer& observer_;
};

}  // namespace palpate::protocols

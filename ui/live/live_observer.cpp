#include "ui/live/live_observer.hpp"

#include "protocols/session/ports.hpp"

namespace palpate::ui {

using protocols::Signal;

void LiveObserver::enter(LivePhase phase, const protocols::TrialView* trial) {
    live_.board().enter(phase, trial);
    live_.pump();
}

Signal LiveObserver::welcome(const protocols::SessionView& session) {
    enter(LivePhase::welcome);
    return observer_.welcome(session);
}

Signal LiveObserver::ready(const protocols::TrialView& trial) {
    enter(LivePhase::ready, &trial);
    return observer_.ready(trial);
}

protocols::ExplorationStep LiveObserver::explore(const protocols::TrialView& trial,
                                                 double elapsed_s) {
    enter(LivePhase::explore, &trial);
    return observer_.explore(trial, elapsed_s);
}

void LiveObserver::feel(std::span<const engine::TickRecord> ticks) {
    live_.board().feel(ticks);
    observer_.feel(ticks);
}

protocols::Choice LiveObserver::choose(const protocols::TrialView& trial,
                                       const protocols::Question& question) {
    enter(LivePhase::question, &trial);
    return observer_.choose(trial, question);
}

Signal LiveObserver::feedback(const protocols::TrialView& trial, bool correct) {
    enter(LivePhase::feedback, &trial);
    return observer_.feedback(trial, correct);
}

Signal LiveObserver::gap(double seconds) {
    enter(LivePhase::gap);
    return observer_.gap(seconds);
}

Signal LiveObserver::rest(double seconds, const protocols::TrialView& next) {
    enter(LivePhase::rest, &next);
    return observer_.rest(seconds, next);
}

Signal LiveObserver::pause(const protocols::TrialView& next) {
    constexpr double kSlice = 0.02;  // s
    enter(LivePhase::pause, &next);
    const bool waits = !live_.board().facts().screen;
    while (waits && !desk_.take_pause()) {
        if (interrupted_()) {
            return Signal::abort;
        }
        protocols::sleep_for(kSlice);
        live_.pump();
    }
    return observer_.pause(next);
}

std::optional<Signal> LiveObserver::trouble(const protocols::TroubleView& view) {
    live_.board().enter(view);
    live_.pump();
    return observer_.trouble(view);
}

void LiveObserver::finish(const protocols::SessionView& session) {
    live_.end("finished");
    observer_.finish(session);
}

}  // namespace palpate::ui

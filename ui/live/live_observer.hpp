#pragma once

#include "protocols/session/ports.hpp"
#include "protocols/session/recorder.hpp"
#include "protocols/session/trust.hpp"
#include "protocols/trial/observer.hpp"
#include "ui/live/live_session.hpp"

namespace palpate::ui {

/// Whoever answers, with each step shown to those who look on. Where nobody sits at a screen, a
/// pause lasts until the experimenter goes on all the same.
class LiveObserver : public protocols::Observer {
    using Signal = protocols::Signal;
    using TrialView = protocols::TrialView;

public:
    /// All outlive this one.
    LiveObserver(protocols::Observer& observer,
                 LiveSession& live,
                 protocols::OperatorDesk& desk,
                 bool (*interrupted)())
        : observer_(observer), live_(live), desk_(desk), interrupted_(interrupted) {}

    [[nodiscard]] Signal welcome(const protocols::SessionView& session) override {
        enter(LivePhase::welcome);
        return observer_.welcome(session);
    }
    [[nodiscard]] Signal ready(const TrialView& trial) override {
        enter(LivePhase::ready, &trial);
        return observer_.ready(trial);
    }
    [[nodiscard]] protocols::ExplorationStep explore(const TrialView& trial,
                                                     double elapsed_s) override {
        enter(LivePhase::explore, &trial);
        return observer_.explore(trial, elapsed_s);
    }
    void feel(std::span<const engine::TickRecord> ticks) override {
        live_.board().feel(ticks);
        observer_.feel(ticks);
    }
    [[nodiscard]] protocols::Choice choose(const TrialView& trial,
                                           const protocols::Question& question) override {
        enter(LivePhase::question, &trial);
        return observer_.choose(trial, question);
    }
    [[nodiscard]] Signal feedback(const TrialView& trial, bool correct) override {
        enter(LivePhase::feedback, &trial);
        return observer_.feedback(trial, correct);
    }
    [[nodiscard]] Signal gap(double seconds) override {
        enter(LivePhase::gap);
        return observer_.gap(seconds);
    }
    [[nodiscard]] Signal rest(double seconds, const TrialView& next) override {
        enter(LivePhase::rest, &next);
        return observer_.rest(seconds, next);
    }
    [[nodiscard]] Signal pause(const TrialView& next) override {
        enter(LivePhase::pause, &next);
        const bool waits = !live_.board().facts().screen;
        while (waits && !desk_.wants_stop() && !desk_.take_pause()) {
            if (interrupted_()) {
                return Signal::abort;
            }
            protocols::sleep_for(0.02);
            live_.pump();
        }
        return observer_.pause(next);
    }
    [[nodiscard]] std::optional<Signal> trouble(const protocols::TroubleView& view) override {
        live_.board().enter(view);
        live_.pump();
        return observer_.trouble(view);
    }
    void finish(const protocols::SessionView& session) override {
        live_.end("finished");
        observer_.finish(session);
    }

private:
    /// Shown, and what was asked for meanwhile done.
    void enter(LivePhase phase, const TrialView* trial = nullptr) {
        live_.board().enter(phase, trial);
        live_.pump();
    }

    protocols::Observer& observer_;
    LiveSession& live_;
    protocols::OperatorDesk& desk_;
    bool (*interrupted_)();
};

/// Whatever keeps the data, with what it hears of the running trial shown to those who look on.
class LiveRecorder : public protocols::Recorder {
public:
    LiveRecorder(protocols::Recorder& recorder, LiveSession& live)
        : recorder_(recorder), live_(live) {}

    [[nodiscard]] protocols::TrialId begin_trial(const protocols::PlannedTrial& planned) override {
        const protocols::TrialId trial = recorder_.begin_trial(planned);
        live_.in_trial(trial);
        return trial;
    }
    void begin_interval(protocols::TrialId trial,
                        const protocols::Presentation& felt,
                        const protocols::SceneConstants& scene) override {
        recorder_.begin_interval(trial, felt, scene);
        live_.board().feels(felt);
    }
    void append(protocols::TrialId trial, std::span<const engine::TickRecord> ticks) override {
        recorder_.append(trial, ticks);
    }
    bool save() override { return recorder_.save(); }
    void end_trial(protocols::TrialId trial, const protocols::TrialResult& result) override {
        recorder_.end_trial(trial, result);
        live_.in_trial(std::nullopt);
    }
    void event(const protocols::Event& event) override {
        recorder_.event(event);
        if (event.key == protocols::kRigCheck) {
            live_.board().checked(event.value);
        }
    }
    void finish_session() override { recorder_.finish_session(); }

private:
    protocols::Recorder& recorder_;
    LiveSession& live_;
};

}  // namespace palpate::ui

#pragma once

#include "protocols/session/ports.hpp"
#include "protocols/session/recorder.hpp"
#include "protocols/session/trust.hpp"
#include "protocols/trial/observer_beside.hpp"
#include "ui/live/live_session.hpp"
#include "ui/rig/interrupt.hpp"

namespace palpate::ui {

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

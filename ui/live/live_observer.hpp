#pragma once

#include "protocols/session/recorder.hpp"
#include "protocols/trial/observer.hpp"
#include "ui/live/live_session.hpp"

namespace palpate::ui {

/// Whoever answers, with each step shown to those who look on. Where nobody sits at a screen, a
/// pause lasts until the experimenter goes on all the same.
class LiveObserver : public protocols::Observer {
public:
    /// All outlive this one.
    LiveObserver(protocols::Observer& observer,
                 LiveSession& live,
                 protocols::OperatorDesk& desk,
                 bool (*interrupted)())
        : observer_(observer), live_(live), desk_(desk), interrupted_(interrupted) {}

    [[nodiscard]] protocols::Signal welcome(const protocols::SessionView& session) override;
    [[nodiscard]] protocols::Signal ready(const protocols::TrialView& trial) override;
    [[nodiscard]] protocols::ExplorationStep explore(const protocols::TrialView& trial,
                                                     double elapsed_s) override;
    void feel(std::span<const engine::TickRecord> ticks) override;
    [[nodiscard]] protocols::Choice choose(const protocols::TrialView& trial,
                                           const protocols::Question& question) override;
    [[nodiscard]] protocols::Signal feedback(const protocols::TrialView& trial,
                                             bool correct) override;
    [[nodiscard]] protocols::Signal gap(double seconds) override;
    [[nodiscard]] protocols::Signal rest(double seconds, const protocols::TrialView& next) override;
    [[nodiscard]] protocols::Signal pause(const protocols::TrialView& next) override;
    [[nodiscard]] std::optional<protocols::Signal> trouble(
        const protocols::TroubleView& view) override;
    void finish(const protocols::SessionView& session) override;

private:
    /// Shown, and what was asked for meanwhile done.
    void enter(LivePhase phase, const protocols::TrialView* trial = nullptr);

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
    void event(const protocols::Event& event) override { recorder_.event(event); }
    void finish_session() override { recorder_.finish_session(); }

private:
    protocols::Recorder& recorder_;
    LiveSession& live_;
};

}  // namespace palpate::ui

#pragma once

#include <cstdint>

#include "protocols/session/recorder.hpp"
#include "protocols/trial/observer.hpp"
#include "ui/sound/noise_player.hpp"

namespace palpate::ui {

/// Plays noise around whatever another observer does, so that nobody hears the motors: from the
/// first ready screen of a trial, before the force can come, until the question, when the force is
/// off. It is silent elsewhere: people rest from it, and can be spoken to. Between the intervals of
/// a trial it goes on.
///
/// ready() returns once the noise has come in fully. If the sound device is lost, what was not
/// heard is an event "masking" with the number of the trial as shown; where masking is `required`
/// the next ready() throws then.
class MaskedObserver : public protocols::Observer {
public:
    /// All outlive this one.
    MaskedObserver(protocols::Observer& observer,
                   NoisePlayer& player,
                   protocols::Recorder& recorder,
                   bool required);
    ~MaskedObserver() override;

    [[nodiscard]] protocols::Signal welcome(const protocols::SessionView& session) override {
        return observer_.welcome(session);
    }
    /// @throws std::runtime_error if the device is lost and masking is required
    [[nodiscard]] protocols::Signal ready(const protocols::TrialView& trial) override;
    [[nodiscard]] protocols::ExplorationStep explore(const protocols::TrialView& trial,
                                                     double elapsed_s) override {
        return observer_.explore(trial, elapsed_s);
    }
    void feel(std::span<const engine::TickRecord> ticks) override { observer_.feel(ticks); }
    [[nodiscard]] protocols::Choice choose(const protocols::TrialView& trial,
                                           const protocols::Question& question) override;
    [[nodiscard]] protocols::Signal feedback(const protocols::TrialView& trial,
                                             bool correct) override {
        return observer_.feedback(trial, correct);
    }
    /// Between two intervals of a trial the noise goes on, and after an answer there is none.
    [[nodiscard]] protocols::Signal gap(double seconds) override { return observer_.gap(seconds); }
    [[nodiscard]] protocols::Signal rest(double seconds, const protocols::TrialView& next) override;
    [[nodiscard]] protocols::Signal pause(const protocols::TrialView& next) override;
    [[nodiscard]] std::optional<protocols::Signal> trouble(
        const protocols::TroubleView& view) override;
    void finish(const protocols::SessionView& session) override;

private:
    void begin();
    void end();
    void note_silence();

    protocols::Observer& observer_;
    NoisePlayer& player_;
    protocols::Recorder& recorder_;
    bool required_;
    std::string trial_;         ///< its number as shown, e.g. "practice 3"
    std::int64_t full_ns_ = 0;  ///< when the noise of the running trial had come in; 0: it has not
    double full_s_ = 0.0;       ///< what the player had played by then
};

/// What the noise may lack of a trial before that is an event, s: devices take it in pieces, and
/// their clocks run a little differently.
inline constexpr double kSilenceBearable = 0.2;

}  // namespace palpate::ui

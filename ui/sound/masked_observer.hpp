#pragma once

#include <chrono>
#include <cstdint>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>

#include "engine/base/clock.hpp"
#include "protocols/session/recorder.hpp"
#include "protocols/trial/observer_beside.hpp"
#include "ui/sound/faded_noise.hpp"
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
class MaskedObserver : public protocols::ObserverBeside {
public:
    /// All outlive this one.
    MaskedObserver(protocols::Observer& observer,
                   NoisePlayer& player,
                   protocols::Recorder& recorder,
                   bool required)
        : ObserverBeside(observer), player_(player), recorder_(recorder), required_(required) {}
    ~MaskedObserver() override { player_.off(); }

    /// @throws std::runtime_error if the device is lost and masking is required
    [[nodiscard]] protocols::Signal ready(const protocols::TrialView& trial) override {
        const protocols::Signal signal = ObserverBeside::ready(trial);
        signal == protocols::Signal::go_on ? begin() : end();
        return signal;
    }

protected:
    void enter(protocols::SessionStep step, const protocols::TrialView* trial) override {
        if (step == protocols::SessionStep::ready) {
            come_in(*trial);
        } else if (!protocols::noise_at(step, true)) {
            end();
        }
    }

private:
    /// The noise is waited for at most this long, s: the fade, and what a sound server may buffer.
    static constexpr double kLongestWait = kFade + 0.75;
    /// A device that plays slower than it says by this share is no event: a trial takes up to a
    /// minute.
    static constexpr double kSlowBearable = 0.05;
    /// What the noise may lack of a trial before that is an event, s: devices take it in pieces,
    /// and their clocks run a little differently.
    static constexpr double kSilenceBearable = 0.2;

    void come_in(const protocols::TrialView& trial) {
        if (required_ && !player_.works()) {
            recorder_.event({.kind = protocols::EventKind::masking,
                             .text = "the sound device was lost: the session ends"});
            throw std::runtime_error(
                "the sound device for the masking noise was lost: connect it again, then give the "
                "same command to go on");
        }
        trial_ = fmt::format("{} {}", trial.practice ? "practice" : "trial", trial.number);
        player_.on();
    }
    void begin() {
        const std::int64_t until = monotonic_ns() + static_cast<std::int64_t>(kLongestWait * 1e9);
        while (!player_.full() && player_.works() && monotonic_ns() < until) {
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
        }
        if (full_ns_ == 0) {
            full_ns_ = monotonic_ns();
            full_s_ = player_.full_s();
        }
    }
    void end() {
        if (full_ns_ != 0) {
            note_silence();
            full_ns_ = 0;
        }
        player_.off();
    }
    void note_silence() {
        const double wanted = static_cast<double>(monotonic_ns() - full_ns_) * 1e-9;
        const double missing = wanted - (player_.full_s() - full_s_);
        if (missing > kSilenceBearable + kSlowBearable * wanted) {
            recorder_.event({.kind = protocols::EventKind::masking,
                             .text = fmt::format("{:.2f} s of {:.2f} s of {} were without noise",
                                                 missing, wanted, trial_),
                             .duration_s = missing});
        }
    }

    NoisePlayer& player_;
    protocols::Recorder& recorder_;
    bool required_;
    std::string trial_;         ///< its number as shown, e.g. "practice 3"
    std::int64_t full_ns_ = 0;  ///< when the noise of the running trial had come in; 0: it has not
    double full_s_ = 0.0;       ///< what the player had played by then
};

}  // namespace palpate::ui

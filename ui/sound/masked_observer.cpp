#include "ui/sound/masked_observer.hpp"

#include <chrono>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>

#include "engine/realtime/servo.hpp"
#include "ui/sound/faded_noise.hpp"

namespace palpate::ui {

using protocols::Signal;

/// The noise is waited for at most this long, s: the fade, and what a sound server may buffer.
constexpr double kLongestWait = kFade + 0.75;
/// A device that plays slower than it says by this share is no event: a trial takes up to a minute.
constexpr double kSlowBearable = 0.05;

MaskedObserver::MaskedObserver(protocols::Observer& observer,
                               NoisePlayer& player,
                               protocols::Recorder& recorder,
                               bool required)
    : observer_(observer), player_(player), recorder_(recorder), required_(required) {}

MaskedObserver::~MaskedObserver() {
    player_.off();
}

void MaskedObserver::begin() {
    const std::int64_t until = monotonic_ns() + static_cast<std::int64_t>(kLongestWait * 1e9);
    while (!player_.full() && player_.works() && monotonic_ns() < until) {
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    if (full_ns_ == 0) {
        full_ns_ = monotonic_ns();
        full_s_ = player_.full_s();
    }
}

void MaskedObserver::end() {
    if (full_ns_ != 0) {
        note_silence();
        full_ns_ = 0;
    }
    player_.off();
}

void MaskedObserver::note_silence() {
    const double wanted = static_cast<double>(monotonic_ns() - full_ns_) * 1e-9;
    const double missing = wanted - (player_.full_s() - full_s_);
    if (missing > kSilenceBearable + kSlowBearable * wanted) {
        recorder_.event({.kind = protocols::EventKind::masking,
                         .text = fmt::format("{:.2f} s of {:.2f} s of {} were without noise",
                                             missing, wanted, trial_),
                         .duration_s = missing});
    }
}

Signal MaskedObserver::ready(const protocols::TrialView& trial) {
    if (required_ && !player_.works()) {
        recorder_.event({.kind = protocols::EventKind::masking,
                         .text = "the sound device was lost: the session ends"});
        throw std::runtime_error(
            "the sound device for the masking noise was lost: connect it again, then give the same "
            "command to go on");
    }
    trial_ = fmt::format("{} {}", trial.practice ? "practice" : "trial", trial.number);
    player_.on();
    const Signal signal = observer_.ready(trial);
    if (signal != Signal::go_on) {
        end();
        return signal;
    }
    begin();
    return signal;
}

protocols::Choice MaskedObserver::choose(const protocols::TrialView& trial,
                                         const protocols::Question& question) {
    end();
    return observer_.choose(trial, question);
}

Signal MaskedObserver::rest(double seconds, const protocols::TrialView& next) {
    end();
    return observer_.rest(seconds, next);
}

Signal MaskedObserver::pause(const protocols::TrialView& next) {
    end();
    return observer_.pause(next);
}

std::optional<Signal> MaskedObserver::trouble(const protocols::TroubleView& view) {
    end();
    return observer_.trouble(view);
}

void MaskedObserver::finish(const protocols::SessionView& session) {
    end();
    observer_.finish(session);
}

}  // namespace palpate::ui

#pragma once

#include <memory>
#include <string>

#include <fcntl.h>
#include <unistd.h>

#include "engine/base/descriptor.hpp"
#include "protocols/design/streams.hpp"
#include "protocols/protocol/protocol.hpp"

namespace palpate::ui {

/// Sends standard error nowhere while it lives: sound libraries write pages there when there is no
/// sound, and what matters of it is in SDL's error.
class Hush {
public:
    /// Nothing happens where there is no /dev/null. One at a time.
    Hush() : saved_(dup(STDERR_FILENO)) {
        const Descriptor nowhere(open("/dev/null", O_WRONLY | O_CLOEXEC));
        if (saved_.get() >= 0 && nowhere.get() >= 0) {
            dup2(nowhere.get(), STDERR_FILENO);
        }
    }
    ~Hush() {
        if (saved_.get() >= 0) {
            dup2(saved_.get(), STDERR_FILENO);
        }
    }

private:
    Descriptor saved_;
};

/// Noise on the headphones, on and off.
class NoisePlayer {
public:
    NoisePlayer() = default;
    NoisePlayer(const NoisePlayer&) = delete;
    NoisePlayer& operator=(const NoisePlayer&) = delete;
    virtual ~NoisePlayer() = default;

    /// It begins to come in, or to go out: over some tenths of a second.
    virtual void on() = 0;
    virtual void off() = 0;
    /// It has come in fully.
    [[nodiscard]] virtual bool full() const = 0;
    /// For how long it was handed to the device at its full level so far, s.
    [[nodiscard]] virtual double full_s() const = 0;
    /// The device is still there.
    [[nodiscard]] virtual bool works() const = 0;
    /// "pink noise at -30 dB re full scale, 48000 Hz, on default, driver pulseaudio"
    [[nodiscard]] virtual std::string name() const = 0;
    /// Somebody may hear it: the driver is not one of SDL's for tests.
    [[nodiscard]] virtual bool audible() const = 0;
};

/// Plays the noise that `spec` asks for on the default sound device, through SDL: the same in all
/// channels.
/// @param key  of the session; the purpose is its own. Nothing of a trial is in it
/// @pre spec.noise is not none
/// @throws std::runtime_error if there is no device: what is wrong and what to do
[[nodiscard]] std::unique_ptr<NoisePlayer> open_noise(const protocols::MaskingSpec& spec,
                                                      const protocols::StreamKey& key);

}  // namespace palpate::ui

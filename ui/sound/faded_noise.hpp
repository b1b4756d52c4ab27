#pragma once

#include <atomic>
#include <cstdint>
#include <span>

#include "ui/sound/pink_noise.hpp"

namespace palpate::ui {

/// How long noise takes to come in and to go out, s.
inline constexpr double kFade = 0.25;

/// Pink noise that comes and goes softly: its amplitude follows t^2 (3 - 2 t) while t runs from 0
/// to 1 and back within kFade. Nothing but silence before the first on(). The filter runs on in
/// silence, so that no two trials hear the same piece.
///
/// One thread renders, any thread calls the rest.
class FadedNoise {
public:
    /// @param level_db  root mean square against an amplitude of 1 (full scale), dB, -60 to 0.
    ///                  Samples beyond full scale are cut to it: from -12 dB upwards that happens
    ///                  to 1 in 16,000 and more
    FadedNoise(Pcg32 random, double rate_hz, double level_db);

    /// From the next samples on it comes in, or goes out, over its ramp.
    void on() noexcept { wanted_ = true; }
    void off() noexcept { wanted_ = false; }
    /// It has come in fully.
    [[nodiscard]] bool full() const noexcept { return full_; }
    /// It has gone out fully.
    [[nodiscard]] bool silent() const noexcept { return silent_; }
    /// For how long it was rendered at its full level so far, s.
    [[nodiscard]] double full_s() const noexcept {
        return static_cast<double>(full_samples_.load()) / rate_hz_;
    }

    /// The next samples, -1 to 1.
    void render(std::span<float> samples) noexcept;

private:
    PinkNoise noise_;
    double rate_hz_;
    double amplitude_;
    double step_;        ///< of the fade, per sample
    double fade_ = 0.0;  ///< 0 silent, 1 full
    std::atomic<bool> wanted_{false};
    std::atomic<bool> full_{false};
    std::atomic<bool> silent_{true};
    std::atomic<std::int64_t> full_samples_{0};
};

}  // namespace palpate::ui

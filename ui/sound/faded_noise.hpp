#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/pcg32.hpp"

namespace palpate::ui {

/// Pink noise: power per hertz falls as 1/f, 3.01 dB an octave, from 20 Hz to 0.45 of the sample
/// rate.
///
/// White noise (PCG32 words, uniform in -1..1) through first-order sections in a row,
///
///     y[n] = x[n] - z x[n-1] + p y[n-1],
///
/// whose poles and zeros alternate at equal distances on the axis of log f: each pole turns the
/// slope to -6 dB an octave, the zero half a step above turns it back to 0, and the mean is -3.
/// Poles at 12 Hz * 2.5^k, zeros sqrt(2.5) above each, as many as have their zero below 0.45 of the
/// rate; each corner f stands at (1 - w) / (1 + w), w = tan(pi f / rate), which is the bilinear
/// transform with that corner kept in place. The method is R. Bristow-Johnson's
/// (dsp.stackexchange.com, question 28514), the numbers are ours: they minimise the ripple.
/// |H(f)|^2 f is constant from 50 Hz to 10 kHz within +-0.21 dB at 44.1 kHz, +-0.10 dB at 48 kHz,
/// +-0.07 dB at 96 kHz.
///
/// The mean square is 1 over long times (a short piece wanders: the lowest frequencies are slow).
/// Values come out nearly Gaussian: beyond +-4 about once in 16,000.
class PinkNoise {
public:
    /// @param rate_hz  samples a second, 16000 to 192000
    /// @throws std::invalid_argument outside of that
    PinkNoise(Pcg32 random, double rate_hz);

    /// The next sample, mean square 1.
    double next() noexcept;

private:
    struct Section {
        double zero = 0.0;
        double pole = 0.0;
        double in = 0.0;  ///< the last one
        double out = 0.0;
    };
    double filter(double x) noexcept;

    Pcg32 random_;
    std::vector<Section> sections_;
    double scale_ = 1.0;
};

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

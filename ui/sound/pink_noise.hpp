#pragma once

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

}  // namespace palpate::ui

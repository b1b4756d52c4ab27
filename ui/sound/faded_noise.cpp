#include "ui/sound/faded_noise.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/refuse.hpp"

namespace palpate::ui {

FadedNoise::FadedNoise(Pcg32 random, double rate_hz, double level_db)
    : noise_(random, rate_hz),
      rate_hz_(rate_hz),
      amplitude_(std::pow(10.0, level_db / 20.0)),
      step_(1.0 / (kFade * rate_hz)) {}

void FadedNoise::render(std::span<float> samples) noexcept {
    const bool wanted = wanted_;
    std::int64_t full = 0;
    for (float& sample : samples) {
        fade_ = std::clamp(fade_ + (wanted ? step_ : -step_), 0.0, 1.0);
        const double gain = fade_ * fade_ * (3.0 - 2.0 * fade_);
        sample = static_cast<float>(std::clamp(amplitude_ * gain * noise_.next(), -1.0, 1.0));
        full += fade_ >= 1.0 ? 1 : 0;
    }
    full_samples_ += full;
    full_ = fade_ >= 1.0;
    silent_ = fade_ <= 0.0;
}

namespace {

constexpr double kLowestPole = 12.0;   // Hz
constexpr double kStep = 2.5;          // from pole to pole
constexpr double kHighestZero = 0.45;  // of the sample rate
/// The slowest pole, 12 Hz, falls to e^-75 in this time: the response has ended. s
constexpr double kResponse = 1.0;

double corner(double hz, double rate_hz) {
    const double w = std::tan(M_PI * hz / rate_hz);
    return (1.0 - w) / (1.0 + w);
}

}  // namespace

PinkNoise::PinkNoise(Pcg32 random, double rate_hz) : random_(random) {
    refuse_if(!(rate_hz >= 16000.0 && rate_hz <= 192000.0),
              "noise at {} samples a second: give 16000 to 192000", rate_hz);
    const double up = std::sqrt(kStep);
    for (double pole = kLowestPole; pole * up < kHighestZero * rate_hz; pole *= kStep) {
        sections_.push_back({.zero = corner(pole * up, rate_hz), .pole = corner(pole, rate_hz)});
    }
    // White noise of variance 1/3 comes out with 1/3 of the energy of the impulse response.
    double energy = 0.0;
    const auto length = static_cast<long>(kResponse * rate_hz);
    for (long n = 0; n < length; ++n) {
        const double h = filter(n == 0 ? 1.0 : 0.0);
        energy += h * h;
    }
    scale_ = std::sqrt(3.0 / energy);
    for (Section& section : sections_) {
        section.in = section.out = 0.0;
    }
}

double PinkNoise::filter(double x) noexcept {
    for (Section& section : sections_) {
        const double y = x - section.zero * section.in + section.pole * section.out;
        section.in = x;
        section.out = y;
        x = y;
    }
    return x;
}

double PinkNoise::next() noexcept {
    constexpr double kPerWord = 1.0 / 2147483648.0;  // 2^-31
    return scale_ * filter(static_cast<double>(random_.next()) * kPerWord - 1.0);
}

}  // namespace palpate::ui

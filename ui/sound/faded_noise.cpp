#include "ui/sound/faded_noise.hpp"

#include <algorithm>
#include <cmath>

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

}  // namespace palpate::ui

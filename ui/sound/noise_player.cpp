#include "ui/sound/noise_player.hpp"

#include <cstring>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "ui/sdl/sdl.hpp"
#include "ui/sound/faded_noise.hpp"

namespace palpate::ui {
namespace {

constexpr int kRate = 48000;
/// 21 ms a call: far more than a busy desktop is ever late, far less than the fade.
constexpr int kSamples = 1024;

class SdlNoise : public NoisePlayer {
public:
    SdlNoise(const protocols::MaskingSpec& spec, const protocols::StreamKey& key)
        : noise_(protocols::stream(key), kRate, spec.level_db), level_db_(spec.level_db) {
        const Hush hush;
        if (SDL_InitSubSystem(SDL_INIT_AUDIO) != 0) {
            refuse(SDL_GetError());
        }
        SDL_AudioSpec wanted{};
        wanted.freq = kRate;
        wanted.format = AUDIO_F32SYS;
        wanted.channels = 2;
        wanted.samples = kSamples;
        wanted.callback = &SdlNoise::fill;
        wanted.userdata = this;
        device_ = SDL_OpenAudioDevice(nullptr, 0, &wanted, nullptr, 0);  // SDL converts
        if (device_ == 0) {
            const std::string error = SDL_GetError();
            SDL_QuitSubSystem(SDL_INIT_AUDIO);
            refuse(error);
        }
        SDL_PauseAudioDevice(device_, 0);
    }
    ~SdlNoise() override {
        if (SDL_WasInit(SDL_INIT_AUDIO) != 0) {
            SDL_CloseAudioDevice(device_);
            SDL_QuitSubSystem(SDL_INIT_AUDIO);
        }
    }

    void on() override { noise_.on(); }
    void off() override { noise_.off(); }
    [[nodiscard]] bool full() const override { return noise_.full(); }
    [[nodiscard]] double full_s() const override { return noise_.full_s(); }
    [[nodiscard]] bool works() const override {
        return SDL_GetAudioDeviceStatus(device_) == SDL_AUDIO_PLAYING;
    }
    [[nodiscard]] std::string name() const override {
        return fmt::format("pink noise at {:g} dB re full scale, {} Hz, driver {}", level_db_,
                           kRate, driver());
    }
    [[nodiscard]] bool audible() const override {
        return std::strcmp(driver(), "dummy") != 0 && std::strcmp(driver(), "disk") != 0;
    }

private:
    static const char* driver() {
        const char* name = SDL_GetCurrentAudioDriver();
        return name == nullptr ? "none" : name;
    }

    [[noreturn]] static void refuse(const std::string& why) {
        throw std::runtime_error(fmt::format(
            "masking noise cannot be played: {}; connect headphones, see that ALSA, PulseAudio or "
            "PipeWire runs for this user (palpate doctor tells), or give --no-sound",
            why));
    }

    /// On SDL's thread. Left and right alternate.
    static void fill(void* self, Uint8* bytes, int length) {
        auto& player = *static_cast<SdlNoise*>(self);
        const std::size_t frames = static_cast<std::size_t>(length) / (2 * sizeof(float));
        player.mono_.resize(frames);
        player.noise_.render(player.mono_);
        std::vector<float>& both = player.both_;
        both.resize(2 * frames);
        for (std::size_t i = 0; i < frames; ++i) {
            both[2 * i] = both[2 * i + 1] = player.mono_[i];
        }
        std::memcpy(bytes, both.data(), both.size() * sizeof(float));
    }

    FadedNoise noise_;
    double level_db_;
    std::vector<float> mono_, both_;
    SDL_AudioDeviceID device_ = 0;
};

}  // namespace

std::unique_ptr<NoisePlayer> open_noise(const protocols::MaskingSpec& spec,
                                        const protocols::StreamKey& key) {
    protocols::StreamKey own = key;
    own.block = 0;
    own.purpose = protocols::purpose::masking;
    return std::make_unique<SdlNoise>(spec, own);
}

}  // namespace palpate::ui

#include <fmt/format.h>

#include "ui/doctor/checks.hpp"
#include "ui/sdl/sdl.hpp"
#include "ui/sound/noise_player.hpp"
#include "ui/subject/display.hpp"
#include "ui/subject/font.hpp"
#include "ui/subject/window.hpp"

namespace palpate::ui {
namespace {

/// A part of SDL, for as long as this lives.
class Subsystem {
public:
    Subsystem(Uint32 flag, bool opened) : flag_(flag), works_(opened) {}
    Subsystem(const Subsystem&) = delete;
    Subsystem& operator=(const Subsystem&) = delete;
    ~Subsystem() {
        if (works_) {
            SDL_QuitSubSystem(flag_);
        }
    }
    [[nodiscard]] bool works() const { return works_; }

private:
    Uint32 flag_;
    bool works_;
};

std::string display_text(const FoundDisplay& found,
                         const SDL_DisplayMode& mode,
                         const char* driver) {
    std::string monitors;  // where there is a choice
    for (std::size_t i = 0; i < found.monitors.size() && found.monitors.size() > 1; ++i) {
        monitors += fmt::format("; --monitor {}: {}", i + 1, found.monitors[i]);
    }
    return fmt::format(
        "{} x {} pixels, {}, driver {}{}", mode.w, mode.h,
        mode.refresh_rate > 0 ? fmt::format("{} Hz", mode.refresh_rate) : "refresh rate not known",
        driver == nullptr ? "none" : driver, monitors);
}

/// What the default device gives; none: it cannot be opened.
std::optional<SDL_AudioSpec> default_audio() {
    SDL_AudioSpec wanted{};
    wanted.freq = 48000;
    wanted.format = AUDIO_F32SYS;
    wanted.channels = 2;
    wanted.samples = 1024;
    SDL_AudioSpec got{};
    const SDL_AudioDeviceID device =
        SDL_OpenAudioDevice(nullptr, 0, &wanted, &got, SDL_AUDIO_ALLOW_ANY_CHANGE);
    if (device == 0) {
        return std::nullopt;
    }
    SDL_CloseAudioDevice(device);
    return got;
}

constexpr const char* kNeedsScreen =
    "participants need a screen, and run on a device refuses without one: start both in the "
    "desktop session that will show it (DISPLAY or WAYLAND_DISPLAY set)";

}  // namespace

Check check_display(bool needed) {
    Check check{
        .name = "display", .status = CheckStatus::warn, .detail = "none", .remedy = kNeedsScreen};
    const FoundDisplay found = find_display();
    if (found.state == FoundDisplay::State::none) {
        check.status = needed ? CheckStatus::fail : CheckStatus::warn;
        return check;
    }
    if (found.state == FoundDisplay::State::broken) {
        check.detail = "cannot be opened";
        check.fails(found.trouble);
        return check;
    }
    const Subsystem video(SDL_INIT_VIDEO, open_display());  // as a session does
    SDL_DisplayMode mode{};
    if (!video.works() || SDL_GetDesktopDisplayMode(0, &mode) != 0) {
        check.detail = fmt::format("cannot be opened: {}", SDL_GetError());
        return check;
    }
    const char* driver = SDL_GetCurrentVideoDriver();
    check.detail = display_text(found, mode, driver);
    check.numbers = {{"width", mode.w}, {"height", mode.h}, {"refresh_hz", mode.refresh_rate}};
    if (is_real(driver)) {
        check.status = CheckStatus::ok;
        check.remedy.clear();
    }
    return check;
}

Check check_audio() {
    Check check{.name = "audio",
                .status = CheckStatus::warn,
                .detail = "none",
                .remedy =
                    "masking noise will need it: connect headphones, and see that ALSA, PulseAudio "
                    "or PipeWire runs for this user"};
    const Hush hush;
    const Subsystem audio(SDL_INIT_AUDIO, SDL_InitSubSystem(SDL_INIT_AUDIO) == 0);
    if (!audio.works()) {
        return check;
    }
    const std::optional<SDL_AudioSpec> got = default_audio();
    if (!got) {
        check.detail = fmt::format("cannot be opened: {}", SDL_GetError());
        return check;
    }
    const char* driver = SDL_GetCurrentAudioDriver();
    check.detail =
        fmt::format("{} Hz, {} channels, driver {}", got->freq, static_cast<int>(got->channels),
                    driver == nullptr ? "none" : driver);
    check.numbers = {{"rate_hz", got->freq}, {"channels", got->channels}};
    if (is_real(driver)) {
        check.status = CheckStatus::ok;
        check.remedy.clear();
    }
    return check;
}

Check check_font(const std::string& asked) {
    Check check{.name = "font"};
    try {
        check.detail = find_font(asked);
    } catch (const std::exception& e) {
        check.detail = "none";
        check.fails(e.what());
    }
    return check;
}

}  // namespace palpate::ui

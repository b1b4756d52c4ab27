#include "ui/session/screen_words.hpp"

#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "ui/subject/display.hpp"

namespace palpate::ui {
namespace {

/// @throws std::invalid_argument if there is no such monitor, or SDL would put the window on
/// another
void require_monitor(const std::vector<std::string>& monitors, std::size_t number) {
    std::string all;
    for (std::size_t i = 0; i < monitors.size(); ++i) {
        all += fmt::format("{}{}: {}", i == 0 ? "" : "; ", i + 1, monitors[i]);
    }
    if (number > monitors.size()) {
        throw std::invalid_argument(fmt::format("--monitor {}: there {} {} ({}): give one of them",
                                                number, monitors.size() == 1 ? "is" : "are",
                                                monitors.size(), all));
    }
    const auto place = [&](std::size_t i) {
        return monitors[i].substr(monitors[i].rfind(" at "));
    };
    for (std::size_t i = 0; i + 1 < number; ++i) {
        if (place(i) == place(number - 1)) {
            throw std::invalid_argument(fmt::format(
                "--monitor {}: monitor {} is at the same place ({}): leave it out if they show the "
                "same, or name a screen of its own by DISPLAY, as :0.1",
                number, i + 1, all));
        }
    }
}

}  // namespace

void add_screen_words(CommandWords& words, ScreenOptions& screen) {
    words.add("--headless", screen.headless,
              "No window: the simulated observer answers (so does it without a display)");
    words.add("--fullscreen", screen.fullscreen, "The subject's window fills the display");
    words
        .add("--windowed", screen.windowed,
             "It does not; without either word it does in real sessions")
        .excludes("--fullscreen");
    words
        .add("--monitor", screen.monitor,
             "Number of the monitor for the subject's window; palpate doctor names them")
        .above_zero();
    words.add("--font", screen.font, "A TrueType font for the subject's screen");
    words
        .add(
            "--speed", screen.speed,
            "Simulated and replayed hands at this multiple of real time; 0: as fast as the machine")
        .from_zero();
}

bool wants_window(const ScreenOptions& screen) {
    if (screen.headless) {
        return false;
    }
    const FoundDisplay found = find_display();
    if (found.state == FoundDisplay::State::broken) {
        throw std::invalid_argument(found.trouble);
    }
    if (found.state == FoundDisplay::State::ready && screen.monitor > 0) {
        require_monitor(found.monitors, static_cast<std::size_t>(screen.monitor));
    }
    return found.state == FoundDisplay::State::ready;
}

}  // namespace palpate::ui

#include "ui/cli/device_choice.hpp"

#include <charconv>
#include <stdexcept>

#include <fmt/format.h>

namespace palpate::ui {

DeviceChoice parse_device(std::string_view text) {
    constexpr std::string_view kReplay = "replay:";
    if (text == "sim") {
        return {};
    }
    if (text == "mouse") {
        return {.kind = DeviceChoice::Kind::mouse, .file = {}, .trial = {}};
    }
    if (!text.starts_with(kReplay) || text.size() == kReplay.size()) {
        throw std::invalid_argument(fmt::format(
            "--device {}: no such device; give sim, mouse, or replay:FILE[:TRIAL]", text));
    }
    DeviceChoice choice{.kind = DeviceChoice::Kind::replay,
                        .file = std::string(text.substr(kReplay.size())),
                        .trial = {}};
    const std::size_t colon = choice.file.rfind(':');
    if (colon != std::string::npos && colon > 0 && colon + 1 < choice.file.size()) {
        const char* begin = choice.file.data() + colon + 1;
        const char* end = choice.file.data() + choice.file.size();
        std::int64_t trial = 0;
        const auto [stop, error] = std::from_chars(begin, end, trial);
        if (error == std::errc{} && stop == end) {
            choice.trial = trial;
            choice.file.resize(colon);
        }
    }
    return choice;
}

}  // namespace palpate::ui

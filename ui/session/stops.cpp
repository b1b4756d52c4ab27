#include "ui/session/stops.hpp"

#include <filesystem>

#include <fmt/format.h>

#include "protocols/session/trouble.hpp"
#include "ui/rig/interrupt.hpp"
#include "ui/rig/say.hpp"
#include "ui/subject/display.hpp"

namespace palpate::ui {

std::unique_ptr<StopLines> stop_lines(const data::Database& database,
                                      const RigSpec& spec,
                                      protocols::Apparatus& apparatus,
                                      protocols::OperatorDesk& desk,
                                      LiveSession& live) {
    const bool screen = live.board().facts().screen;
    const auto stop = [&apparatus, &desk, screen](const char* way) {
        desk.stop(way);
        apparatus.stop(engine::Trip::stopped);
        say("Stopped ({}): no force {}.\n", way,
            screen ? "until Ctrl+Shift+P at the participant's screen" : "any more in this trial");
    };
    const auto bar = [&desk](const char* why) {
        desk.bar(why);
    };
    return std::make_unique<StopLines>(
        database.file(),
        fmt::format("{}, participant {}, {}{}\n", spec.study.protocol.id, spec.key.participant,
                    std::filesystem::absolute(database.file()).string(),
                    screen ? ": Ctrl+Shift+P at the participant's screen goes on" : ""),
        spec.stop_button,
        StopLines::Acts{
            .stop = stop,
            .bar = bar,
            .types = screen || spec.stop_button,
            .obey = [&live](const std::string& line, const std::shared_ptr<Caller>& caller) {
                live.hear(line, caller);
            }});
}

void keep_screen(protocols::Observer& screen, protocols::OperatorDesk& desk, const char* why) {
    warn(
        "{}\nThe participant's screen says \"one moment\". Enter here, or Ctrl+Shift+Q then Y "
        "there, closes it.",
        why);
    static_cast<void>(desk.take_stop());
    while (!display_lost() && !interrupted() && desk.take_stop() == nullptr &&
           screen.trouble({.sentence = why}) != protocols::Signal::abort) {
        protocols::sleep_for(protocols::kTroubleSlice);
    }
}

}  // namespace palpate::ui

#include "ui/session/rig_parts.hpp"

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "protocols/design/session_plan.hpp"
#include "protocols/observer/simulated_observer.hpp"
#include "protocols/session/trouble.hpp"
#include "protocols/session/trust.hpp"
#include "protocols/trial/servo_apparatus.hpp"
#include "data/store/chain.hpp"
#include "ui/rig/interrupt.hpp"
#include "ui/rig/json_line.hpp"
#include "ui/rig/say.hpp"
#include "ui/subject/display.hpp"
#include "ui/subject/font.hpp"
#include "ui/subject/subject_screen.hpp"

namespace palpate::ui {
namespace {

/// @throws std::invalid_argument if there is no such monitor, or SDL would put the window on
/// another
void require_monitor(const std::vector<std::string>& monitors, std::size_t number) {
    std::string all;
    for (std::size_t i = 0; i < monitors.size(); ++i) {
        all += fmt::format("{}{}: {}", i == 0 ? "" : "; ", i + 1, monitors[i]);
    }
    refuse_if(number > monitors.size(), "--monitor {}: there {} {} ({}): give one of them", number,
              monitors.size() == 1 ? "is" : "are", monitors.size(), all);
    const auto place = [&](std::size_t i) {
        return monitors[i].substr(monitors[i].rfind(" at "));
    };
    for (std::size_t i = 0; i + 1 < number; ++i) {
        refuse_if(place(i) == place(number - 1),
                  "--monitor {}: monitor {} is at the same place ({}): leave it out if they show "
                  "the same, or name a screen of its own by DISPLAY, as :0.1",
                  number, i + 1, all);
    }
}

std::string word_of(const std::vector<std::pair<std::string, std::string>>& words,
                    std::string_view key) {
    const auto found = std::ranges::find(words, key, &std::pair<std::string, std::string>::first);
    return found == words.end() ? "" : found->second;
}

SubjectScreenOptions screen_options(const RunningRig& rig) {
    const RigSpec& spec = rig.spec;
    SubjectScreenOptions options;
    options.desk = &rig.desk;
    options.window.fullscreen =
        spec.screen.fullscreen || (spec.kind == data::RunKind::real && !spec.screen.windowed);
    options.window.monitor = spec.screen.monitor;
    options.window.font = spec.screen.font;
    options.window.language = spec.study.protocol.language;
    options.window.instructions =
        spec.study.protocol.instructions.at(static_cast<std::size_t>(spec.study.protocol.language));
    options.asks = spec.study.protocol.response.kind;
    options.gate = protocols::StartGate(spec.study.protocol);
    options.place = [rig] {
        return rig.apparatus.place();
    };
    options.watermark = spec.kind == data::RunKind::simulated ? "SIMULATED"
                      : unproved(spec)                        ? "PILOT, NOT PROVED: 0.3 N"
                      : spec.kind == data::RunKind::pilot     ? "PILOT"
                                                              : "";
    options.interrupted = [rig] {
        rig.live.pump();
        return interrupted();
    };
    options.guard_s = spec.study.protocol.timing.guard;
    options.dead_man = spec.study.protocol.safety.dead_man && gives_force(spec.device.kind);
    options.on_hold = [rig](bool held) {
        rig.apparatus.hold(held);
    };
    options.on_stop = [rig](engine::Trip cause, const char* way) {
        rig.desk.stop(way);
        rig.apparatus.stop(cause);
    };
    options.on_close = [] {
        say("The participant's window was to be closed, and stays: Ctrl+Shift+Q there, then Y, "
            "ends the "
            "session.\n");
    };
    if (auto* pointer = dynamic_cast<protocols::PointerApparatus*>(&rig.apparatus)) {
        options.on_pointer = [pointer](const engine::Vec2& position) {
            pointer->pointer().publish(position);
        };
    }
    return options;
}

OpenedMasking silent(const std::string& why) {
    warn("no masking noise: {}", why);
    return {.player = nullptr, .note = "none: " + why};
}

}  // namespace

void add_screen_words(CommandWords& words, ScreenOptions& screen) {
    words.add("--headless", screen.headless,
              "No window: the simulated observer answers (so does it without a display)");
    words.add("--fullscreen", screen.fullscreen, "The subject's window fills the display")
        .excludes("--headless");
    words
        .add("--windowed", screen.windowed,
             "It does not; without either word it does in real sessions")
        .excludes("--fullscreen")
        .excludes("--headless");
    words
        .add("--monitor", screen.monitor,
             "Number of the monitor for the subject's window; palpate doctor names them")
        .above_zero()
        .excludes("--headless");
    words.add("--font", screen.font, "A TrueType font for the subject's screen")
        .excludes("--headless");
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
    refuse_if(found.state == FoundDisplay::State::broken, "{}", found.trouble);
    const bool ready = found.state == FoundDisplay::State::ready;
    if (ready && screen.monitor > 0) {
        require_monitor(found.monitors, static_cast<std::size_t>(screen.monitor));
    }
    if (ready || !screen.font.empty()) {
        static_cast<void>(find_font(screen.font));
    }
    return ready;
}

LiveFacts live_facts(const RigSpec& spec,
                     const OpenedApparatus& felt,
                     data::Database& database,
                     const data::OpenedSession& opened) {
    data::Statement row =
        database.first("SELECT uuid FROM session WHERE session_id = ?1", opened.id);
    const auto check =
        std::ranges::find(felt.opening, protocols::kRigCheck, &protocols::Event::key);
    const auto round_trip =
        felt.round_trip > 0.0 ? std::optional(1e6 * felt.round_trip) : std::nullopt;
    return {.uuid = row.text(0),
            .file = std::filesystem::absolute(database.file()).string(),
            .session = one_line({{"session", row.text(0)},
                                 {"kind", to_string(spec.kind)},
                                 {"participant", spec.key.participant},
                                 {"number", spec.key.session},
                                 {"protocol", spec.study.protocol.id},
                                 {"title", spec.study.protocol.title}}),
            .device = one_line(
                {{"name", felt.port->device_name()},
                 {"calibration", json_or_null(word_of(felt.provenance, "calibration name"))},
                 {"round_trip_us", json_or_null(round_trip)},
                 {"check", json_or_null(check == felt.opening.end() ? "" : check->value)},
                 {"watchdog", json_or_null(word_of(felt.provenance, "device watchdog"))}}),
            .operator_name = spec.operator_name,
            .gives_force = gives_force(spec.device.kind),
            .answered = opened.progress.pending().answered(),
            .left = opened.progress.pending().order().size()};
}

Observers observers_before_the_plan(const RunningRig& rig) {
    if (!wants_window(rig.spec.screen) || rig.spec.watch_only) {
        return {};
    }
    return {.simulated = nullptr, .screen = std::make_unique<SubjectScreen>(screen_options(rig))};
}

void add_simulated_observer(Observers& observers,
                            const RunningRig& rig,
                            const protocols::Plan& plan) {
    if (observers.screen) {
        return;
    }
    const RigSpec& spec = rig.spec;
    observers.simulated = std::make_unique<protocols::SimulatedObserver>(
        spec.study.protocol, protocols::session_stream(spec.study.hash, spec.key, spec.seed),
        plan.picture_order, [rig] { return rig.apparatus.hand_is_done(); });
    if (wants_window(spec.screen)) {
        SubjectScreenOptions options = screen_options(rig);
        options.on_close = {};
        observers.screen = spectator_screen(*observers.simulated, options);
    }
}

OpenedMasking open_masking(const RigSpec& spec) {
    const protocols::MaskingSpec& asked = spec.study.protocol.masking;
    if (asked.noise == protocols::Noise::none || !held_by_a_person(spec.device.kind)) {
        return {};
    }
    if (spec.screen.no_sound) {
        return silent("--no-sound was given");
    }
    OpenedMasking opened{
        .player = nullptr, .note = {}, .required = spec.kind == data::RunKind::real};
    try {
        opened.player =
            open_noise(asked, protocols::session_stream(spec.study.hash, spec.key, spec.seed));
    } catch (const std::runtime_error& error) {
        if (opened.required) {
            throw;
        }
        return silent(error.what());
    }
    opened.note = opened.player->name();
    if (!opened.player->audible()) {
        refuse_if<std::runtime_error>(opened.required,
                                      "masking noise ({}) would reach nobody: leave "
                                      "SDL_AUDIODRIVER unset, or give --no-sound",
                                      opened.note);
        warn("the masking noise ({}) reaches nobody", opened.note);
    }
    return opened;
}

std::unique_ptr<StopLines> stop_lines(const data::Database& database, const RunningRig& rig) {
    const RigSpec& spec = rig.spec;
    const bool screen = rig.live.board().facts().screen;
    const auto stop = [rig, screen](const char* way) {
        rig.desk.stop(way);
        rig.apparatus.stop(engine::Trip::stopped);
        say("Stopped ({}): no force {}.\n", way,
            screen ? "until Ctrl+Shift+P at the participant's screen" : "any more in this trial");
    };
    return std::make_unique<StopLines>(
        database.file(),
        fmt::format("{}, participant {}, {}{}\n", spec.study.protocol.id, spec.key.participant,
                    std::filesystem::absolute(database.file()).string(),
                    screen ? ": Ctrl+Shift+P at the participant's screen goes on" : ""),
        spec.stop_button,
        StopLines::Acts{.stop = stop,
                        .bar = [rig](const char* why) { rig.desk.bar(why); },
                        .doubts = [rig] { return rig.desk.force_doubted(); },
                        .types = screen || spec.stop_button,
                        .obey =
                            [rig](const std::string& line, const std::shared_ptr<Caller>& caller) {
                                rig.live.hear(line, caller);
                            }});
}

std::size_t said_breaks(data::Database& database, const data::OpenedSession& opened) {
    const std::vector<data::ChainBreak> broken = data::chain_breaks(database, opened.id);
    if (!broken.empty()) {
        warn(
            "{}: this session was changed by hand before it goes on here: {} of it {} not hold, "
            "first {} of {}; palpate verify says what differs",
            database.file(), counted(broken.size(), "seal"), broken.size() == 1 ? "does" : "do",
            broken.front().what,
            broken.front().trial == 0 ? "the session"
                                      : fmt::format("trial {}", broken.front().trial));
    }
    return broken.size();
}

void keep_screen(protocols::Observer& screen, protocols::OperatorDesk& desk, const char* why) {
    warn(
        "{}\nThe participant's screen says \"one moment\". Enter here, or Ctrl+Shift+Q then Y "
        "there, closes it.",
        why);
    static_cast<void>(desk.take_stop());
    const auto closed = [&desk] {
        const char* way = desk.take_stop();
        return way != nullptr && way != std::string_view(protocols::kEscapeAtScreen);
    };
    while (!display_lost() && !interrupted() && !closed() &&
           screen.trouble({.sentence = why}) != protocols::Signal::abort) {
        protocols::sleep_for(protocols::kTroubleSlice);
    }
}

}  // namespace palpate::ui

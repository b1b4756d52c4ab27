#include "ui/session/observers.hpp"

#include "protocols/design/session_plan.hpp"
#include "protocols/observer/simulated_observer.hpp"
#include "protocols/trial/servo_apparatus.hpp"
#include "ui/rig/interrupt.hpp"
#include "ui/rig/say.hpp"
#include "ui/session/open_apparatus.hpp"
#include "ui/session/screen_words.hpp"
#include "ui/subject/display.hpp"
#include "ui/subject/spectator_screen.hpp"
#include "ui/subject/subject_screen.hpp"

namespace palpate::ui {
namespace {

std::unique_ptr<protocols::Observer> make_simulated_observer(
    const RigSpec& spec, const protocols::Plan& plan, const protocols::Apparatus& apparatus) {
    return std::make_unique<protocols::SimulatedObserver>(
        spec.study.protocol, protocols::session_stream(spec.study.hash, spec.key, spec.seed),
        plan.picture_order, [&apparatus] { return apparatus.hand_is_done(); });
}

SubjectScreenOptions screen_options(const RigSpec& spec,
                                    protocols::Apparatus& apparatus,
                                    protocols::OperatorDesk& desk,
                                    LiveSession& live) {
    SubjectScreenOptions options;
    options.desk = &desk;
    options.window.fullscreen =
        spec.screen.fullscreen || (spec.kind == data::RunKind::real && !spec.screen.windowed);
    options.window.monitor = spec.screen.monitor;
    options.window.font = spec.screen.font;
    options.window.language = spec.study.protocol.language;
    options.window.instructions =
        spec.study.protocol.instructions.at(static_cast<std::size_t>(spec.study.protocol.language));
    options.asks = spec.study.protocol.response.kind;
    options.start = spec.study.protocol.apparatus.start;
    options.gate = protocols::StartGate(spec.study.protocol);
    options.place = [&apparatus] {
        return apparatus.place();
    };
    options.watermark = spec.kind == data::RunKind::simulated ? "SIMULATED"
                      : unproved(spec)                        ? "PILOT, NOT PROVED: 0.3 N"
                      : spec.kind == data::RunKind::pilot     ? "PILOT"
                                                              : "";
    options.interrupted = [&live] {
        live.pump();
        return interrupted();
    };
    options.guard_s = spec.study.protocol.timing.guard;
    options.dead_man = spec.study.protocol.safety.dead_man && gives_force(spec.device.kind);
    options.on_hold = [&apparatus](bool held) {
        apparatus.hold(held);
    };
    options.on_stop = [&apparatus, &desk](engine::Trip cause, const char* way) {
        desk.stop(way);
        apparatus.stop(cause);
    };
    options.on_close = [] {
        say("The participant's window was to be closed, and stays: Ctrl+Shift+Q there, then Y, "
            "ends the "
            "session.\n");
    };
    if (auto* pointer = dynamic_cast<protocols::PointerApparatus*>(&apparatus)) {
        options.on_pointer = [pointer](const engine::Vec2& position) {
            pointer->pointer().publish(position);
        };
    }
    return options;
}

}  // namespace

Observers observers_before_the_plan(const RigSpec& spec,
                                    protocols::Apparatus& apparatus,
                                    protocols::OperatorDesk& desk,
                                    LiveSession& live) {
    if (!wants_window(spec.screen) || spec.watch_only) {
        return {};
    }
    return {.simulated = nullptr,
            .screen = std::make_unique<SubjectScreen>(screen_options(spec, apparatus, desk, live))};
}

void add_simulated_observer(Observers& observers,
                            const RigSpec& spec,
                            const protocols::Plan& plan,
                            protocols::Apparatus& apparatus,
                            protocols::OperatorDesk& desk,
                            LiveSession& live) {
    if (observers.screen) {
        return;
    }
    observers.simulated = make_simulated_observer(spec, plan, apparatus);
    if (wants_window(spec.screen)) {
        observers.screen = std::make_unique<SpectatorScreen>(
            *observers.simulated, screen_options(spec, apparatus, desk, live));
    }
}

}  // namespace palpate::ui

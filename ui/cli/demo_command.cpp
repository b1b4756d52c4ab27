#include <fmt/format.h>

#include "data/analysis/summary.hpp"
#include "ui/cli/commands.hpp"
#include "ui/cli/interrupt.hpp"
#include "ui/cli/rig.hpp"

namespace palpate::ui {
namespace {

constexpr const char* kProtocol = "shape_friction_demo";
constexpr const char* kParticipant = "demo";
/// In a window the hand moves at this multiple of real time: ten trials in about a minute.
constexpr double kWindowSpeed = 3.0;

}  // namespace

int demo_command(const DemoOptions& options) {
    RigSpec spec;
    spec.study = load_study(kProtocol);
    spec.screen = options.screen;
    spec.watch_only = true;
    if (wants_window(options.screen) && spec.screen.speed == 0.0) {
        spec.screen.speed = kWindowSpeed;
    }
    data::Database database(options.database, data::Access::write);
    spec.key.participant = kParticipant;
    const auto last = data::latest_session(database, spec.study.protocol.id, kParticipant);
    if (last) {  // a finished demo is followed by another session, an unfinished one goes on
        spec.key.session = last->finished ? last->number + 1 : last->number;
    }
    spec.seed =
        options.seed.value_or(last && !last->finished ? last->seed : spec.study.protocol.seed);

    fmt::print("Ten trials of the study. The participant and the device are simulated.\n");
    catch_signals();
    const RigEnd end = run_rig(database, spec);
    if (end.session.why != protocols::SessionEnd::Why::finished) {
        fmt::print("Stopped before trial {}; the same command goes on there. Data: {}\n",
                   end.session.next + 1, options.database);
        return kExitStopped;
    }
    fmt::print("\n{}\n{}", data::summary_text(database), data::example_queries(options.database));
    return 0;
}

}  // namespace palpate::ui

#include <stdexcept>

#include "protocols/file/protocol_file.hpp"
#include "data/analysis/summary.hpp"
#include "data/store/secret.hpp"
#include "ui/command/command.hpp"
#include "ui/rig/interrupt.hpp"
#include "ui/rig/open_device.hpp"
#include "ui/rig/operator_log.hpp"
#include "ui/rig/say.hpp"
#include "ui/session/rig_parts.hpp"
#include "ui/session/run_rig.hpp"

namespace palpate::ui {
namespace {

struct DemoOptions {
    std::string database = "palpate-demo.sqlite";
    std::string device = "sim";  ///< sim or haply-emulator
    std::optional<std::uint64_t> seed;
    ScreenOptions screen{};
};

constexpr const char* kProtocol = "shape_friction_demo";
constexpr const char* kHaplyProtocol = "shape_friction_haply";
constexpr const char* kParticipant = "demo";
/// In a window the hand moves at this multiple of real time: ten trials in about a minute.
constexpr double kWindowSpeed = 3.0;

/// Ten trials of a study: each object once without and once with friction.
Study ten_trials_of(Study study) {
    study.protocol.id += "_demo";
    study.protocol.design.repetitions = 1;
    study.protocol.design.practice_repetitions = 0;
    study.protocol.design.catch_trials = 0;
    study.protocol.design.break_every = 0;
    study.protocol.timing.gap = 0.2;
    std::erase_if(study.protocol.objects,
                  [](const protocols::ObjectSpec& object) { return !object.pictured; });
    study.hash = protocols::protocol_hash(study.protocol);
    return study;
}

void declare(CommandWords& words, DemoOptions& options) {
    words.add("--db", options.database, "Where the data goes");
    words
        .add("--device", options.device,
             "sim, or haply-emulator: in real time over a serial port, with board and guard as "
             "processes of their own")
        .among({"sim", "haply-emulator"});
    words.add("--seed", options.seed, "Study seed instead of the protocol's");
    add_screen_words(words, options.screen);
}

RigSpec rig_of(const DemoOptions& options) {
    RigSpec spec;
    spec.device = parse_device(options.device);
    spec.rig = rig_file_of(spec.device, "");
    const bool emulated = spec.device.kind == DeviceChoice::Kind::haply_emulator;
    spec.study = emulated ? ten_trials_of(load_study(kHaplyProtocol)) : load_study(kProtocol);
    spec.screen = options.screen;
    spec.watch_only = true;
    spec.another = spec.new_version = true;  // nobody is run
    if (wants_window(options.screen) && spec.screen.speed == 0.0) {
        spec.screen.speed = kWindowSpeed;
    }
    return spec;
}

/// Goes on with a demo that was not finished, or begins another session.
void follow_last(data::Database& database, const DemoOptions& options, RigSpec& spec) {
    spec.key.participant = kParticipant;
    const auto last = data::find_session(database, spec.study.protocol.id, kParticipant);
    if (last) {  // a finished demo is followed by another session, an unfinished one goes on
        spec.key.session = last->over.empty() ? last->number : last->number + 1;
    }
    const bool goes_on = last && last->over.empty();
    spec.key.secret = goes_on ? last->run_as.secret : std::string(data::kDemoSecret);
    spec.seed = options.seed.value_or(goes_on ? last->seed : spec.study.protocol.seed);
}

int run(const DemoOptions& options) {
    catch_signals();
    say_in_passing();
    RigSpec spec = rig_of(options);
    const bool emulated = spec.device.kind == DeviceChoice::Kind::haply_emulator;
    data::Database database(options.database, data::Access::write);
    follow_last(database, options, spec);

    say("Ten trials of the study. The participant and the device are simulated.\n");
    if (emulated) {
        say("In real time, over a serial port to an emulated board: about two minutes.\n");
    }
    const RigEnd end = run_rig(database, spec);
    if (!finished(end.session)) {
        say("Stopped before {}; the same command goes on there. Data: {}\n",
            number_text(end.session.number), options.database);
        return kExitStopped;
    }
    say("\n{}\n{}", data::summary_text(database), data::example_queries(options.database));
    return 0;
}

}  // namespace

Command demo_command() {
    return make_command<DemoOptions>(
        "demo", "Ten trials of the study with a simulated hand and observer", declare, run);
}

}  // namespace palpate::ui

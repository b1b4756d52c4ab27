#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <system_error>

#include <fmt/format.h>

#include "engine/base/files.hpp"
#include "engine/base/refuse.hpp"
#include "protocols/design/session_plan.hpp"
#include "protocols/file/calibration_file.hpp"
#include "protocols/file/keys.hpp"
#include "protocols/procedure/quest_plus.hpp"
#include "data/store/disk_space.hpp"
#include "data/store/secret.hpp"
#include "ui/command/command.hpp"
#include "ui/rig/device_choice.hpp"
#include "ui/rig/interrupt.hpp"
#include "ui/rig/open_device.hpp"
#include "ui/rig/operator_log.hpp"
#include "ui/rig/rig_proof.hpp"
#include "ui/rig/say.hpp"
#include "ui/session/begin_session.hpp"
#include "ui/session/rig_parts.hpp"
#include "ui/session/run_rig.hpp"
#include "ui/session/session_choice.hpp"

namespace palpate::ui {
namespace {

struct RunOptions {
    std::vector<std::string> words;  ///< the whole command line
    std::string protocol;            ///< a file, or the name of a shipped protocol
    std::string participant;
    std::string database;
    std::string device = "sim";  ///< see parse_device
    std::string
        calibration;   ///< a calibration file or a shipped machine's name; empty: the device's own
    std::string kind;  ///< pilot, real; empty: what the device is
    std::optional<std::size_t> session;
    bool elsewhere = false;  ///< the sessions before that one are in another file
    std::optional<std::uint64_t> seed;
    std::optional<std::string> secret;  ///< for the file, if it has no session yet
    std::string resume = "continue";
    std::string stop_button;  ///< a device of evdev; empty: the rig has none
    RigSpec rig{};            ///< what words say of it as it is
};

/// Of what a person holds. Without force it is a try, unless the study is about the pointer.
data::RunKind kind_by_hand(const RunOptions& options,
                           const DeviceChoice& device,
                           const protocols::Protocol& protocol) {
    const bool forceless =
        !gives_force(device.kind) && protocol.apparatus.device != protocols::DeviceClass::mouse;
    if (!forceless || !options.kind.empty()) {
        refuse_if(forceless && options.kind == "real" &&
                      protocol.apparatus.device == protocols::DeviceClass::any,
                  "--device {} gives no force, and this protocol does not ask for it by device = "
                  "\"mouse\" in [apparatus]: use a device with force, or run it with --kind pilot",
                  options.device);
        return options.kind == "pilot" ? data::RunKind::pilot : data::RunKind::real;
    }
    warn("--device {} gives no force: the session is recorded as pilot, not real", options.device);
    return data::RunKind::pilot;
}

data::RunKind kind_of(const RunOptions& options,
                      const DeviceChoice& device,
                      const Behind& there,
                      const protocols::Protocol& protocol) {
    const bool person = wants_window(options.rig.screen);
    refuse_if(held_by_a_person(device.kind) && !person,
              "--device {} needs a display and a window: set DISPLAY and leave --headless out, or "
              "use --device sim",
              options.device);
    if (!held_by_a_person(device.kind)) {
        if (!options.kind.empty()) {
            warn("the hand is simulated: the session is recorded as simulated, not {}",
                 options.kind);
        }
        return data::RunKind::simulated;
    }
    const Behind board = options.kind.empty() ? there : Behind{};
    if (board.emulator) {
        warn(
            "behind --device {} is palpate haply-emulator, process {}: the session is recorded as "
            "simulated; --kind pilot and --kind real record it otherwise",
            options.device, *board.emulator);
        return data::RunKind::simulated;
    }
    refuse_if(board.unseen,
              "behind --device {} is a program that this user cannot see, and it may be an "
              "emulator: give --kind real if it leads to a board, else --kind pilot",
              options.device);
    return kind_by_hand(options, device, protocol);
}

void check_device(const RunOptions& options, const RigSpec& spec) {
    const protocols::DeviceClass asked = spec.study.protocol.apparatus.device;
    refuse_if(spec.kind == data::RunKind::real && !fits(asked, spec.device.kind),
              "this protocol asks for the device \"{}\", and --device is {}: use that device, or "
              "run it with --kind pilot",
              protocols::word_of(asked), options.device);
}

/// A number that leaves a gap is a slip, unless the sessions before are in the file of another rig.
/// Looked at before a file is made.
void check_number(const RunOptions& options, const std::string& study) {
    if (options.elsewhere || options.session.value_or(1) == 1) {
        return;
    }
    std::size_t last = 0;
    if (std::error_code unknown; std::filesystem::exists(options.database, unknown)) {
        data::Database there(options.database, data::Access::inspect);
        const auto state = data::find_session(there, study, options.participant);
        last = state ? state->number : 0;
    }
    refuse_if(*options.session > last + 1,
              "{}: {} has {} of {} so far, and --session is {}: give --session {}, or --elsewhere "
              "as well if the sessions before are in another file",
              options.database, options.participant,
              last == 0 ? "no session" : fmt::format("sessions up to {}", last), study,
              *options.session, last + 1);
}

void declare(CommandWords& words, RunOptions& options) {
    options.words = words.line;
    words.add("PROTOCOL", options.protocol, "A protocol file, or the name of a shipped one")
        .required();
    words.add("--participant", options.participant, "Pseudonymous id: letters, digits, - and _")
        .required();
    words.add("--db", options.database, "The study's database file; made if it is not there")
        .required();
    words.add("--device", options.device, std::string(kDeviceWords));
    words.add("--calibration", options.calibration, std::string(kCalibrationWords));
    words
        .add("--kind", options.kind,
             "pilot or real; left out: real, without force pilot, and simulated where hand or "
             "board is")
        .among({"pilot", "real"});
    words.add("--session", options.session, "Session number; without it the last one goes on")
        .above_zero();
    words.add("--elsewhere", options.elsewhere,
              "The sessions before that number are in another file; which order of pictures they "
              "had is not known here");
    words.add("--another", options.rig.another,
              "The participant is somebody new, although a code in the file is much like it");
    words.add("--seed", options.seed, "Study seed instead of the protocol's");
    words.add("--secret", options.secret,
              "For a new file: what all its orders are drawn with, 32 hexadecimal digits, instead "
              "of random ones. For rigs that share a study, or to repeat a simulated session to "
              "the bit. Whoever knows it can tell whose an exported order is");
    words.add("--operator", options.rig.operator_name, "Who runs it, kept with the session")
        .kept_text();
    words
        .add("--resume", options.resume,
             "A session that was broken off goes on with the next trial, with the first of its "
             "block, or with the practice; answers of what is begun again do not count")
        .among({data::kResumeWords.begin(), data::kResumeWords.end()});
    words.add("--new-version", options.rig.new_version,
              "The protocol was changed on purpose since the last person of this file ran it; "
              "analyses keep its versions apart");
    words.add("--other-device", options.rig.other_device,
              "A session that was begun goes on also with another device or calibration than its "
              "last trial had; without the word a terminal is asked, and anything else refused");
    words.add("--console", options.rig.console, "Serves the page of palpate console as well");
    words.add("--durable", options.rig.durable,
              "Save ticks more often: after a power cut at most 45 ms are lost, not 120 ms");
    words
        .add("--spin", options.rig.spin_share,
             "Share of each tick to watch the clock instead of sleeping, for haply and comedi: 0.3 "
             "wakes up on time to a microsecond and costs processor time")
        .within(0.0, 0.5)
        .with_default();
    words.add("--handle-free", options.rig.handle_free,
              "Says beforehand that nobody holds the handle and that it rests at home: a rig that "
              "was commissioned is then opened without a question, and without its second mark");
    words.add("--stop-button", options.stop_button, std::string(kStopButtonWords));
    words.add("--no-sound", options.rig.screen.no_sound,
              "No masking noise, whatever the protocol asks for; recorded with the session");
    add_screen_words(words, options.rig.screen);
}

/// All that can be refused before a file is made or a device is touched, refused.
RigSpec rig_spec(const RunOptions& options) {
    RigSpec spec = options.rig;
    spec.key.participant = options.participant;
    protocols::announce_large_tables([](double megabytes) {
        say("Computing the table of QUEST+, {:.0f} MB: it can take half a minute.\n", megabytes);
    });
    spec.study = load_study(options.protocol);
    spec.device = parse_device(options.device);
    spec.rig = rig_file_of(spec.device, options.calibration);
    require_fit(spec.study.protocol, spec.device, spec.rig.calibration.axes());
    const auto resume =
        std::find(data::kResumeWords.begin(), data::kResumeWords.end(), options.resume);
    spec.resume = static_cast<data::Resume>(resume - data::kResumeWords.begin());
    spec.go_on = go_on_command(options.words);
    spec.behind = behind(spec.device);
    spec.kind = kind_of(options, spec.device, *spec.behind, spec.study.protocol);
    check_device(options, spec);
    check_record(spec, options.device, options.calibration);
    check_number(options, spec.study.protocol.id);
    if (wants_window(options.rig.screen) && spec.screen.speed == 0.0) {
        spec.screen.speed = 1.0;
    }
    spec.stop_button = named_button(options.stop_button);
    spec.recordings =
        load_recordings(spec.device);  // what is missing is said before a file is made
    return spec;
}

/// Of a session that begins: before a device is touched and a file is made.
void check_space(const RunOptions& options, const Study& study) {
    const protocols::Plan plan = make_plan(study.protocol, study.hash, {options.participant, 1},
                                           options.seed.value_or(study.protocol.seed));
    data::require_space(options.database, study.protocol, plan.trials.size());
}

/// The session that goes on or begins: its key and seed are in `spec` from here on.
void choose(data::Database& database, const RunOptions& options, RigSpec& spec) {
    const SessionChoice choice =
        choose_session(database, spec.study, options.participant, options.session, options.seed);
    spec.key = choice.key;
    spec.seed = choice.seed;
    refuse_if(!choice.there.over.empty(),
              "{}: session {} of {} in {} {}; for another one give --session {}", options.database,
              spec.key.session, options.participant, spec.study.protocol.id, choice.there.over,
              choice.last + 1);
    require_kind(choice, spec.study, spec.kind, options.database);  // before a device is touched
    if (choice.there.begun) {
        return check_goes_on(database, spec);
    }
    check_space(options, spec.study);
}

/// What the experimenter reads at the end, and the code of the program's exit.
int say_end(const RigEnd& end, const RunOptions& options, const RigSpec& spec) {
    if (!end.head.empty()) {
        say("Seal {}: note it in the lab book, verify prints it.{}\n", end.head,
            end.broken ? " Note too that the session was changed before this run." : "");
    }
    if (!finished(end.session)) {
        say("Stopped before {}; the same command goes on there: {}\n",
            number_text(end.session.number), spec.go_on);
        return kExitStopped;
    }
    say("Finished. Data: {}\nNext: palpate summary {}\n", options.database,
        shell_word(options.database));
    return 0;
}

int run(const RunOptions& options) {
    catch_signals();
    say_in_passing();
    check_participant(options.participant);
    if (options.secret) {
        data::check_secret(*options.secret);
    }
    RigSpec spec = rig_spec(options);
    std::error_code unknown;
    std::optional<OpenedApparatus> felt;
    const bool fresh = !std::filesystem::exists(options.database, unknown);
    if (fresh && held_by_a_person(spec.device.kind)) {  // a device that is refused makes no file
        spec.said = admit(nullptr, options.database, spec);
        require_writable(options.database, "");
        check_space(options, spec.study);
        felt = open_and_check(spec);
    }
    data::Database database(options.database, data::Access::write);
    if (options.secret) {
        data::set_secret(database, *options.secret);
    }
    choose(database, options, spec);
    if (!felt) {
        spec.said = admit(&database, options.database, spec);
    }
    return say_end(run_rig(database, spec, std::move(felt)), options, spec);
}

}  // namespace

Command run_command() {
    return make_command<RunOptions>("run", "Run or resume a session of a protocol", declare, run);
}

}  // namespace palpate::ui

#include "ui/cli/options.hpp"

#include <cstdio>
#include <memory>
#include <sstream>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "data/store/stored_progress.hpp"
#include "ui/cli/options_of.hpp"
#include "ui/cli/version.hpp"
#include "ui/rig/device_choice.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {
namespace {

constexpr int kWrongWords = 2;
constexpr const char* kCalibrationWords =
    "A file by palpate calibrate, or haplet, 2diy_gen2, 2diy_gen3, mk2";

void add_screen(CLI::App& command, ScreenOptions& screen) {
    command.add_flag("--headless", screen.headless,
                     "No window: the simulated observer answers (so does it without a display)");
    CLI::Option* whole = command.add_flag("--fullscreen", screen.fullscreen,
                                          "The subject's window fills the display");
    command
        .add_flag("--windowed", screen.windowed,
                  "It does not; without either word it does in real sessions")
        ->excludes(whole);
    command.add_option("--font", screen.font, "A TrueType font for the subject's screen");
    command
        .add_option(
            "--speed", screen.speed,
            "Simulated and replayed hands at this multiple of real time; 0: as fast as the machine")
        ->check(CLI::NonNegativeNumber);
}

void add_run(CLI::App& app, Options& chosen) {
    CLI::App* command = app.add_subcommand("run", "Run or resume a session of a protocol");
    auto& run = options_of<RunOptions>(command, chosen);
    command->add_option("PROTOCOL", run.protocol, "A protocol file, or the name of a shipped one")
        ->required();
    command
        ->add_option("--participant", run.participant, "Pseudonymous id: letters, digits, - and _")
        ->required();
    command->add_option("--db", run.database, "The study's database file; made if it is not there")
        ->required();
    command->add_option("--device", run.device, std::string(kDeviceWords))->capture_default_str();
    command->add_option("--calibration", run.calibration, kCalibrationWords);
    command
        ->add_option("--kind", run.kind,
                     "pilot or real; what is simulated is recorded as simulated")
        ->check(one_of({"pilot", "real"}));
    command->add_option("--session", run.session, "Session number; without it the last one goes on")
        ->check(CLI::PositiveNumber);
    command->add_flag("--elsewhere", run.elsewhere,
                      "The sessions before that number are in another file; which order of "
                      "pictures they had is not known here");
    command->add_flag(
        "--another", run.another,
        "The participant is somebody new, although a code in the file is much like it");
    command->add_option("--seed", run.seed, "Study seed instead of the protocol's");
    command->add_option(
        "--secret", run.secret,
        "For a new file: what all its orders are drawn with, 32 hexadecimal digits, "
        "instead of random ones. For rigs that share a study, or to repeat a "
        "simulated session to the bit. Whoever knows it can tell whose an exported "
        "order is");
    command->add_option("--operator", run.operator_name, "Who runs it, kept with the session")
        ->check(kept_text);
    command
        ->add_option("--resume", run.resume,
                     "A session that was broken off goes on with the next trial, with the first of "
                     "its block, or with the practice; answers of what is begun again do not count")
        ->check(one_of({data::kResumeWords.begin(), data::kResumeWords.end()}))
        ->capture_default_str();
    command->add_flag(
        "--durable", run.durable,
        "Save ticks more often: after a power cut at most 45 ms are lost, not 120 ms");
    command
        ->add_option("--spin", run.spin,
                     "Share of each tick to watch the clock instead of sleeping, for haply and "
                     "comedi: 0.3 wakes up on time to a microsecond and costs processor time")
        ->check(CLI::Range(0.0, 0.5))
        ->capture_default_str();
    command->add_flag(
        "--no-sound", run.screen.no_sound,
        "No masking noise, whatever the protocol asks for; recorded with the session");
    add_screen(*command, run.screen);
}

void add_demo(CLI::App& app, Options& chosen) {
    CLI::App* command =
        app.add_subcommand("demo", "Ten trials of the study with a simulated hand and observer");
    auto& demo = options_of<DemoOptions>(command, chosen);
    command->add_option("--db", demo.database, "Where the data goes")->capture_default_str();
    command
        ->add_option(
            "--device", demo.device,
            "sim, or haply-emulator: in real time over a serial port, with board and guard "
            "as processes of their own")
        ->check(one_of({"sim", "haply-emulator"}))
        ->capture_default_str();
    command->add_option("--seed", demo.seed, "Study seed instead of the protocol's");
    add_screen(*command, demo.screen);
}

void add_calibrate(CLI::App& app, Options& chosen) {
    CLI::App* command = app.add_subcommand(
        "calibrate", "Find the encoders' zeros of a pantograph, and write its calibration file");
    auto& calibrate = options_of<CalibrateOptions>(command, chosen);
    command->add_option("--device", calibrate.device, "The device to calibrate; sim to try it out")
        ->capture_default_str();
    command
        ->add_option(
            "--preset", calibrate.preset,
            "What is known of it: a calibration file, or haplet, 2diy_gen2, 2diy_gen3, mk2")
        ->capture_default_str();
    command
        ->add_option("--mark", calibrate.marks,
                     "X_MM,Y_MM of a place where the handle will be held; once for each mark")
        ->allow_extra_args(false);
    command->add_flag("--scale", calibrate.scale,
                      "Find counts per turn as well: three marks or more, not in line");
    command->add_option("-o,--output", calibrate.output, "The calibration file to write")
        ->required();
}

void add_doctor(CLI::App& app, Options& chosen) {
    CLI::App* command = app.add_subcommand(
        "doctor", "Is this machine ready? Device, timing, rights, screen, sound, disk");
    auto& doctor = options_of<DoctorOptions>(command, chosen);
    command->add_option("--device", doctor.device, std::string(kDeviceWords))
        ->capture_default_str();
    command->add_option("--calibration", doctor.calibration, kCalibrationWords);
    command->add_option("--protocol", doctor.protocol,
                        "The protocol to be run: its rate, and whether the device can render it");
    command
        ->add_option(
            "--db", doctor.database,
            "Where the data will go: room and speed of its disk; nothing is written into it")
        ->capture_default_str();
    command->add_option("--font", doctor.font, "A TrueType font for the subject's screen");
    command
        ->add_option("--seconds", doctor.seconds,
                     "How long to measure the jitter; as long again with cyclictest installed")
        ->check(CLI::Range(0.05, 3600.0))
        ->capture_default_str();
    command->add_flag("--json", doctor.json, "One JSON object instead of lines");
}

void add_emulator(CLI::App& app, Options& chosen) {
    CLI::App* command = app.add_subcommand(
        "haply-emulator", "A Haply board that is not there, on a pseudo-terminal, until Ctrl-C");
    auto& emulator = options_of<EmulatorOptions>(command, chosen);
    command->add_option("--link", emulator.link,
                        "A symbolic link to its terminal, for --device haply:LINK");
    command
        ->add_option("--preset", emulator.preset,
                     "2diy_gen3, 2diy_gen2, haplet, or a calibration file")
        ->capture_default_str();
    command
        ->add_option("--delay-ms", emulator.delay_ms,
                     "How long after a packet its answer goes out, ms; a USB port needs about 1")
        ->check(CLI::Range(0.0, 1000.0))
        ->capture_default_str();
}

void add_screenshots(CLI::App& app, Options& chosen) {
    CLI::App* command =
        app.add_subcommand("screenshots", "Write a picture of every subject screen (PNG)");
    auto& shots = options_of<ScreenshotOptions>(command, chosen);
    command->add_option("-o,--output", shots.directory, "Folder for the pictures")
        ->capture_default_str();
    command
        ->add_option("--protocol", shots.protocol,
                     "Whose pictures and instructions to show: a protocol file or a shipped one")
        ->capture_default_str();
    command->add_option("--width", shots.width, "Of the pictures, pixels")
        ->check(CLI::Range(480, 7680))
        ->capture_default_str();
    command->add_option("--height", shots.height, "Of the pictures, pixels")
        ->check(CLI::Range(480, 7680))
        ->capture_default_str();
    command->add_option("--font", shots.font, "A TrueType font");
    command->add_option("--language", shots.language, "Of the sentences: en or tr")
        ->check(one_of({"en", "tr"}))
        ->capture_default_str();
}

void add_figures(CLI::App& app, Options& chosen) {
    CLI::App* command =
        app.add_subcommand("figures", "Compute the thesis' figures: SVG pictures and CSV tables");
    auto& figures = options_of<FigureOptions>(command, chosen);
    command->add_option("-o,--output", figures.directory, "Folder for the files; made if not there")
        ->capture_default_str();
}

void add_sequence(CLI::App& app, Options& chosen) {
    CLI::App* command = app.add_subcommand(
        "sequence", "Print the plan that run would carry out, without running it");
    auto& sequence = options_of<SequenceOptions>(command, chosen);
    command
        ->add_option("PROTOCOL", sequence.protocol, "A protocol file, or the name of a shipped one")
        ->required();
    command
        ->add_option("--participant", sequence.participant,
                     "Pseudonymous id: letters, digits, - and _")
        ->required();
    command->add_option("--db", sequence.database,
                        "The study's database: who already ran decides the order of the pictures");
    command
        ->add_option("--session", sequence.session,
                     "Session number; without it the last one, or the first")
        ->check(CLI::PositiveNumber);
    command->add_option("--seed", sequence.seed, "Study seed instead of the protocol's");
    command->add_flag("--csv", sequence.csv, "The trials alone, as CSV");
}

void add_check(CLI::App& app, Options& chosen) {
    CLI::App* command = app.add_subcommand(
        "check", "Is this protocol right, how long does it take, and can this device render it?");
    auto& check = options_of<CheckOptions>(command, chosen);
    command->add_option("PROTOCOL", check.protocol, "A protocol file, or the name of a shipped one")
        ->required();
    command->add_option("--device", check.device, std::string(kDeviceWords))->capture_default_str();
    command->add_option("--calibration", check.calibration, kCalibrationWords);
    command->add_option("--svg", check.svg, "Draw the objects into this file");
    command->add_flag("--long", check.tables,
                      "The tables as well: trials of each condition, limits, what follows what");
}

void add_new(CLI::App& app, Options& chosen) {
    CLI::App* command = app.add_subcommand(
        "new", "Write a protocol file to begin with: a shipped one with its comments");
    auto options = std::make_shared<NewOptions>();
    CLI::Option* file = command->add_option("FILE", options->file,
                                            "The file to make; its name becomes the study's id");
    command->add_option("--from", options->from, "The shipped protocol to begin with")
        ->capture_default_str();
    CLI::Option* keys =
        command->add_flag("--keys", options->keys, "Print what a protocol file may say");
    command->callback([options, file, keys, &chosen] {
        if (keys->count() == 0 && file->count() == 0) {
            throw CLI::RequiredError("FILE");
        }
        chosen = *options;
    });
}

void add_procedure(CLI::App& app, Options& chosen) {
    CLI::App* command = app.add_subcommand(
        "procedure", "Replay an adaptive procedure: stimuli, estimates and entropy trial by trial");
    auto options = std::make_shared<ProcedureOptions>();
    CLI::Option* config = command->add_option("CONFIG", options->config, "A procedure file (TOML)");
    CLI::Option* responses = command->add_option(
        "RESPONSES", options->responses, "A CSV file with a column response (and stimulus)");
    command->add_option("-o,--output", options->output,
                        "Where to write; standard output without it");
    command->add_flag("--hashes", options->hashes,
                      "Add the SHA-256 of the state after every trial");
    CLI::Option* keys =
        command->add_flag("--keys", options->keys, "Print what a procedure file may say");
    command->callback([options, config, responses, keys, &chosen] {
        if (keys->count() == 0 && (config->count() == 0 || responses->count() == 0)) {
            throw CLI::RequiredError(config->count() == 0 ? "CONFIG" : "RESPONSES");
        }
        chosen = *options;
    });
}

/// A command that reads a scene and a table of points.
template <class T>
void add_scene_command(CLI::App& app,
                       Options& chosen,
                       const std::string& name,
                       const std::string& what,
                       const std::string& points) {
    CLI::App* command = app.add_subcommand(name, what);
    auto& options = options_of<T>(command, chosen);
    command->add_option("SCENE", options.scene, "A scene file (TOML)")->required();
    command->add_option(points, options.points, "A CSV file with a head")->required();
    command->add_option("-o,--output", options.output,
                        "Where to write; standard output without it");
}

/// What CLI11 says of `e`, to where it belongs. @return its exit code
int said(const CLI::App& app, const CLI::Error& e) {
    std::ostringstream out;
    std::ostringstream error;
    const int code = app.exit(e, out, error);
    say_to(stdout, out.str());
    say_to(stderr, error.str());
    return code;
}

/// The first word that is no command or no option of it, as a sentence: it is the reason of whatever else is
/// missing. Empty if all are known.
std::string unknown_word(const CLI::App& app, int argc, const char* const* argv) {
    const auto chosen = app.get_subcommands();
    std::vector<std::string> known;
    if (chosen.empty()) {
        if (argc < 2) {
            return {};
        }
        if (argv[1][0] == '-') {
            return fmt::format(
                "palpate has no option {}{}; palpate --help lists them", argv[1],
                suggestion(argv[1], std::vector<std::string>{"--help", "--version"}, ""));
        }
        for (const CLI::App* command : app.get_subcommands({})) {
            known.push_back(command->get_name());
        }
        return fmt::format("there is no command \"{}\"{}; palpate --help lists them", argv[1],
                           suggestion(argv[1], known, ""));
    }
    const CLI::App& command = *chosen.front();
    for (const CLI::Option* option : command.get_options()) {
        for (const std::string& name : option->get_lnames()) {
            known.push_back("--" + name);
        }
    }
    for (std::string word : command.remaining()) {
        word = word.substr(0, word.find('='));
        if (word.starts_with("-") && word != "--") {
            return fmt::format("palpate {0} has no option {1}{2}; palpate {0} --help lists them",
                               command.get_name(), word, suggestion(word, known, ""));
        }
    }
    return {};
}

}  // namespace

Options parse_command_line(int argc, const char* const* argv) {
    CLI::App app{
        "palpate: psychophysics of felt shape. Runs the sessions, renders the forces, keeps the "
        "data."};
    app.name("palpate");
    app.require_subcommand(1);
    app.set_version_flag("--version", std::string("palpate ") + kVersion);
    app.footer("Set-up and tests: ./palpate test. A first study: see README.md.");

    Options chosen = Exit{};
    add_demo(app, chosen);
    add_new(app, chosen);
    add_check(app, chosen);
    add_run(app, chosen);
    add_sequence(app, chosen);
    add_data_commands(app, chosen);
    add_calibrate(app, chosen);
    add_doctor(app, chosen);
    add_emulator(app, chosen);
    add_scene_command<RenderOptions>(
        app, chosen, "render",
        "Feel a trajectory (time_s,hip_x_m,hip_y_m[,hip_z_m]): forces tick by tick", "TRAJECTORY");
    add_scene_command<ClosestOptions>(
        app, chosen, "closest", "Global closest points of a scene (hip_x_m,hip_y_m[,hip_z_m])",
        "POINTS");
    add_figures(app, chosen);
    add_procedure(app, chosen);
    add_screenshots(app, chosen);

    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& e) {  // help, version
        return Exit{said(app, e)};
    } catch (const CLI::ParseError& e) {
        const std::string unknown = unknown_word(app, argc, argv);
        if (!unknown.empty()) {
            warn("{}", unknown);
            return Exit{kWrongWords};
        }
        said(app, e);
        return Exit{kWrongWords};
    }
    if (auto* run = std::get_if<RunOptions>(&chosen)) {
        run->words.assign(argv, argv + argc);
    }
    return chosen;
}

}  // namespace palpate::ui

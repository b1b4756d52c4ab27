#include "ui/cli/options.hpp"

#include <cstdio>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "ui/cli/device_choice.hpp"
#include "ui/cli/version.hpp"

namespace palpate::ui {
namespace {

constexpr int kWrongWords = 2;

void add_screen(CLI::App& command, ScreenOptions& screen) {
    command.add_flag("--headless", screen.headless,
                     "No window: the simulated observer answers (so does it without a display)");
    command.add_flag("--fullscreen", screen.fullscreen, "The subject's window fills the display");
    command.add_option("--font", screen.font, "A TrueType font for the subject's screen");
    command
        .add_option(
            "--speed", screen.speed,
            "Simulated and replayed hands at this multiple of real time; 0: as fast as the machine")
        ->check(CLI::NonNegativeNumber);
}

void add_run(CLI::App& app, RunOptions& run) {
    CLI::App* command = app.add_subcommand("run", "Run or resume a session of a protocol");
    command->add_option("PROTOCOL", run.protocol, "A protocol file, or the name of a shipped one")
        ->required();
    command
        ->add_option("--participant", run.participant, "Pseudonymous id: letters, digits, - and _")
        ->required();
    command->add_option("--db", run.database, "The study's database file; made if it is not there")
        ->required();
    command->add_option("--device", run.device, std::string(kDeviceWords))->capture_default_str();
    command
        ->add_option("--kind", run.kind,
                     "pilot or real; what is simulated is recorded as simulated")
        ->check(CLI::IsMember({"pilot", "real"}));
    command->add_option("--session", run.session, "Session number; without it the last one goes on")
        ->check(CLI::PositiveNumber);
    command->add_option("--seed", run.seed, "Study seed instead of the protocol's");
    add_screen(*command, run.screen);
}

void add_sequence(CLI::App& app, SequenceOptions& sequence) {
    CLI::App* command = app.add_subcommand(
        "sequence", "Print the plan that run would carry out, without running it");
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

void add_demo(CLI::App& app, DemoOptions& demo) {
    CLI::App* command =
        app.add_subcommand("demo", "Ten trials of the study with a simulated hand and observer");
    command->add_option("--db", demo.database, "Where the data goes")->capture_default_str();
    command->add_option("--seed", demo.seed, "Study seed instead of the protocol's");
    add_screen(*command, demo.screen);
}

/// A command that reads a scene and a table of points.
void add_scene_command(CLI::App& app,
                       const std::string& name,
                       const std::string& what,
                       const std::string& points,
                       SceneOptions& options) {
    CLI::App* command = app.add_subcommand(name, what);
    command->add_option("SCENE", options.scene, "A scene file (TOML)")->required();
    command->add_option(points, options.points, "A CSV file with a head")->required();
    command->add_option("-o,--output", options.output,
                        "Where to write; standard output without it");
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

    RunOptions run;
    SequenceOptions sequence;
    DemoOptions demo;
    SummaryOptions summary;
    ScreenshotOptions shots;
    RenderOptions render;
    ClosestOptions closest;
    FigureOptions figures;
    add_demo(app, demo);
    add_run(app, run);
    add_sequence(app, sequence);
    add_scene_command(app, "render", "Feel a trajectory (t_s,x_m,y_m[,z_m]): forces tick by tick",
                      "TRAJECTORY", render);
    add_scene_command(app, "closest", "Global closest points of a scene (x_m,y_m[,z_m])", "POINTS",
                      closest);
    CLI::App* summarise =
        app.add_subcommand("summary", "Confusion matrix and shares correct of a database");
    summarise->add_option("FILE", summary.database, "A palpate database")->required();
    CLI::App* picture =
        app.add_subcommand("screenshots", "Write a picture of every subject screen (PNG)");
    picture->add_option("-o,--output", shots.directory, "Folder for the pictures")
        ->capture_default_str();
    picture->add_option("--font", shots.font, "A TrueType font");

    CLI::App* draw =
        app.add_subcommand("figures", "Compute the thesis' figures: SVG pictures and CSV tables");
    draw->add_option("-o,--output", figures.directory, "Folder for the files; made if not there")
        ->capture_default_str();

    try {
        app.parse(argc, argv);
    } catch (const CLI::RequiredError& e) {
        if (argc > 1 && argv[1][0] != '-' &&
            app.get_subcommands().empty()) {  // CLI11 does not say which word
            fmt::print(stderr, "palpate: there is no command \"{}\"; palpate --help lists them\n",
                       argv[1]);
            return Exit{kWrongWords};
        }
        return Exit{app.exit(e) == 0 ? 0 : kWrongWords};
    } catch (const CLI::ParseError& e) {
        return Exit{app.exit(e) == 0 ? 0 : kWrongWords};
    }
    if (app.got_subcommand("run")) {
        return run;
    }
    if (app.got_subcommand("sequence")) {
        return sequence;
    }
    if (app.got_subcommand("demo")) {
        return demo;
    }
    if (app.got_subcommand("summary")) {
        return summary;
    }
    if (app.got_subcommand("render")) {
        return render;
    }
    if (app.got_subcommand("closest")) {
        return closest;
    }
    if (app.got_subcommand("figures")) {
        return figures;
    }
    return shots;
}

}  // namespace palpate::ui

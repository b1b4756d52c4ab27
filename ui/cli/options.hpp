#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

/// What the command line says, as plain values. CLI11 stays in options.cpp.
namespace palpate::ui {

/// How a session is shown and paced; shared by run and demo.
struct ScreenOptions {
    bool headless = false;    ///< no window: the simulated observer answers
    bool fullscreen = false;  ///< whatever the kind; real sessions are, unless windowed
    bool windowed = false;
    std::string font;       ///< a TTF file; empty: DejaVu Sans of the system
    double speed = 0.0;     ///< multiple of real time of simulated and replayed hands, 0: default
    bool no_sound = false;  ///< no masking noise, whatever the protocol asks for
};

struct RunOptions {
    std::vector<std::string> words;  ///< the whole command line
    std::string protocol;            ///< a file, or the name of a shipped protocol
    std::string participant;
    std::string database;
    std::string device = "sim";  ///< see parse_device
    std::string
        calibration;   ///< a calibration file or a shipped machine's name; empty: the device's own
    std::string kind;  ///< pilot, real; empty: real
    std::optional<std::size_t> session;
    bool elsewhere = false;  ///< the sessions before that one are in another file
    bool another = false;    ///< somebody new, although a code in the file is much like this one
    std::optional<std::uint64_t> seed;
    std::optional<std::string> secret;  ///< for the file, if it has no session yet
    std::string resume = "continue";
    std::string operator_name;  ///< kept with the session; empty: not given
    bool durable = false;       ///< ticks are saved within 45 ms instead of 120 ms
    double spin = 0.0;          ///< see engine::ServoSpec::spin_share
    ScreenOptions screen{};
};

struct DemoOptions {
    std::string database = "palpate-demo.sqlite";
    std::string device = "sim";  ///< sim or haply-emulator
    std::optional<std::uint64_t> seed;
    ScreenOptions screen{};
};

struct SequenceOptions {
    std::string protocol;  ///< a file, or the name of a shipped protocol
    std::string participant;
    std::string database;  ///< empty: an example
    std::optional<std::size_t> session;
    std::optional<std::uint64_t> seed;
    bool csv = false;
};

struct CheckOptions {
    std::string protocol;        ///< a file, or the name of a shipped protocol
    std::string device = "sim";  ///< as RunOptions::device
    std::string calibration;     ///< as RunOptions::calibration
    std::string svg;             ///< where to draw the objects; empty: nowhere
    bool tables = false;         ///< counts, limits and successions as well
};

struct NewOptions {
    std::string file;                     ///< made; never one that is there
    std::string from = "shape_friction";  ///< a shipped protocol
    bool keys = false;                    ///< only print what a protocol may say
    bool markdown = false;                ///< the keys of all files, as Markdown
};

struct SummaryOptions {
    std::string database;
};

struct ParticipantOptions {
    std::string database;
    std::string participant;
    std::optional<std::int64_t> handedness;  ///< -100 to 100
    std::string consent;                     ///< yes, no; empty: nothing new
    bool registers = false;                  ///< somebody who is not in the file yet
    bool another = false;                    ///< although a code in the file is much like this one
    std::vector<std::string> details;        ///< KEY=VALUE
    std::string operator_name{};             ///< empty: nobody is named
};

struct NoteOptions {
    std::string database;
    std::string participant;
    std::string study;  ///< empty: the only one of the participant
    std::optional<std::size_t> session;
    std::string text;
    std::string operator_name{};  ///< empty: nobody is named
};

struct MarkOptions {
    std::string database;
    std::int64_t trial = 0;
    std::string reason;
    std::string operator_name{};  ///< empty: nobody is named
};

struct VerifyOptions {
    std::string database;
    bool json = false;
};

struct SqlOptions {
    std::string database;
    std::optional<std::string> query;  ///< none: from standard input
    bool csv = false;
    bool json = false;
};

/// Prints where the SQL extension is.
struct ExtensionOptions {};

struct TraceOptions {
    std::string database;
    std::int64_t trial = 0;
    std::int64_t interval = 1;
};

struct ExportCommandOptions {
    std::string database;
    std::string format = "csv";  ///< csv, bids, psych-ds, parquet
    std::string directory;       ///< made; never one that holds something
    std::string kind = "real";   ///< real, pilot, simulated, all
    bool details = false;
    bool traces = false;
    bool keep_codes = false;
};

struct MergeOptions {
    std::string database;             ///< made if it is not there
    std::vector<std::string> inputs;  ///< read only
};

struct PushOptions {
    std::string database;
    std::string url;     ///< postgresql://...
    bool roles = false;  ///< only print the script of the roles
};

struct ScreenshotOptions {
    std::string protocol =
        "shape_friction";  ///< a file or a shipped one: its pictures, instructions
    std::string directory = ".";
    std::string language = "en";  ///< en, tr
    int width = 1280;             ///< pixels
    int height = 800;
    std::string font;
};

struct FigureOptions {
    std::string directory = "figures";  ///< made if it is not there
};

struct CalibrateOptions {
    std::string device = "sim";
    std::string preset = "mk2";      ///< a calibration file, or the name of a shipped machine
    std::vector<std::string> marks;  ///< X_MM,Y_MM each; none: the home pose, or the origin
    bool scale = false;              ///< counts per turn as well
    std::string output;
};

struct DoctorOptions {
    std::string device = "sim";  ///< as RunOptions::device
    std::string calibration;     ///< as RunOptions::calibration
    std::string protocol;        ///< whose rate and force are asked for; empty: 1 kHz, no force
    std::string database = "palpate.sqlite";  ///< whose folder is looked at; not made
    std::string font;
    double seconds = 5.0;  ///< of the jitter measurement
    bool json = false;
};

struct EmulatorOptions {
    std::string link;                  ///< a symbolic link to the terminal; empty: none
    std::string preset = "2diy_gen3";  ///< a calibration file, or the name of a shipped machine
    double delay_ms = 0.0;             ///< from a packet to its answer
};

/// The offline tools: a scene and a table of points.
struct SceneOptions {
    std::string scene;
    std::string points;
    std::string output;  ///< empty: standard output
};
struct RenderOptions : SceneOptions {};
struct ClosestOptions : SceneOptions {};

struct ProcedureOptions {
    std::string config;
    std::string responses;
    std::string output;   ///< empty: standard output
    bool hashes = false;  ///< a column with the hash of the state after every trial
    bool keys = false;    ///< only print what a configuration may say
};

/// The program is to end now with this exit code (help was shown, or the words were wrong).
struct Exit {
    int code = 0;
};

using Options = std::variant<Exit,
                             RunOptions,
                             DemoOptions,
                             SummaryOptions,
                             ParticipantOptions,
                             NoteOptions,
                             MarkOptions,
                             VerifyOptions,
                             SqlOptions,
                             ExtensionOptions,
                             TraceOptions,
                             ExportCommandOptions,
                             MergeOptions,
                             PushOptions,
                             ScreenshotOptions,
                             RenderOptions,
                             ClosestOptions,
                             FigureOptions,
                             CalibrateOptions,
                             DoctorOptions,
                             EmulatorOptions,
                             SequenceOptions,
                             CheckOptions,
                             NewOptions,
                             ProcedureOptions>;

/// Prints help, version or what is wrong, and then returns Exit (0, or 2 for wrong words).
[[nodiscard]] Options parse_command_line(int argc, const char* const* argv);

}  // namespace palpate::ui

#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>

/// What the command line says, as plain values. CLI11 stays in options.cpp.
namespace palpate::ui {

/// How a session is shown and paced; shared by run and demo.
struct ScreenOptions {
    bool headless = false;  ///< no window: the simulated observer answers
    bool fullscreen = false;
    std::string font;    ///< a TTF file; empty: DejaVu Sans of the system
    double speed = 0.0;  ///< multiple of real time of simulated and replayed hands, 0: default
};

struct RunOptions {
    std::string protocol;  ///< a file, or the name of a shipped protocol
    std::string participant;
    std::string database;
    std::string device = "sim";  ///< sim, mouse, replay:FILE[:TRIAL]
    std::string kind;            ///< pilot, real; empty: real
    std::optional<std::size_t> session;
    std::optional<std::uint64_t> seed;
    ScreenOptions screen{};
};

struct DemoOptions {
    std::string database = "palpate-demo.sqlite";
    std::optional<std::uint64_t> seed;
    ScreenOptions screen{};
};

struct SequenceOptions {
    std::string protocol;  ///< a file, or the name of a shipped protocol
    std::string participant;
    std::string database;  ///< empty: a study that nobody has run yet
    std::optional<std::size_t> session;
    std::optional<std::uint64_t> seed;
    bool csv = false;
};

struct SummaryOptions {
    std::string database;
};

struct ScreenshotOptions {
    std::string directory = ".";
    std::string font;
};

struct FigureOptions {
    std::string directory = "figures";  ///< made if it is not there
};

/// The offline tools: a scene and a table of points.
struct SceneOptions {
    std::string scene;
    std::string points;
    std::string output;  ///< empty: standard output
};
struct RenderOptions : SceneOptions {};
struct ClosestOptions : SceneOptions {};

/// The program is to end now with this exit code (help was shown, or the words were wrong).
struct Exit {
    int code = 0;
};

using Options = std::variant<Exit,
                             RunOptions,
                             DemoOptions,
                             SequenceOptions,
                             SummaryOptions,
                             ScreenshotOptions,
                             RenderOptions,
                             ClosestOptions,
                             FigureOptions>;

/// Prints help, version or what is wrong, and then returns Exit (0, or 2 for wrong words).
[[nodiscard]] Options parse_command_line(int argc, const char* const* argv);

}  // namespace palpate::ui

#pragma once

#include "tests/support/slurp.hpp"

namespace palpate::tests {

/// A folder of its own under the system's temporary one, removed at the end.
class TemporaryFolder {
public:
    TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    ~TemporaryFolder();

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    [[nodiscard]] std::string file(const std::string& name) const {
        return (path_ / name).string();
    }
    /// Names of everything in it, sorted.
    [[nodiscard]] Words names() const;

private:
    std::filesystem::path path_;
};

/// The name of a file in a folder of its own, which goes with it.
class TemporaryFile : private TemporaryFolder, public std::string {
public:
    explicit TemporaryFile(const std::string& name) : std::string(TemporaryFolder::file(name)) {}
    operator std::filesystem::path() const { return c_str(); }  // NOLINT: as a std::string does
};

struct Finished {
    int code = -1;      ///< exit code, or 128 + signal
    std::string out;    ///< standard output
    std::string error;  ///< standard error
};

/// Names the terminal at which a process reads, in a session of its own.
inline constexpr const char* kTerminal = "PALPATE_TEST_TERMINAL";

/// A child process with its output in files. Killed at the end of its life, and of the test's.
class Process {
public:
    /// @param command      program and arguments
    /// @param environment  "NAME=value" changes; "NAME" alone removes; kTerminal + "=/dev/pts/N" is
    /// its terminal
    explicit Process(const Words& command, const Words& environment = {});
    Process(const Process&) = delete;
    Process& operator=(const Process&) = delete;
    ~Process();

    [[nodiscard]] pid_t id() const { return pid_; }
    /// After SIGSTOP none of its threads runs.
    void signal(int number) const;
    [[nodiscard]] bool running();
    /// What it has printed so far.
    [[nodiscard]] std::string out() const;
    [[nodiscard]] std::string error() const;
    /// Waits until it has printed `text`. @return it has, in time
    [[nodiscard]] bool says(std::string_view text) const;
    /// The same of standard error.
    [[nodiscard]] bool warns(std::string_view text) const;
    /// Waits to the end; kills after `limit` and reports code 137.
    Finished wait(std::chrono::seconds limit = std::chrono::seconds(120));
    /// Sends a signal, and waits to the end. @return the code
    int ended_by(int number);

private:
    TemporaryFolder folder_;
    pid_t pid_ = -1;
    int status_ = 0;
    bool done_ = false;
};

/// The secret of new files in tests, so that a failure comes again.
inline constexpr const char* kRunSecret = "00112233445566778899aabbccddeeff";

/// The environment of a program that finds no display.
inline const Words kNoDisplay{"DISPLAY", "WAYLAND_DISPLAY", "SDL_VIDEODRIVER"};

/// Runs the program under test, headless unless the arguments say otherwise. `run` makes a new file
/// with kRunSecret unless another --secret is given.
[[nodiscard]] Finished palpate_command(const Words& arguments);

/// What `palpate run` takes for a session of a participant into a file, and more words.
[[nodiscard]] inline Words run_words(const std::string& protocol,
                                     const std::string& participant,
                                     const std::string& file,
                                     const Words& more = {}) {
    return joined({"run", protocol, "--participant", participant, "--db", file}, more);
}

/// Path of the program under test: PALPATE_TEST_PROGRAM, else the one that was built.
[[nodiscard]] std::string palpate_program();
/// It and these words, for a Process.
[[nodiscard]] inline Words command_of(const Words& arguments) {
    return joined({palpate_program()}, arguments);
}

/// The program with a window that nobody sees.
[[nodiscard]] inline Finished unseen(const Words& arguments) {
    return Process(command_of(arguments), {"SDL_VIDEODRIVER=dummy"}).wait();
}

/// What a shell comes to in a folder, $0 being the program, $1 the first of the words.
[[nodiscard]] inline Finished shell(const std::string& script,
                                    const std::filesystem::path& within = "/",
                                    const Words& words = {}) {
    return Process(joined({"bash", "-c", "cd '" + within.string() + "' && " + script,
                           palpate_program()},
                          words))
        .wait();
}

/// Makes `file` of `text`, byte for byte. @return its name
inline std::string write(const std::string& file, std::string_view text) {
    std::ofstream(file, std::ios::binary) << text;
    return file;
}

inline void pause(double seconds) {
    std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

/// False, with a warning, where the SQL extension is built with a sanitizer: its runtime would have
/// to be in the program that loads it.
[[nodiscard]] bool others_load_extension();

}  // namespace palpate::tests

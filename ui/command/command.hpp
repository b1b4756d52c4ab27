#pragma once

#include <cstdint>
#include <cstdio>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include <sys/stat.h>
#include <unistd.h>

#include "ui/rig/say.hpp"

/// Commands and the words they take. Each command declares its own in its file; CLI11 stays in
/// parse.cpp.
namespace palpate::ui {

/// The words or files given are wrong: exit code 2, nothing was created.
inline constexpr int kExitUsage = 2;
/// Something failed on the way: exit code 1, what was recorded is kept.
inline constexpr int kExitFailure = 1;
/// The experimenter or a signal ended the session early: exit code 3, it can be resumed.
inline constexpr int kExitStopped = 3;

/// Where a word's value goes. A bool is a flag.
using Target = std::variant<bool*,
                            int*,
                            std::int64_t*,
                            std::optional<std::int64_t>*,
                            std::optional<std::uint64_t>*,
                            double*,
                            std::string*,
                            std::optional<std::string>*,
                            std::vector<std::string>*>;

/// One word of a command: "--db" takes a value, "FILE" is one.
struct Word {
    std::string name;  ///< as CLI11 has it: "-o,--output"
    Target target;
    std::string help;
    bool needed = false;
    bool shows_default = false;          ///< as it does where there is a text, or a number not 0
    bool one_by_one = false;             ///< of a list: the word again for each
    bool positive = false;               ///< a number above 0
    bool not_negative = false;           ///< a number from 0
    bool is_text = false;                ///< kept in a file: it must be UTF-8
    std::vector<std::string> choices{};  ///< one of these; none: anything
    std::optional<std::pair<double, double>> range{};
    std::vector<std::string> not_beside{};  ///< the names of words that exclude this one
    std::string only_beside{};              ///< the name of a word that has to be there too
    std::string needed_unless{};            ///< this word has to be there, or that one
    bool* said = nullptr;                   ///< becomes true where the line has this word

    /// Each says one thing more of the word and returns it, so that they can be chained.
    Word& required() { return needed = true, *this; }
    Word& with_default() { return shows_default = true, *this; }
    Word& again_for_each() { return one_by_one = true, *this; }
    Word& above_zero() { return positive = true, *this; }
    Word& from_zero() { return not_negative = true, *this; }
    Word& kept_text() { return is_text = true, *this; }
    Word& among(std::vector<std::string> words) { return choices = std::move(words), *this; }
    Word& within(double min, double max) { return range = {min, max}, *this; }
    Word& excludes(std::string word) { return not_beside.push_back(std::move(word)), *this; }
    Word& needs(std::string word) { return only_beside = std::move(word), *this; }
    Word& tells(bool& is_said) { return said = &is_said, *this; }
    Word& required_unless(std::string word) { return needed_unless = std::move(word), *this; }
};

/// All words of one command.
struct CommandWords {
    std::deque<Word> all{};           ///< a word stays where it is while others are added
    std::vector<std::string> line{};  ///< the whole command line, the program's name first

    /// @param name   "--file", "-n,--number" or "file": an option or a place
    /// @param value  gets what is typed, and is the default; outlives the parse
    template <class T>
    Word& add(std::string name, T& value, std::string help) {
        Word& word = all.emplace_back(Word{std::move(name), &value, std::move(help)});
        if constexpr (std::is_same_v<T, std::string>) {
            word.shows_default = !value.empty();
        } else if constexpr (std::is_arithmetic_v<T> && !std::is_same_v<T, bool>) {
            word.shows_default = value != T{};
        }
        return word;
    }
};

/// One of the program's commands.
struct Command {
    std::string name;
    std::string what;  ///< a line of `palpate --help`
    /// Adds the command's words; called once, before the line is parsed.
    std::function<void(CommandWords&)> declare;
    std::function<int()> run;  ///< the exit code; throws for what went wrong
};

/// A command whose words fill a struct.
template <class Options>
[[nodiscard]] Command make_command(std::string name,
                                   std::string what,
                                   void (*declare)(CommandWords&, Options&),
                                   int (*run)(const Options&)) {
    const auto options = std::make_shared<Options>();
    return {std::move(name), std::move(what),
            [=](CommandWords& words) { declare(words, *options); },
            [=] {
                return run(*options);
            }};
}

/// The command to run, or none.
struct ParseResult {
    std::optional<std::size_t> command{};
    int code = 0;  ///< without one: the exit code
};

/// The command that the line names, its words read; else help, version or what is wrong is printed.
/// @param version  "0.1.0"
/// @return an index into `commands`, or the exit code of what was printed: 0, or kExitUsage for
/// wrong words
[[nodiscard]] ParseResult parse_command_line(const std::vector<Command>& commands,
                                             const std::string& version,
                                             int argc,
                                             const char* const* argv);

/// The exit code of a command that ended with `code`: a full disk behind standard output is no
/// success. Who closes a pipe has read enough.
[[nodiscard]] inline int heard(int code) {
    struct stat out {};
    const bool lost = !let_readers_read() || std::fflush(stdout) != 0 || std::ferror(stdout) != 0;
    if (code != 0 || !lost || (fstat(STDOUT_FILENO, &out) == 0 && S_ISFIFO(out.st_mode))) {
        return code;
    }
    warn("standard output: cannot be written; check the space on the disk");
    return kExitFailure;
}

/// What was built or installed with this program: a file in its folder, or in ../lib/palpate.
/// @param name    of the file, "palpate_sample.so"
/// @param target  that builds it, for the message
/// @throws std::runtime_error if it is in neither
[[nodiscard]] std::filesystem::path beside_program(std::string_view name, std::string_view target);

}  // namespace palpate::ui

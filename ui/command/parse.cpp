#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <map>
#include <optional>
#include <sstream>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "ui/command/command.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {
namespace {

/// Words that are kept must be UTF-8, as everything that reads them takes for granted.
std::string kept_text(const std::string& words) {
    return is_utf8(words) ? ""
                          : "these words are not UTF-8: set the terminal's encoding to UTF-8 "
                            "and give them again";
}

/// CLI11 takes nan and inf for numbers, and no range refuses nan.
std::string finite_number(const std::string& given) {
    return std::isfinite(std::strtod(given.c_str(), nullptr))
             ? ""
             : fmt::format("{} is no finite number", given);
}

/// The largest whole number of a file, and so of a word.
constexpr std::int64_t kMaxWhole = std::numeric_limits<std::int64_t>::max();

/// CLI11 takes -1 for 2^64 - 1, what is too large for the largest, and nothing for no word at all.
template <class Whole>
std::string whole_number(const std::string& given) {
    const std::optional<Whole> number = parsed<Whole>(given);
    return number && std::cmp_less_equal(*number, kMaxWhole)
             ? ""
             : fmt::format("\"{}\" is no whole number from {} to {}", given,
                           std::numeric_limits<Whole>::min(), kMaxWhole);
}

/// A check of a word that is one of a few; what it says of another names the nearest.
std::function<std::string(const std::string&)> one_of(std::vector<std::string> words) {
    return [words = std::move(words)](const std::string& given) -> std::string {
        if (std::find(words.begin(), words.end(), given) != words.end()) {
            return {};
        }
        return fmt::format("\"{}\" is none of {}{}", given, fmt::join(words, ", "),
                           suggestion(given, words, ""));
    };
}

/// @param give  what numbers `fits` takes, for who gave another
/// @param help  the same, for --help
CLI::Validator number_where(std::function<bool(double)> fits, std::string give, std::string help) {
    const auto check = [fits = std::move(fits), give = std::move(give)](const std::string& given) {
        double number = 0.0;
        const bool read = CLI::detail::lexical_cast(given, number);
        return read && fits(number) ? std::string()
                                    : fmt::format("\"{}\" is {}: give {}", given,
                                                  read ? "out of range" : "no number", give);
    };
    return {check, std::move(help)};
}

/// Help says the type that the word's value has, too.
CLI::Validator number_within(const Word& word) {
    const auto [min, max] = *word.range;
    const std::string lowest = number_text(min);
    const std::string highest = number_text(max);
    return number_where(
        [min = min, max = max](double number) { return number >= min && number <= max; },
        fmt::format("{} to {}", lowest, highest),
        fmt::format("{} in [{} - {}]",
                    std::holds_alternative<double*>(word.target) ? "FLOAT" : "INT", lowest,
                    highest));
}

/// What a value must be, by its type and by what the word says.
void check_values(CLI::Option& option, const Word& word) {
    if (std::holds_alternative<double*>(word.target)) {
        option.check(finite_number);
    }
    if (std::holds_alternative<std::optional<std::uint64_t>*>(word.target)) {
        option.check(CLI::Validator(
            [](const std::string& given) { return whole_number<std::uint64_t>(given); },
            fmt::format("UINT in [0 - {}]", kMaxWhole)));
    }
    if (std::holds_alternative<std::optional<std::int64_t>*>(word.target) ||
        std::holds_alternative<std::int64_t*>(word.target)) {
        option.check(whole_number<std::int64_t>);
    }
    if (word.positive) {
        option.check(number_where([](double number) { return number > 0.0; }, "a number above 0",
                                  "POSITIVE"));
    }
    if (word.not_negative) {
        option.check(
            number_where([](double number) { return number >= 0.0; }, "0 or more", "NONNEGATIVE"));
    }
    if (word.range) {
        option.check(number_within(word));
    }
    if (!word.choices.empty()) {
        option.check(one_of(word.choices));
    }
    if (word.is_text) {
        option.check(kept_text);
    }
}

CLI::Option* added(CLI::App& app, const Word& word) {
    CLI::Option* option = std::visit(
        [&](auto* value) -> CLI::Option* {
            if constexpr (std::is_same_v<decltype(value), bool*>) {
                return app.add_flag(word.name, *value, word.help);
            } else {
                return app.add_option(word.name, *value, word.help);
            }
        },
        word.target);
    if (word.needed) {
        option->required();
    }
    if (word.one_by_one) {
        option->allow_extra_args(false);
    }
    check_values(*option, word);
    if (word.shows_default) {
        option->capture_default_str();
    }
    return option;
}

/// Adds the words of a command, and what they ask of each other.
void declare(CLI::App& app, const CommandWords& words) {
    std::map<std::string, CLI::Option*> options;
    for (const Word& word : words.all) {
        options[word.name] = added(app, word);
    }
    for (const Word& word : words.all) {
        for (const std::string& other : word.not_beside) {
            options.at(word.name)->excludes(options.at(other));
        }
        if (!word.only_beside.empty()) {
            options.at(word.name)->needs(options.at(word.only_beside));
        }
    }
    app.callback([options, words] {
        for (const Word& word : words.all) {
            const bool is_there = options.at(word.name)->count() > 0;
            if (!word.needed_unless.empty() && !is_there &&
                options.at(word.needed_unless)->count() == 0) {
                throw CLI::RequiredError(word.name);
            }
            if (word.said != nullptr && is_there) {
                *word.said = true;
            }
        }
    });
}

std::string unknown_command(const CLI::App& app, const std::string& word) {
    if (word.starts_with('-')) {
        return fmt::format("palpate has no option {}{}; palpate --help lists them", word,
                           suggestion(word, std::vector<std::string>{"--help", "--version"}, ""));
    }
    std::vector<std::string> known;
    for (const CLI::App* command : app.get_subcommands({})) {
        known.push_back(command->get_name());
    }
    return fmt::format("there is no command \"{}\"{}; palpate --help lists them", word,
                       suggestion(word, known, ""));
}

/// Why a command line is refused: the first word that is no command, no option of it or one too
/// many, for that is the reason of whatever else is missing; else what CLI11 says.
std::string why_not(const CLI::App& app,
                    const CLI::ParseError& error,
                    int argc,
                    const char* const* argv) {
    const auto chosen = app.get_subcommands();
    if (chosen.empty()) {
        return argc < 2 ? "a command is missing; palpate --help lists them"
                        : unknown_command(app, argv[1]);
    }
    std::vector<std::string> known;
    const CLI::App& command = *chosen.front();
    for (const CLI::Option* option : command.get_options()) {
        for (const std::string& name : option->get_lnames()) {
            known.push_back("--" + name);
        }
    }
    std::string why;
    for (std::string word : command.remaining()) {
        if (word == "--") {
            continue;
        }
        word = word.starts_with('-') ? word.substr(0, word.find('=')) : word;
        if (word.starts_with('-') && std::ranges::find(known, word) == known.end()) {
            return fmt::format("palpate {0} has no option {1}{2}; palpate {0} --help lists them",
                               command.get_name(), word, suggestion(word, known, ""));
        }
        if (why.empty()) {
            why = fmt::format("\"{}\" is one word too many{}", word,
                              word.starts_with('-') ? ": no word behind -- is an option" : "");
        }
    }
    return fmt::format("{}; palpate {} --help says what it takes", why.empty() ? error.what() : why,
                       command.get_name());
}

}  // namespace

ParseResult parse_command_line(const std::vector<Command>& commands,
                               const std::string& version,
                               int argc,
                               const char* const* argv) {
    CLI::App app{
        "palpate: psychophysics of felt shape. Runs the sessions, renders the forces, keeps the "
        "data."};
    app.name("palpate");
    app.require_subcommand(1);
    app.set_version_flag("--version", "palpate " + version);
    app.footer("A first study: see README.md (installed: /usr/share/doc/palpate).");
    std::vector<const CLI::App*> added;
    for (const Command& command : commands) {
        CommandWords words{.line = {argv, argv + argc}};
        CLI::App* one = app.add_subcommand(command.name, command.what);
        added.push_back(one);
        if (std::ranges::find(words.line, command.name) != words.line.end()) {  // no other's count
            command.declare(words);
            declare(*one, words);
        }
    }
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& e) {  // help, version
        std::ostringstream out;
        const int code = app.exit(e, out, out);
        say_to(stdout, out.str());
        return {.code = code};
    } catch (const CLI::ParseError& e) {
        warn("{}", why_not(app, e, argc, argv));
        return {.code = kExitUsage};
    }
    const auto chosen = std::find(added.begin(), added.end(), app.get_subcommands().front());
    return {.command = static_cast<std::size_t>(chosen - added.begin())};
}

std::filesystem::path beside_program(std::string_view name, std::string_view target) {
    std::error_code unknown;
    const auto folder = std::filesystem::read_symlink("/proc/self/exe", unknown).parent_path();
    auto file = folder / name;
    if (!std::filesystem::exists(file)) {
        file = folder.parent_path() / "lib" / "palpate" / name;
    }
    refuse_if<std::runtime_error>(unknown || !std::filesystem::exists(file),
                                  "{} is not there, nor beside the program: build the target {}",
                                  file.string(), target);
    return file;
}

}  // namespace palpate::ui

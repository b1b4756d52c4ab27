#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "protocols/file/protocol_file.hpp"
#include "ui/command/command.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {
namespace {

CommandWords words_of(const Command& command) {
    CommandWords words;
    command.declare(words);
    return words;
}

/// "-o,--output" as "-o" and "--output".
std::vector<std::string> names_of(const Word& word) {
    std::vector<std::string> names;
    std::istringstream all(word.name);
    for (std::string name; std::getline(all, name, ',');) {
        names.push_back(name);
    }
    return names;
}

bool is_option(const Word& word) {
    return word.name.starts_with("-");
}

bool is_flag(const Word& word) {
    return std::holds_alternative<bool*>(word.target);
}

/// Text that roff prints as it is: no line of it is an order, and a hyphen can be copied.
std::string roff(std::string_view text) {
    std::string safe;
    for (const char c : text) {
        const bool begins = safe.empty() || safe.back() == '\n';
        if (begins && (c == '.' || c == '\'')) {
            safe += "\\&";
        }
        safe += c == '\\' ? "\\e" : c == '-' ? "\\-" : std::string(1, c);
    }
    return safe;
}

/// What stands behind the name of an option that takes a value.
std::string_view value_of(const Word& word) {
    if (std::holds_alternative<double*>(word.target)) {
        return "NUMBER";
    }
    const bool text = std::holds_alternative<std::string*>(word.target) ||
                      std::holds_alternative<std::optional<std::string>*>(word.target) ||
                      std::holds_alternative<std::vector<std::string>*>(word.target);
    return text ? "TEXT" : "N";
}

/// The value before anything was read.
std::string default_of(const Word& word) {
    return std::visit(
        [](const auto* value) -> std::string {
            using Value = std::decay_t<decltype(*value)>;
            if constexpr (std::is_same_v<Value, bool> ||
                          std::is_same_v<Value, std::vector<std::string>>) {
                return {};
            } else if constexpr (std::is_arithmetic_v<Value> ||
                                 std::is_same_v<Value, std::string>) {
                return fmt::format("{}", *value);
            } else {
                return *value ? fmt::format("{}", **value) : std::string();
            }
        },
        word.target);
}

/// What the table knows of a word beside its help, as sentences.
std::string rules_of(const Word& word) {
    std::string rules;
    if (!word.choices.empty()) {
        rules += fmt::format(" One of {}.", fmt::join(word.choices, ", "));
    }
    if (word.range) {
        rules += fmt::format(" From {} to {}.", word.range->first, word.range->second);
    }
    if (word.positive || word.not_negative) {
        rules += word.positive ? " Above 0." : " Not below 0.";
    }
    if (word.shows_default) {
        rules += fmt::format(" Default: {}.", default_of(word));
    }
    if (word.needed) {
        rules += " Needed.";
    }
    if (!word.needed_unless.empty()) {
        rules += fmt::format(" Needed without {}.", word.needed_unless);
    }
    if (!word.only_beside.empty()) {
        rules += fmt::format(" Only beside {}.", word.only_beside);
    }
    if (!word.not_beside.empty()) {
        rules += fmt::format(" Not beside {}.", fmt::join(word.not_beside, ", "));
    }
    if (word.one_by_one) {
        rules += " Can be given again.";
    }
    return rules;
}

std::string paragraph_of(const Word& word) {
    std::string head;
    for (const std::string& name : names_of(word)) {
        head += (head.empty() ? "" : ", ") + fmt::format("\\fB{}\\fR", roff(name));
    }
    if (is_option(word) && !is_flag(word)) {
        head += fmt::format(" \\fI{}\\fR", value_of(word));
    }
    const bool stops = word.help.ends_with('.') || word.help.ends_with('?');
    const std::string rules = rules_of(word);
    return fmt::format(".TP\n{}\n{}{}{}\n", head, roff(word.help), stops ? "" : ".", roff(rules));
}

/// The case of bash's script in which `command`'s options are offered; values first.
std::string case_of(const Command& command) {
    std::string values;
    std::string any;
    std::string options = "--help";
    std::string places;
    const CommandWords words = words_of(command);
    for (const Word& word : words.all) {
        std::string before;
        for (const std::string& name : names_of(word)) {
            before += (before.empty() ? "" : " | ") + command.name + ':' + name;
            options += is_option(word) ? ' ' + name : "";
        }
        if (!is_option(word)) {
            places +=
                fmt::format("{}{}", word.choices.empty() ? "" : " ", fmt::join(word.choices, " "));
        } else if (!word.choices.empty()) {
            values +=
                fmt::format("        {}) words='{}' ;;\n", before, fmt::join(word.choices, " "));
        } else if (!is_flag(word)) {
            any += (any.empty() ? "" : " | ") + before;
        }
    }
    if (!any.empty()) {
        values += fmt::format("        {}) return ;;\n", any);
    }
    return fmt::format("{0}        {1}:*) words='{2}'; [[ $word == -* ]] || words='{3}' ;;\n",
                       values, command.name, options,
                       std::string_view(places).substr(places.empty() ? 0 : 1));
}

/// For man(1): every command with every word, its meaning, default and range.
std::string man_page(const std::vector<Command>& commands, const std::string& version) {
    std::string page = fmt::format(
        ".TH PALPATE 1 \"\" \"palpate {}\" \"User Commands\"\n"
        ".SH NAME\npalpate \\- psychophysics of felt shape\n"
        ".SH SYNOPSIS\n.B palpate\n\\fICOMMAND\\fR [\\fIWORDS\\fR]\n"
        ".SH DESCRIPTION\n"
        "Runs the sessions of an experiment on felt shape, renders the forces at 1 kHz, and keeps "
        "every choice and every tick in one SQLite file. Nothing of it was tried on hardware.\n"
        ".SH COMMANDS\n",
        roff(version));
    for (const Command& command : commands) {
        page += fmt::format(".SS palpate {}\n{}.\n", roff(command.name), roff(command.what));
        const CommandWords words = words_of(command);
        for (const Word& word : words.all) {
            page += paragraph_of(word);
        }
    }
    page += fmt::format(
        ".SH EXIT STATUS\n"
        ".TP\n0\nDone.\n"
        ".TP\n{}\nSomething failed on the way; what was recorded is kept.\n"
        ".TP\n{}\nA wrong word or file; nothing was created.\n"
        ".TP\n{}\nStopped early; the same command goes on.\n",
        kExitFailure, kExitUsage, kExitStopped);
    return page;
}

/// Completes commands, options, and values that are one of a few. Where any text is right bash
/// offers files.
std::string bash_completion(const std::vector<Command>& commands) {
    std::vector<std::string> names;
    std::string cases;
    for (const Command& command : commands) {
        names.push_back(command.name);
        cases += case_of(command);
    }
    return fmt::format(
        "# Completion of palpate's commands and options, for bash.\n"
        "_palpate() {{\n"
        "    local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD - 1]}}\n"
        "    [[ $before != = ]] || before=${{COMP_WORDS[COMP_CWORD - 2]}}\n"
        "    [[ $word != = ]] || word=\n"
        "    COMPREPLY=()\n"
        "    local words='{} --help --version'\n"
        "    ((COMP_CWORD == 1)) || case ${{COMP_WORDS[1]}}:$before in\n"
        "{}        *) words= ;;\n"
        "    esac\n"
        "    mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$word\")\n"
        "}}\n"
        "complete -o default -F _palpate palpate\n",
        fmt::join(names, " "), cases);
}

}  // namespace

/// @param all  every command, this one too
Command words_command(std::vector<Command> (*all)()) {
    struct Options {
        std::string form;
        std::string kind{protocols::kSchemaKinds.front()};
        bool of_kind = false;
    };
    const auto options = std::make_shared<Options>();
    return {"words", "Print what other programs want to know of commands and files",
            [options](CommandWords& words) {
                words
                    .add("FORM", options->form,
                         "bash: a script that completes the commands; man: the manual page; "
                         "schema: what a file may say, as JSON Schema, for editors")
                    .required()
                    .among({"bash", "man", "schema"});
                words.add("--of", options->kind, "with schema: of this kind of file")
                    .among({protocols::kSchemaKinds.begin(), protocols::kSchemaKinds.end()})
                    .tells(options->of_kind);
            },
            [options, all] {
                refuse_if(options->of_kind && options->form != "schema",
                          "--of is for words schema, and this is words {}: leave it out",
                          options->form);
                say_to(stdout, options->form == "schema" ? protocols::json_schema(options->kind)
                               : options->form == "man"  ? man_page(all(), PALPATE_VERSION)
                                                         : bash_completion(all()));
                return 0;
            }};
}

}  // namespace palpate::ui

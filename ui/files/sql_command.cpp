#include <cstdio>
#include <iostream>
#include <string>

#include <fmt/format.h>
#include <unistd.h>

#include "engine/base/refuse.hpp"
#include "data/analysis/left_out.hpp"
#include "data/shell/sql_shell.hpp"
#include "ui/command/command.hpp"
#include "ui/files/analysed_file.hpp"
#include "ui/rig/control_line.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {
namespace {

struct SqlOptions {
    std::string database;
    std::optional<std::string> query;  ///< none: from standard input
    bool csv = false;
    bool json = false;
    bool attach = false;
    std::int64_t steps = data::SqlLimits{}.steps;
    std::string versions;  ///< empty: the file as it is stored
};

struct NoOptions {};

/// What analyses leave out of the file, beside what is asked for.
void hint(data::Database& database) {
    try {
        for (const data::LeftOut& one : data::left_out_everywhere(database, "all", false)) {
            say_to(stderr, data::left_out_text(one));
        }
    } catch (const data::StoreError&) {  // of tables that are others nothing can be said
    }
}

/// @param fresh  a statement begins
void prompt(bool person, bool fresh) {
    if (person) {
        say("{}", fresh ? "palpate> " : "    ...> ");
    }
    std::fflush(stdout);
}

/// Statements from standard input. At a terminal it goes on after an error.
int read_input(data::SqlShell& shell, const std::string& file) {
    const bool person = isatty(STDIN_FILENO) != 0;
    if (person) {
        say("palpate sql {}: it only reads. .help lists what there is.\n", file);
    }
    bool good = true;
    std::string text;
    std::size_t first = 1;
    std::size_t lines = 0;
    prompt(person, true);
    for (std::string line; !shell.quit() && std::getline(std::cin, line);
         prompt(person, text.empty())) {
        ++lines;
        first = text.empty() ? lines : first;
        text += line + '\n';
        if (data::SqlShell::complete(text)) {
            good = shell.run(text, first) && good;
            text.clear();
        }
        if (shell.quit()) {
            break;
        }
    }
    if (!text.empty() && !shell.quit()) {  // the last semicolon may be missing
        good = shell.run(text, first) && good;
    }
    if (person && !shell.quit()) {
        say("\n");
    }
    return good || person ? 0 : kExitFailure;
}

void declare(CommandWords& words, SqlOptions& options) {
    words.add("FILE", options.database, "A palpate database; nothing in it is changed").required();
    words.add("-c,--command", options.query,
              "SQL, or a word as .tables; without it a shell on standard input");
    words.add("--csv", options.csv, "Rows as CSV");
    words.add("--json", options.json, "Rows as one JSON array").excludes("--csv");
    words
        .add("--versions", options.versions,
             "The file as stats, fit, audit and report see it, versions of a protocol apart or "
             "together; without the word as it is stored")
        .among({"apart", "together"});
    words.add("--attach", options.attach, "Let ATTACH read other databases too");
    words.add("--steps", options.steps,
              "Steps of SQLite, and us of the processor, after which a statement is ended; a "
              "million rows need some ten million");
}

int run(const SqlOptions& options) {
    refuse_if(options.steps < 1, "--steps: give a number of steps, 1 or more");
    warn_of_unblinding(options.database);
    data::Database database(options.database, data::Access::inspect);
    if (!options.versions.empty()) {
        analyse(database, options.versions);
    }
    if (!options.versions.empty() || (!options.query && isatty(STDIN_FILENO) != 0)) {
        hint(database);
    }
    const data::RowFormat format = options.csv  ? data::RowFormat::csv
                                 : options.json ? data::RowFormat::json
                                                : data::RowFormat::table;
    data::SqlShell shell(database, format, stdout, stderr,
                         {.attach = options.attach, .tells = true, .steps = options.steps});
    if (options.query) {
        const bool good = shell.run(*options.query);
        refuse_if(good && !shell.asked(),
                  "-c: there is no statement in it: give SQL, or a word as .tables");
        return good ? 0 : kExitFailure;
    }
    return read_input(shell, options.database);
}

int print_extension(const NoOptions& /*none*/) {
    fmt::print("{}\n", beside_program("palpate_sample.so", "palpate_sample").string());
    return 0;
}

}  // namespace

Command sql_command() {
    return make_command<SqlOptions>(
        "sql", "Query a database: its tables, every servo tick (sample), statistics; only reads",
        declare, run);
}

Command extension_command() {
    return make_command<NoOptions>(
        "extension", "Print where the SQL extension is, for sqlite3, Python and R",
        [](CommandWords& /*none*/, NoOptions& /*none*/) {}, print_extension);
}

}  // namespace palpate::ui

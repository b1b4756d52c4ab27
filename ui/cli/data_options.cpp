#include <algorithm>
#include <memory>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "ui/cli/options_of.hpp"

namespace palpate::ui {
namespace {

void add_summary(CLI::App& app, Options& chosen) {
    CLI::App* command =
        app.add_subcommand("summary", "Confusion matrix and shares correct of a database");
    auto& summary = options_of<SummaryOptions>(command, chosen);
    command->add_option("FILE", summary.database, "A palpate database")->required();
}

void add_participant(CLI::App& app, Options& chosen) {
    CLI::App* command = app.add_subcommand(
        "participant",
        "Show what is noted of a participant, and note handedness, consent and more");
    auto& who = options_of<ParticipantOptions>(command, chosen);
    command->add_option("FILE", who.database, "The study's database file")->required();
    command->add_option("ID", who.participant, "Pseudonymous id: letters, digits, - and _")
        ->required();
    command
        ->add_option("--handedness", who.handedness, "Edinburgh score, -100 (left) to 100 (right)")
        ->check(CLI::Range(-100, 100));
    command->add_option("--consent", who.consent, "yes or no: consent to take part")
        ->check(one_of({"yes", "no"}));
    CLI::Option* registers =
        command->add_flag("--new", who.registers, "Registers somebody who is not in the file yet");
    command
        ->add_flag("--another", who.another,
                   "With --new, although a code in the file is much like it")
        ->needs(registers);
    command->add_option("--operator", who.operator_name, "Who notes it")->check(kept_text);
    command->add_option("--set", who.details, "KEY=VALUE, e.g. age=31; once for each")
        ->allow_extra_args(false)
        ->check(kept_text);
}

void add_note(CLI::App& app, Options& chosen) {
    CLI::App* command =
        app.add_subcommand("note", "Add an operator's note to a session, also while it runs");
    auto& note = options_of<NoteOptions>(command, chosen);
    command->add_option("FILE", note.database, "A palpate database")->required();
    command->add_option("TEXT", note.text, "The note")->required()->check(kept_text);
    command->add_option("--participant", note.participant, "Whose session")->required();
    command->add_option("--session", note.session, "Session number; without it the last one")
        ->check(CLI::PositiveNumber);
    command->add_option("--study", note.study, "The study's id, if there are several");
    command->add_option("--operator", note.operator_name, "Who notes it")->check(kept_text);
}

void add_mark(CLI::App& app, Options& chosen) {
    CLI::App* command = app.add_subcommand(
        "mark", "Say that the answer of a trial does not count; it is kept, with the reason");
    auto& mark = options_of<MarkOptions>(command, chosen);
    command->add_option("FILE", mark.database, "A palpate database")->required();
    command->add_option("TRIAL", mark.trial, "Its trial_id, as in analysis_trial")->required();
    command->add_option("--invalid", mark.reason, "Why it does not count")
        ->required()
        ->check(kept_text);
    command->add_option("--operator", mark.operator_name, "Who says so")->check(kept_text);
}

void add_verify(CLI::App& app, Options& chosen) {
    CLI::App* command = app.add_subcommand(
        "verify", "Recompute what a database says, replay every trial, say what differs");
    auto& verify = options_of<VerifyOptions>(command, chosen);
    command->add_option("FILE", verify.database, "A palpate database; nothing in it is changed")
        ->required();
    command->add_flag("--json", verify.json, "One JSON object instead of lines");
}

void add_sql(CLI::App& app, Options& chosen) {
    CLI::App* command = app.add_subcommand(
        "sql", "Query a database: its tables, every servo tick (sample), statistics; only reads");
    auto options = std::make_shared<SqlOptions>();
    command->add_option("FILE", options->database, "A palpate database; nothing in it is changed")
        ->required();
    command->add_option("-c,--command", options->query,
                        "SQL, or a word as .tables; without it a shell on standard input");
    CLI::Option* csv = command->add_flag("--csv", options->csv, "Rows as CSV");
    command->add_flag("--json", options->json, "Rows as one JSON array")->excludes(csv);
    command->callback([options, &chosen] { chosen = *options; });
    CLI::App* extension = app.add_subcommand(
        "extension", "Print where the SQL extension is, for sqlite3, Python and R");
    extension->callback([&chosen] { chosen = ExtensionOptions{}; });
}

void add_trace(CLI::App& app, Options& chosen) {
    CLI::App* command =
        app.add_subcommand("trace", "Print the stored ticks of a trial, whole numbers, as CSV");
    auto& trace = options_of<TraceOptions>(command, chosen);
    command->add_option("FILE", trace.database, "A palpate database")->required();
    command->add_option("TRIAL", trace.trial, "The id of the trial")->required();
    command
        ->add_option("--interval", trace.interval, "Of a trial with two things to feel, which one")
        ->check(CLI::Range(1, 2))
        ->capture_default_str();
}

void add_export(CLI::App& app, Options& chosen) {
    CLI::App* command = app.add_subcommand(
        "export", "Write a database as CSV, BIDS, Psych-DS or Parquet, de-identified");
    auto& words = options_of<ExportCommandOptions>(command, chosen);
    command->add_option("FILE", words.database, "A database; only read")->required();
    command
        ->add_option(
            "--format", words.format,
            "csv, bids, psych-ds, parquet, or procedure: runs of a rule for palpate procedure")
        ->check(one_of({"csv", "bids", "psych-ds", "parquet", "procedure"}))
        ->capture_default_str();
    command->add_option("-o,--output", words.directory, "A new folder")->required();
    command->add_option("--kind", words.kind, "Which sessions: real, pilot, simulated or all")
        ->check(one_of({"real", "pilot", "simulated", "all"}))
        ->capture_default_str();
    command->add_flag("--with-details", words.details,
                      "Operators, wall clock, notes, details of participants, provenance as well");
    command->add_flag("--traces", words.traces, "Every servo tick as well");
    command->add_flag("--keep-codes", words.keep_codes,
                      "codes.csv: which code of the lab each subject is");
}

void add_merge(CLI::App& app, Options& chosen) {
    CLI::App* command =
        app.add_subcommand("merge", "Bring the sessions of several files together in one");
    auto& files = options_of<MergeOptions>(command, chosen);
    command->add_option("OUT", files.database, "The file of all; made if it is not there")
        ->required();
    command->add_option("IN", files.inputs, "Files of rigs; only read")->required();
}

void add_push(CLI::App& app, Options& chosen) {
    CLI::App* command = app.add_subcommand("push", "Bring a file's new rows into PostgreSQL");
    auto& push = options_of<PushOptions>(command, chosen);
    command->add_option("FILE", push.database, "A database; only read");
    command->add_option("--to", push.url, "postgresql://..., with libpq's sslmode and sslrootcert");
    command->add_flag("--roles", push.roles,
                      "Print SQL for an administrator: the schema and two roles");
}

}  // namespace

std::string kept_text(const std::string& words) {
    return is_utf8(words) ? ""
                          : "these words are not UTF-8: set the terminal's encoding to UTF-8 "
                            "and give them again";
}

WordCheck one_of(std::vector<std::string> words) {
    return [words = std::move(words)](const std::string& given) -> std::string {
        if (std::find(words.begin(), words.end(), given) != words.end()) {
            return {};
        }
        return fmt::format("\"{}\" is none of {}{}", given, fmt::join(words, ", "),
                           suggestion(given, words, ""));
    };
}

void add_data_commands(CLI::App& app, Options& chosen) {
    add_summary(app, chosen);
    add_participant(app, chosen);
    add_note(app, chosen);
    add_mark(app, chosen);
    add_verify(app, chosen);
    add_sql(app, chosen);
    add_trace(app, chosen);
    add_export(app, chosen);
    add_merge(app, chosen);
    add_push(app, chosen);
}

}  // namespace palpate::ui

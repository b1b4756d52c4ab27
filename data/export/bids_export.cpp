#include "data/export/bids_export.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "engine/base/files.hpp"
#include "engine/base/text.hpp"
#include "data/export/bids_files.hpp"
#include "data/export/csv_export.hpp"
#include "data/export/json_text.hpp"
#include "data/export/table_sql.hpp"

namespace palpate::data {
namespace {

namespace fs = std::filesystem;

void write_json(const fs::path& path, const Json& members) {
    write_whole(path, json_text(members) + "\n");
}

Json described(const ExportColumn& column) {
    Json words{{"Description", column.meaning}};
    if (!column.unit.empty() && column.unit != "1") {
        words["Units"] = column.unit;
    }
    for (const auto& [level, what] : levels_of(column)) {
        words["Levels"][level] = what;
    }
    return words;
}

Json described(const char* words) {
    return {{"Description", words}};
}

const ExportColumn& trials_column(std::string_view name) {
    const auto& columns = export_table("trials").columns;
    return *std::find_if(columns.begin(), columns.end(),
                         [name](const ExportColumn& column) { return column.name == name; });
}

void write_rows(Statement row, DelimitedFile& file) {
    while (row.step()) {
        for (int column = 0; column < row.columns(); ++column) {
            file.value(row, column);
        }
        file.end_row();
    }
    file.close();
}

void write_participants(Database& database, bool details, const fs::path& folder) {
    DelimitedFile file(folder / "participants.tsv", Delimited::tsv);
    Json sidecar{
        {"participant_id", described("the same in every export; it says nothing")},
        {"handedness",
         {{"Description", "by the Edinburgh score"},
          {"Levels",
           {{"left", "-40 or less"}, {"right", "40 or more"}, {"ambidextrous", "between"}}}}}};
    std::string score;
    if (details) {
        sidecar["edinburgh_score"] =
            described("Edinburgh handedness score, -100 left to 100 right");
        score = ", handedness";
    }
    for (const auto& [name, words] : sidecar.items()) {
        file.text(name);
    }
    file.end_row();
    // The standard's word for both.
    write_rows(database.prepare(
                   fmt::format("SELECT DISTINCT chosen.subject, replace({}, 'both', "
                               "'ambidextrous'){} FROM chosen JOIN session USING (session_id) JOIN "
                               "participant USING (participant_id) ORDER BY chosen.subject",
                               kHandednessSql, score)),
               file);
    write_json(folder / "participants.json", sidecar);
}

void write_sessions(Database& database,
                    const std::string& subject,
                    bool details,
                    const fs::path& folder) {
    DelimitedFile file(folder / (subject + "_sessions.tsv"), Delimited::tsv);
    Json sidecar{{"session_id", described("the same number in every study of the session")},
                 {"studies", described("the tasks of the session")},
                 {"session_kind", described(trials_column("session_kind"))}};
    if (details) {
        sidecar["day"] = {{"Description", "since the participant's first session here"},
                          {"Units", "d"}};
    }
    for (const auto& [name, words] : sidecar.items()) {
        file.text(name);
    }
    file.end_row();
    Statement row = database.prepare(
        fmt::format("SELECT printf('ses-%02d', chosen.session_number), group_concat(label, ' '), "
                    "group_concat(DISTINCT session_kind){} FROM (SELECT * FROM chosen ORDER BY "
                    "label) AS chosen JOIN session USING (session_id) WHERE subject = ?1 GROUP BY "
                    "chosen.session_number ORDER BY chosen.session_number",
                    details ? ", min(day)" : ""));
    row.bind(1, std::string_view(subject));
    write_rows(std::move(row), file);
    write_json(folder / (subject + "_sessions.json"), sidecar);
}

/// The trials' columns but those that the name of the file says.
std::vector<ExportColumn> beh_columns(bool details) {
    std::vector<ExportColumn> columns = visible_columns(export_table("trials"), details);
    std::erase_if(columns, [](const ExportColumn& column) {
        return column.name == "subject" || column.name == "study_label" ||
               column.name == "session_number";
    });
    return columns;
}

void write_beh(Database& database,
               const ChosenSession& session,
               bool details,
               const fs::path& folder) {
    fs::create_directories(folder);
    const auto columns = beh_columns(details);
    const std::string stem = bids_stem(session) + "_beh";
    DelimitedFile file(folder / (stem + ".tsv"), Delimited::tsv);
    Json sidecar{{"TaskName", session.study}, {"TaskDescription", session.title}};
    for (const ExportColumn& column : columns) {
        file.text(column.name);
        sidecar[std::string(column.name)] = described(column);
    }
    file.end_row();
    Statement row =
        database.prepare(select_sql(export_table("trials"), columns, "chosen.session_id = ?1"));
    row.bind(1, session.id);
    write_rows(std::move(row), file);
    write_json(folder / (stem + ".json"), sidecar);
}

std::string readme(const Selection& selection, const ExportOptions& options) {
    return fmt::format(
        "# Felt shape: choices{}\n\n"
        "People felt an object they could not see through a two-degree-of-freedom pantograph, "
        "then\n"
        "chose what it was. Written by palpate as BIDS {}: {}, kind {}.\n\n"
        "What BIDS covers: participants, sessions, beh (one row an attempt at a trial, the "
        "columns\n"
        "described in the .json beside it){}.\n"
        "What it does not: the plan that was not run and the row of pictures; export CSV for "
        "these.\n"
        "Authors, licence and ethics approval are not known to palpate: add them to\n"
        "dataset_description.json before you share this.\n"
        "Units are SI. {}\n{}",
        options.traces ? ", motion and forces" : "", kBidsVersion,
        counted(selection.sessions().size(), "session"), options.kind,
        options.traces
            ? ", motion (the handle as POS; contact, rendered force, encoder\n"
              "counts and flags as MISC) and stim (the commanded force). run is the "
              "column trial_number of beh.\n"
              "motion.tsv has no head line, by the standard: channels.tsv names its columns.\n"
              "A lost tick is a row of n/a: row k is always tick k"
            : "",
        options.details ? "With details of people: hand it on to nobody who may not know them."
                        : "De-identified: codes, operators, wall clock and notes are left out.",
        selection.without_consent() == 0
            ? ""
            : counted(selection.without_consent(),
                      "participant who does not consent is left out.\n",
                      "participants who do not consent are left out.\n"));
}

}  // namespace

void export_bids(Database& database,
                 const Selection& selection,
                 const ExportOptions& options,
                 const std::filesystem::path& folder) {
    write_json(folder / "dataset_description.json",
               {{"Name", selection.titles()},
                {"BIDSVersion", kBidsVersion},
                {"DatasetType", "raw"},
                {"GeneratedBy", Json::array({{{"Name", "palpate"}}})}});
    write_whole(folder / "README", readme(selection, options));
    write_participants(database, options.details, folder);
    for (const ChosenSession& session : selection.sessions()) {
        const fs::path subject = folder / session.subject;
        const fs::path place = subject / fmt::format("ses-{:02}", session.number);
        write_beh(database, session, options.details, place / "beh");
        if (!fs::exists(subject / (session.subject + "_sessions.tsv"))) {
            write_sessions(database, session.subject, options.details, subject);
        }
        if (options.traces) {
            each_traced_trial(database, session, [&](std::int64_t trial, std::int64_t number) {
                write_bids_run(database, session, trial, number, place);
            });
        }
    }
    if (options.keep_codes) {
        fs::create_directory(folder / "sourcedata");
        write_codes(database, folder / "sourcedata" / "codes.csv");
    }
}

}  // namespace palpate::data

#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "engine/base/files.hpp"
#include "engine/base/text.hpp"
#include "data/csv/json_text.hpp"
#include "data/export/csv_export.hpp"
#include "data/export/selection.hpp"

namespace palpate::data {
namespace {

namespace fs = std::filesystem;

std::string stem_of(const ChosenSession& session) {
    return fmt::format("study-{}_subject-{}_session-{}", session.label, session.subject.substr(4),
                       session.number);
}

/// A column in schema.org's words: unitText is its unit, valuePattern a regular expression of its
/// levels.
Json variable(const ExportColumn& column) {
    Json words{{"@type", "PropertyValue"}, {"name", column.name}};
    std::string meaning(column.meaning);
    std::string pattern;
    for (const auto& [level, what] : levels_of(column)) {
        meaning += fmt::format("{}{}: {}", pattern.empty() ? ". " : "; ", level, what);
        pattern += fmt::format("{}{}", pattern.empty() ? "" : "|", level);
    }
    words["description"] = meaning;
    if (!column.unit.empty() && column.unit != "1") {
        words["unitText"] = column.unit;
    }
    if (!pattern.empty()) {
        words["valuePattern"] = pattern;
    }
    return words;
}

Json variables(const ExportOptions& options) {
    Json all = Json::array();
    std::set<std::string> named;
    const auto add = [&](const ExportColumn& column) {
        if (named.insert(column.name).second) {
            all.push_back(variable(column));
        }
    };
    for (const char* table : {"trials", "participants"}) {
        std::ranges::for_each(visible_columns(export_table(table), options.details), add);
    }
    if (options.traces) {
        std::ranges::for_each(tick_columns(), add);
    }
    return all;
}

/// What stands beside the data: for programs, and for people.
void write_description(const Selection& selection,
                       const ExportOptions& options,
                       const std::filesystem::path& folder) {
    const auto description = fmt::format(
        "Felt shape: choices of {} (kind {}), written by palpate, one row an attempt at a trial. "
        "SI units.{}",
        counted(selection.sessions().size(), "session"), options.kind,
        options.details ? "" : " De-identified.");
    write_whole(folder / "dataset_description.json",
                json_text({{"@context", "http://schema.org/"},
                           {"@type", "Dataset"},
                           {"name", selection.titles()},
                           {"description", description},
                           {"variableMeasured", variables(options)}}) +
                    "\n");
    write_whole(
        folder / "README.md",
        fmt::format(
            "{}\n\nIn data/, subject, study, session and trial name a row{}. An empty field: not "
            "known or not so.\nAuthors, licence and citation are not known to palpate: add them to "
            "dataset_description.json.\n",
            description,
            options.traces ? "; in files with description-ticks, interval and tick as well" : ""));
}

}  // namespace

void export_psych_ds(const Exporting& to) {
    const auto& [database, selection, options, folder] = to;
    const fs::path data = folder / "data";
    fs::create_directory(data);
    write_description(selection, options, folder);
    write_table(database, export_table("participants"), options,
                data / "description-participants_data.csv");
    const ExportTable& trials = export_table("trials");
    for (const ChosenSession& session : selection.sessions()) {
        const std::string stem = stem_of(session);
        write_table(database, trials, options, data / (stem + "_data.csv"), &session);
        if (options.traces) {
            each_traced_trial(database, session, [&](std::int64_t trial, std::int64_t number) {
                write_ticks(
                    database, trial, number, session,
                    data / fmt::format("{}_trial-{:04}_description-ticks_data.csv", stem, number));
            });
        }
    }
    if (options.keep_codes) {
        fs::create_directory(folder / "materials");
        write_codes(database, folder / "materials" / "codes.csv");
    }
}

}  // namespace palpate::data

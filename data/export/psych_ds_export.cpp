#include "data/export/psych_ds_export.hpp"

#include <set>

#include <fmt/format.h>

#include "protocols/design/counted.hpp"
#include "data/export/csv_export.hpp"
#include "data/export/json_text.hpp"
#include "data/report/text_file.hpp"
#include "data/trace/columns.hpp"

namespace palpate::data {
namespace {

namespace fs = std::filesystem;

std::string stem_of(const ChosenSession& session) {
    return fmt::format("study-{}_subject-{}_session-{}", session.label, session.subject.substr(4),
                       session.number);
}

std::string variable(std::string_view name, std::string_view meaning, std::string_view unit) {
    JsonMembers words{{"@type", json_string("PropertyValue")}, {"name", json_string(name)}};
    if (!meaning.empty()) {
        words.emplace_back("description", json_string(meaning));
    }
    if (!unit.empty() && unit != "1") {
        words.emplace_back("unitText", json_string(unit));
    }
    return json_object(words);
}

std::string variables(const ExportOptions& options) {
    std::vector<std::string> all;
    std::set<std::string_view> named;
    for (const ExportColumn& column : visible_columns(export_table("trials"), options.details)) {
        all.push_back(variable(column.name, column.meaning, column.unit));
        named.insert(column.name);
    }
    if (options.traces && named.insert("interval").second) {
        all.push_back(variable("interval", "of a trial with two things to feel: 1 or 2", ""));
    }
    for (const TraceColumn& column : trace_columns()) {
        if (options.traces && named.insert(column.name).second) {
            all.push_back(variable(column.name, "of a servo tick", column.unit));
        }
    }
    return json_array(all);
}

}  // namespace

void export_psych_ds(Database& database,
                     const Selection& selection,
                     const ExportOptions& options,
                     const std::filesystem::path& folder) {
    const fs::path data = folder / "data";
    fs::create_directory(data);
    const auto description = fmt::format(
        "Felt shape: choices of {} (kind {}), written by palpate, one row an attempt at a "
        "trial. "
        "SI units.{}",
        protocols::counted(selection.sessions().size(), "session"), options.kind,
        options.details ? "" : " De-identified.");
    write_text_file(folder / "dataset_description.json",
                    json_object({{"@context", json_string("http://schema.org/")},
                                 {"@type", json_string("Dataset")},
                                 {"name", json_string(selection.sessions().front().title)},
                                 {"description", json_string(description)},
                                 {"variableMeasured", variables(options)}}) +
                        "\n");
    write_text_file(folder / "README.md", description + "\n");
    const ExportTable& trials = export_table("trials");
    for (const ChosenSession& session : selection.sessions()) {
        const std::string stem = stem_of(session);
        write_session_table(database, trials, options, session, data / (stem + "_data.csv"));
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

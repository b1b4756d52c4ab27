#include <algorithm>
#include <array>
#include <set>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "engine/base/files.hpp"
#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "protocols/file/protocol_file.hpp"
#include "data/analysis/summary.hpp"
#include "data/csv/json_text.hpp"
#include "data/export/csv_export.hpp"
#include "data/export/selection.hpp"
#include "data/store/analysed.hpp"

namespace palpate::data {
namespace {

/// Subject, study, kind, condition, stimulus x, and how often it was answered with 1, of how many.
Statement counts(Database& database) {
    Statement row = database.prepare(fmt::format(
        "SELECT chosen.subject, chosen.label, session_kind, condition, stimulus, sum(k), count(*) "
        "FROM ({}) JOIN chosen USING (session_id) GROUP BY 1, 2, 3, 4, 5 ORDER "
        "BY 1, 2, 3, 4, 5",
        kGradedAnswers));
    refuse_if(!row.step(),
              "no session has two-interval or yes-no answers on a graded stimulus: take another "
              "format, as csv or psychopy");
    row.reset();
    return row;
}

/// What x is, a line a study.
std::string x_text(Database& database) {
    std::string text;
    for (const Statement& row : database.prepare(fmt::format(
             "SELECT DISTINCT chosen.label, protocol_toml FROM chosen JOIN session USING "
             "(session_id) JOIN study USING (study_id) WHERE session_id IN (SELECT session_id FROM "
             "({})) ORDER BY 1",
             kGradedAnswers))) {
        text += fmt::format("\nx of {}: {}.", row.text(0),
                            stimulus_text(protocols::stored_protocol(row.text(1))));
    }
    return text + '\n';
}

constexpr const char* kPsignifitText =
    "index.csv says whose each file is. Its lines are x,k,n: k of n answers at x were "
    "yes, or the comparison.\nIn Python, with psignifit 4:\n\n"
    "import numpy, psignifit\n"
    "data = numpy.loadtxt(FILE, delimiter=',', ndmin=2)\n"
    "psignifit.psignifit(data, experiment_type='equal asymptote')\n";

constexpr std::string_view kPsychopyText =
    "A file a session, with the columns of PsychoPy's wide CSV: a row an answer, in the "
    "order given.\n"
    "trials.thisN counts them from 0; trials.thisIndex is the place in the plan; "
    "trials.thisRepN says how often\nthat place was tried before. For analysis take "
    "phase main and counts 1. Times are in s.\n"
    "key_resp.keys is the object of the chosen picture, else a number: interval - 1; 0 no, 1 yes; "
    "a rating's level - 1.\nOf two intervals planned_object and curvature_per_m are the "
    "standard's, friction is the comparison's by its name in\nthe protocol; stimulus is what a "
    "rule chose instead. kind: a real, pilot or simulated session.\n";

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

void export_quickpsy(const Exporting& to) {
    const auto& [database, selection, options, folder] = to;
    DelimitedFile file(folder / "quickpsy.csv", TableStyle::csv);
    file.row("participant", "study", "kind", "condition", "x", "k", "n");
    write_rows(counts(database), file);
    write_whole(folder / "README.txt",
                "k of n answers at x were yes, or the comparison. In R, with quickpsy 0.1.6:\n\n"
                "d <- read.csv('quickpsy.csv', na.strings = character(), colClasses = "
                "c(participant = 'character',\n"
                "    study = 'character', kind = 'character', condition = 'character'))\n"
                "quickpsy::quickpsy(d, x, k, n, grouping = c('participant', 'study', 'kind', "
                "'condition'))\n\n"
                "(up to 0.1.5: grouping = .(participant, study, kind, condition)).\n" +
                    x_text(database));
}

void export_psignifit(const Exporting& to) {
    const auto& [database, selection, options, folder] = to;
    DelimitedFile index(folder / "index.csv", TableStyle::csv);
    index.row("file", "participant", "study", "kind", "condition");
    std::array<std::string, 4> before;
    std::string lines;
    std::string name;
    std::size_t files = 0;
    const auto keep = [&] {
        if (!name.empty()) {
            write_whole(folder / name, lines);
        }
        lines.clear();
    };
    for (const Statement& row : counts(database)) {
        const std::array whose{row.text(0), row.text(1), row.text(2), row.text(3)};
        const auto& [subject, study, kind, condition] = whose;
        if (whose != before) {
            keep();
            name = fmt::format("{}_{}_{}_{:03}.csv", subject, study, kind, ++files);
            index.row(name, subject, study, kind, condition);
            before = whose;
        }
        lines += fmt::format("{},{},{}\n", row.real(4), row.integer(5), row.integer(6));
    }
    keep();
    index.close();
    write_whole(folder / "README.txt", kPsignifitText + x_text(database));
}

void export_psychopy(const Exporting& to) {
    const auto& [database, selection, options, folder] = to;
    Statement row = database.prepare(
        "SELECT analysis_trial.attempt - 1, plan_position, phase, planned_object, friction, "
        "curvature_per_m, run_name, stimulus, coalesce(chosen_object, answer_code), correct, "
        "reaction_s, confidence, counts FROM analysis_trial WHERE session_id = ?1 AND answer_code "
        "IS NOT NULL ORDER BY trial_number");
    for (const ChosenSession& session : selection.sessions()) {
        DelimitedFile file(folder / fmt::format("{}_{}_ses-{:02}.csv", session.subject,
                                                session.label, session.number),
                           TableStyle::csv);
        file.row("trials.thisN", "trials.thisRepN", "trials.thisIndex", "phase", "planned_object",
                 "friction", "curvature_per_m", "run_name", "stimulus", "key_resp.keys",
                 "key_resp.corr", "key_resp.rt", "confidence", "counts", "participant", "session",
                 "kind", "expName");
        row.bind(1, session.id);
        for (std::int64_t n = 0; row.step(); ++n) {
            file.add(n);
            for (int column = 0; column < row.columns(); ++column) {
                file.add(row.value(column));
            }
            file.row(session.subject, session.number, session.kind, session.label);
        }
        row.reset();
        file.close();
    }
    write_whole(folder / "README.txt", kPsychopyText);
}

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

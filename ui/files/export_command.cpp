#include <nlohmann/json.hpp>

#include "engine/base/text.hpp"
#include "data/export/export.hpp"
#include "ui/command/command.hpp"
#include "ui/rig/control_line.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {
namespace {

struct ExportWords {
    std::string database;
    std::string format = "csv";  ///< csv, bids, psych-ds, parquet
    std::string directory;       ///< made; never one that holds something
    data::ExportOptions what{};
    bool json = false;
};

void declare(CommandWords& words, ExportWords& options) {
    words.add("FILE", options.database, "A database; only read").required();
    words
        .add("--format,--as", options.format,
             "csv, bids, psych-ds, parquet; procedure: runs of a rule for palpate procedure; "
             "quickpsy, psignifit: counts at each stimulus; psychopy: as its wide CSV")
        .among({data::kExportWords.begin(), data::kExportWords.end()});
    words.add("-o,--output", options.directory, "A new folder").required();
    words.add("--kind", options.what.kind, "Which sessions: real, pilot, simulated or all")
        .among({"real", "pilot", "simulated", "all"});
    words.add("--json", options.json,
              "For programs, to standard output: what is in the folder, and who is not");
    words.add("--with-details", options.what.details,
              "Operators, wall clock, notes, details of participants, provenance as well");
    words.add("--traces", options.what.traces, "Every servo tick as well");
    words.add("--keep-codes", options.what.keep_codes,
              "codes.csv: which code of the lab each subject is");
}

data::Json not_taken_json(const std::vector<data::NotTaken>& all) {
    data::Json list = data::Json::array();
    for (const data::NotTaken& one : all) {
        list.push_back({{"study", one.study}, {"kind", one.kind}, {"sessions", one.sessions}});
    }
    return list;
}

int run(const ExportWords& options) {
    warn_of_unblinding(options.database);
    const data::ExportSummary done =
        data::export_file(options.database, data::parse_export_format(options.format), options.what,
                          options.directory);
    if (options.json) {
        say("{}\n", data::json_text({{"folder", options.directory},
                                     {"format", options.format},
                                     {"kind", options.what.kind},
                                     {"sessions", done.sessions},
                                     {"details", options.what.details},
                                     {"traces", options.what.traces},
                                     {"codes", options.what.keep_codes},
                                     {"left_out", data::left_out_json(done.left_out)},
                                     {"not_taken", not_taken_json(done.not_taken)}}));
        return 0;
    }
    say("{}: {} as {}{}.\n", options.directory, counted(done.sessions, "session"), options.format,
        options.what.details      ? ", with details"
        : options.what.keep_codes ? ", with the participants' codes"
                                  : ", de-identified");
    for (const data::LeftOut& one : done.left_out) {
        say("{}", data::left_out_text(one));
    }
    for (const data::NotTaken& one : done.not_taken) {
        say("{}", data::not_taken_text(one));
    }
    say("  The folder holds nothing of who does not consent and of withdrawn sessions; whom a rule "
        "leaves out is in it.\n");
    return 0;
}

struct AnalysisWords {
    std::string action;
    std::string folder;
};

void declare_analysis(CommandWords& words, AnalysisWords& options) {
    words.add("ACTION", options.action, "init: analysis.R and analysis.py to begin with")
        .required()
        .among({"init"});
    words.add("FOLDER", options.folder, "A folder of palpate export --format csv").required();
}

int begin_analysis(const AnalysisWords& words) {
    for (const auto& file : data::write_starters(words.folder)) {
        say("{}\n", file.string());
    }
    return 0;
}

}  // namespace

Command export_command() {
    return make_command<ExportWords>(
        "export", "Write a database as CSV, BIDS, Psych-DS or Parquet, de-identified", declare,
        run);
}

Command analysis_command() {
    return make_command<AnalysisWords>(
        "analysis", "Scripts of R and Python that load an export, to begin an analysis with",
        declare_analysis, begin_analysis);
}

}  // namespace palpate::ui

#include "data/export/export.hpp"
#include "ui/command/command.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {
namespace {

struct AnalysisWords {
    std::string action;
    std::string folder;
};

void declare(CommandWords& words, AnalysisWords& options) {
    words.add("ACTION", options.action, "init: analysis.R and analysis.py to begin with")
        .required()
        .among({"init"});
    words.add("FOLDER", options.folder, "A folder of palpate export --format csv").required();
}

int run(const AnalysisWords& words) {
    for (const auto& file : data::write_starters(words.folder)) {
        say("{}\n", file.string());
    }
    return 0;
}

}  // namespace

Command analysis_command() {
    return make_command<AnalysisWords>(
        "analysis", "Scripts of R and Python that load an export, to begin an analysis with",
        declare, run);
}

}  // namespace palpate::ui

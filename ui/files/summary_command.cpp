
#include "data/analysis/summary.hpp"
#include "ui/command/command.hpp"
#include "ui/files/analysed_file.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {
namespace {

struct SummaryOptions {
    std::string versions = "apart";
    std::string database;
    bool json = false;
};

void declare(CommandWords& words, SummaryOptions& options) {
    words
        .add("FILE", options.database,
             "A palpate database; each study and kind of session, real, pilot or simulated, by "
             "itself")
        .required();
    words.add("--json", options.json, "For programs, to standard output");
    add_versions(words, options.versions);
}

int run(const SummaryOptions& options) {
    data::Database database(options.database, data::Access::read);
    analyse(database, options.versions);
    say("{}", options.json ? data::summary_json(database) : data::summary_text(database));
    return 0;
}

}  // namespace

Command summary_command() {
    return make_command<SummaryOptions>(
        "summary", "Confusion matrix and shares correct of a database", declare, run);
}

}  // namespace palpate::ui

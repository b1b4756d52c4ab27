#include <string>
#include <vector>

#include "engine/base/files.hpp"
#include "data/page/study_page.hpp"
#include "ui/command/command.hpp"
#include "ui/rig/say.hpp"
#include "ui/session/version.hpp"

namespace palpate::ui {
namespace {

struct ReportWords {
    std::string database;
    std::string output;
    std::string kind = "real";
    std::string study;
    bool keep_codes = false;
    std::vector<std::string> signals;
    std::int64_t simulations = 199;
    std::int64_t bootstrap = 500;
};

void declare(CommandWords& words, ReportWords& options) {
    words.add("FILE", options.database, "A palpate database; nothing in it is changed").required();
    words.add("-o,--output", options.output, "The page, as report.html").required();
    words.add("--kind", options.kind, "Which sessions: real, pilot or simulated; never two of them")
        .among({"real", "pilot", "simulated"})
        .with_default();
    words.add("--study", options.study, "Of a file with several studies, which");
    words.add("--keep-codes", options.keep_codes,
              "People by the lab's codes, not by numbers of the page");
    words
        .add("--signal", options.signals,
             "Of answers yes and no: a shape for which yes is right, as of palpate stats; again "
             "for each")
        .again_for_each();
    words
        .add("--simulations", options.simulations,
             "Of the mixed model without an effect, for its p, as of palpate stats; 0: none")
        .within(0, 1000000)
        .with_default();
    words
        .add(
            "--bootstrap", options.bootstrap,
            "Samples for intervals and bands of psychometric functions, as of palpate fit; 0: none")
        .within(0, 1000000)
        .with_default();
}

int run(const ReportWords& words) {
    require_writable(words.output, "<!DOCTYPE");
    data::Database database(words.database, data::Access::read);
    const std::string page =
        data::study_page(database, {.kind = words.kind,
                                    .study = words.study,
                                    .codes = words.keep_codes,
                                    .signals = words.signals,
                                    .simulations = static_cast<std::size_t>(words.simulations),
                                    .bootstrap = static_cast<std::size_t>(words.bootstrap),
                                    .version = kVersion});
    write_whole(words.output, page);
    say("{}: open it in a browser, or print it\n", words.output);
    return 0;
}

}  // namespace

Command report_command() {
    return make_command<ReportWords>(
        "report", "A study as one page to hand on: figures, tables, CSV and SQL, to print too",
        declare, run);
}

}  // namespace palpate::ui

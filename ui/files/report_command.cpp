#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/files.hpp"
#include "data/page/study.hpp"
#include "ui/command/command.hpp"
#include "ui/files/analysed_file.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {
namespace {

struct ReportWords : AnswerWords {
    std::string output;
    std::optional<std::int64_t> trial;
    std::vector<std::string> signals;
    std::int64_t simulations = 199;
    std::int64_t bootstrap = 500;
};

void declare_samples(CommandWords& words, ReportWords& options) {
    words
        .add("--simulations", options.simulations,
             "Of the mixed model without an effect, for its p, as of palpate stats; 0: none")
        .within(0, 1000000)
        .excludes("--trial");
    words
        .add(
            "--bootstrap", options.bootstrap,
            "Samples for intervals and bands of psychometric functions, as of palpate fit; 0: none")
        .within(0, 1000000)
        .excludes("--trial");
    add_versions(words, options.versions).excludes("--trial");
}

void declare(CommandWords& words, ReportWords& options) {
    words.add("FILE", options.file, "A palpate database; nothing in it is changed").required();
    words.add("-o,--output", options.output, "The page, as report.html").required();
    words.add("--trial", options.trial,
              "A page of one trial instead, by its trial_id: what the hand did, its path, every "
              "tick to zoom into");
    add_kind(words, options.kind, "Which sessions: real, pilot or simulated; never two of them")
        .excludes("--trial");
    words.add("--study", options.study, "Of a file with several studies, which")
        .excludes("--trial");
    words.add("--keep-codes", options.keep_codes,
              "People by the lab's codes, not by numbers of the page");
    words
        .add("--signal", options.signals,
             "Of answers yes and no: a shape for which yes is right, as of palpate stats; again "
             "for each")
        .again_for_each()
        .excludes("--trial");
    declare_samples(words, options);
}

int run(const ReportWords& words) {
    require_writable(words.output, "<!DOCTYPE");
    data::Database database(words.file, data::Access::read);
    analyse(database, words.versions, words.study);
    const std::string page =
        words.trial
            ? data::trial_page(
                  database,
                  {.trial = *words.trial, .codes = words.keep_codes, .version = PALPATE_VERSION})
            : data::study_page(database,
                               {.kind = words.kind,
                                .study = words.study,
                                .codes = words.keep_codes,
                                .signals = words.signals,
                                .simulations = static_cast<std::size_t>(words.simulations),
                                .bootstrap = static_cast<std::size_t>(words.bootstrap),
                                .version = PALPATE_VERSION});
    write_whole(words.output, page, words.keep_codes ? Rights::own : Rights::usual);
    say("{} ({} kB): open it in a browser, or print it\n", words.output,
        (page.size() + 999) / 1000);
    return 0;
}

}  // namespace

Command report_command() {
    return make_command<ReportWords>(
        "report",
        "A study, or a trial, as one page to hand on: figures, tables, CSV and SQL, to print too",
        declare, run);
}

}  // namespace palpate::ui

#include <filesystem>
#include <string>
#include <vector>

#include "engine/base/files.hpp"
#include "engine/base/refuse.hpp"
#include "data/inference/stats_report.hpp"
#include "ui/command/command.hpp"
#include "ui/files/analysed_file.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {
namespace {

struct StatsWords : AnswerWords {
    bool json = false;
    std::string script;
    std::string baseline;
    std::vector<std::string> signals;
    std::int64_t alternatives = 0;
    bool other_answers = false;
    std::int64_t permutations = 999;
    std::int64_t simulations = 999;
    std::int64_t nodes = 15;
    double prior_scale = data::kJzsScale;
    std::optional<std::uint64_t> seed;
};

/// How exactly it is computed, and which trials of a database are taken.
void declare_numbers(CommandWords& words, StatsWords& options) {
    words
        .add("--permutations", options.permutations,
             "Of each person's answers, for the bits that a guesser shows; 0: none")
        .within(0, 1000000);
    words
        .add("--simulations", options.simulations,
             "Of the mixed model without an effect, for its p; 0: none")
        .within(0, 1000000);
    words.add("--nodes", options.nodes, "Of the adaptive Gauss-Hermite quadrature, a side")
        .within(1, 40);
    words
        .add("--prior-scale", options.prior_scale,
             "r of the Bayes factor's Cauchy prior of the standardised effect")
        .within(0.01, 100.0);
    words.add("--seed", options.seed, "Of permutations and simulations; 1 without it");
    add_answer_words(words, options);
}

void declare(CommandWords& words, StatsWords& options) {
    words
        .add("FILE", options.file,
             "A palpate database, or a CSV of any lab: subject,trial,shape,friction,response and, "
             "if there, rt_s, confidence, explore_s, since_break, excluded")
        .required();
    words.add("--json", options.json, "For programs, to standard output");
    words.add("--emit-r", options.script,
              "Also a new script of R that computes the same numbers, and its trials beside it as "
              ".csv");
    words.add("--baseline", options.baseline,
              "The friction that others are compared with; without it the first by name, of a "
              "database the one of least friction");
    words
        .add("--signal", options.signals,
             "Of answers yes and no: a shape for which yes is right; again for each")
        .again_for_each();
    words
        .add("--alternatives", options.alternatives,
             "How many pictures an answer was one of; without it those that occur")
        .within(2, 100);
    words.add("--other-answers", options.other_answers,
              "Of a CSV: answers that name no shape are pictures that nobody felt, and wrong; "
              "without it they are refused");
    declare_numbers(words, options);
}

/// The trials beside a script: its name, with .csv.
std::filesystem::path trials_beside(const std::filesystem::path& script) {
    std::filesystem::path trials = script;
    trials.replace_extension(".csv");
    refuse_if(
        trials == script || script.filename().empty(),
        "--emit-r is {}: give a script's name, as analysis.R; its trials go beside it into .csv",
        script.string());
    return trials;
}

int run(const StatsWords& words) {
    const std::filesystem::path trials_file =
        words.script.empty() ? std::filesystem::path() : trials_beside(words.script);
    const bool database = data::is_database(words.file);
    if (!database) {
        words.refuse_words_of_databases();
    }
    refuse_if(database && words.other_answers,
              "{} is a database: --other-answers is for a CSV; a database knows its pictures",
              words.file);
    data::TrialTable table =
        database ? words.asked(data::stored_trials)
                 : data::read_trials(data::RereadableText(words.file), words.other_answers);
    if (!words.baseline.empty()) {
        data::compare_with(table, words.baseline);
    }
    const data::StatsReport report = data::stats_of(
        std::move(table), {.signals = words.signals,
                           .alternatives = static_cast<std::size_t>(words.alternatives),
                           .permutations = static_cast<std::size_t>(words.permutations),
                           .simulations = static_cast<std::size_t>(words.simulations),
                           .seed = words.seed.value_or(1),
                           .nodes = static_cast<int>(words.nodes),
                           .prior_scale = words.prior_scale});
    if (!words.script.empty()) {
        const Rights rights = words.keep_codes ? Rights::own : Rights::usual;
        write_new(trials_file, data::trials_csv(report.table), rights);
        write_new(words.script, data::stats_r(report, trials_file.filename().string()), rights);
    }
    say("{}", words.json ? data::stats_json(report) : data::stats_text(report));
    return 0;
}

}  // namespace

Command stats_command() {
    return make_command<StatsWords>(
        "stats",
        "What trials say of people: friction within person, d', bits, times, confidence, learning",
        declare, run);
}

}  // namespace palpate::ui

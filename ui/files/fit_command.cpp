#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "engine/base/files.hpp"
#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "data/choice/identification.hpp"
#include "data/csv/csv_text.hpp"
#include "data/csv/number_table.hpp"
#include "data/fit/fit_report.hpp"
#include "data/plot/figure.hpp"
#include "data/store/analysed.hpp"
#include "ui/command/command.hpp"
#include "ui/files/analysed_file.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {
namespace {

struct FitWords : AnswerWords {
    std::string function = "normal";
    std::optional<std::string> guess;
    std::string lapse = "0.02";
    std::vector<std::string> priors;
    std::optional<std::string> at;
    std::int64_t bootstrap = 2000;
    std::optional<std::uint64_t> seed;
    bool json = false;
    std::string svg;
    std::vector<std::string> items;
    std::string baseline;
    bool of_curves = false;  ///< a word of psychometric functions is said
};

/// A number, or one over another: "1/3".
/// @param words  what may stand there too: "free or shared"
/// @throws std::invalid_argument that names the option
double number_of(const std::string& option, std::string_view text, std::string_view words = "") {
    const auto one = [&](std::string_view part) {
        const auto value = parsed<double>(part);
        refuse_if(!value || !std::isfinite(*value),
                  "{} is \"{}\": give a number, as 0.5 or 1/3{}{}", option, text,
                  words.empty() ? "" : ", or ", words);
        return *value;
    };
    const std::size_t slash = text.find('/');
    const double value = slash == std::string_view::npos
                           ? one(text)
                           : one(text.substr(0, slash)) / one(text.substr(slash + 1));
    refuse_if(!std::isfinite(value), "{} is \"{}\": give a finite number, as 0.5 or 1/3", option,
              text);
    return value + 0.0;  // -0 is 0
}

/// "slope=1.5,0.7" of --prior.
void set_prior(data::CurveSpec& spec, const std::string& text) {
    const std::size_t equals = text.find('=');
    const std::size_t comma = text.find(',', equals == std::string::npos ? 0 : equals);
    const std::string name = text.substr(0, equals);
    std::optional<data::Prior>* target = name == "threshold" ? &spec.threshold_prior
                                       : name == "slope"     ? &spec.slope_prior
                                       : name == "guess"     ? &spec.guess_prior
                                       : name == "lapse"     ? &spec.lapse_prior
                                                             : nullptr;
    refuse_if(target == nullptr || comma == std::string::npos,
              "--prior is \"{}\": give threshold=MEAN,SD (weibull: MEDIAN,SD of the logarithm), "
              "slope=MEDIAN,SD of the logarithm, guess=A,B or lapse=A,B of a beta density",
              text);
    refuse_if(target->has_value(), "--prior {} is there twice: give one belief for each", name);
    *target = data::Prior{number_of("--prior " + name, text.substr(equals + 1, comma - equals - 1)),
                          number_of("--prior " + name, text.substr(comma + 1))};
}

void check_priors(const data::CurveSpec& spec) {
    refuse_if(spec.guess_prior && !spec.guess_free,
              "--prior guess says what is believed of a rate that is given: give --guess free, or "
              "no such prior");
    refuse_if(spec.lapse_prior && !spec.lapse_free,
              "--prior lapse says what is believed of a rate that is given: give --lapse free, or "
              "no such prior");
}

data::CurveSpec spec_of(const FitWords& words, bool database) {
    data::CurveSpec spec;
    const auto& families = protocols::kFamilyWords;
    spec.family = static_cast<protocols::Family>(std::ranges::find(families, words.function) -
                                                 families.begin());
    const std::string guess = words.guess.value_or(database ? "lapse" : "0");
    spec.two_sided = guess == "lapse";
    spec.guess_shared = guess == "shared";
    spec.guess_free = spec.guess_shared || guess == "free";
    spec.lapse_shared = words.lapse == "shared";
    refuse_if(spec.guess_shared && spec.lapse_shared,
              "--guess and --lapse are both shared: give one of them as free or as a number");
    spec.lapse_free = spec.lapse_shared || words.lapse == "free";
    spec.lapse = spec.lapse_free ? 0.0 : number_of("--lapse", words.lapse, "free or shared");
    spec.guess = spec.two_sided  ? spec.lapse
               : spec.guess_free ? 0.0
                                 : number_of("--guess", guess, "free, shared or lapse");
    for (const std::string& prior : words.priors) {
        set_prior(spec, prior);
    }
    check_priors(spec);
    check(spec);
    return spec;
}

/// How often it is resampled, what is written, and which answers of a database are taken.
void declare_study(CommandWords& words, FitWords& options) {
    words.add("--bootstrap", options.bootstrap, "Samples of the bootstrap; 0: none")
        .within(0, 1000000)
        .tells(options.of_curves);
    words.add("--seed", options.seed, "Of the bootstrap; 1 without it").tells(options.of_curves);
    words.add("--json", options.json, "For programs, to standard output");
    words.add("--svg", options.svg, "Also a drawing of the curves, into this file")
        .tells(options.of_curves);
    words.add("--baseline", options.baseline,
              "The condition that others are compared with; without it the first by name, of a "
              "database the first run or the least friction");
    add_answer_words(words, options);
    words
        .add("--item", options.items,
             "Of identifications: NAME=VALUE, what an item is ordered by; again for each. Of a "
             "database without it the curvature")
        .again_for_each();
}

void declare(CommandWords& words, FitWords& options) {
    words
        .add("FILE", options.file,
             "A palpate database, or a CSV of any lab: stimulus,n,k and, if there, participant and "
             "condition")
        .required();
    words
        .add("--function", options.function,
             "normal, logistic, weibull, gumbel, or a Weibull of a logarithmic stimulus: "
             "weibull_log10, weibull_db")
        .among({protocols::kFamilyWords.begin(), protocols::kFamilyWords.end()})
        .tells(options.of_curves);
    words
        .add("--guess", options.guess,
             "Chance of a 1 without any stimulus: a number (of 3 alternatives 1/3), free, shared: "
             "free, one for all conditions of a person, or lapse: as the lapse rate. Without it "
             "0; for a database lapse")
        .tells(options.of_curves);
    words.add("--lapse", options.lapse,
              "Share of answers that are lapses: a number, free, or shared: free, one for all "
              "conditions of a person");
    words
        .add("--prior", options.priors,
             "What is believed before (MAP): threshold=MEAN,SD (weibull: MEDIAN,SD of ln), "
             "slope=MEDIAN,SD of ln, guess=A,B, lapse=A,B (beta)")
        .again_for_each()
        .tells(options.of_curves);
    words.add("--at", options.at, "Also the stimulus at which this share of answers is 1")
        .tells(options.of_curves);
    declare_study(words, options);
}

/// The head of a CSV names a response and no stimulus: trials of identification, not counts.
bool is_trial_csv(const data::RereadableText& text) {
    const std::string line = first_line(text.place());
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    const auto head = data::fields_of(std::string_view(line).substr(
        line.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0));
    const auto has = [&](std::string_view column) {
        return std::ranges::find(head, column, &data::Field::text) != head.end();
    };
    return has("response") && !has("stimulus");
}

/// Whose answers they are: a file's name may hold a code.
std::string source_of(const FitWords& words, bool database, const std::string& study) {
    const std::string kind = database && words.kind != "real" ? ", " + words.kind + " data" : "";
    return (database && !words.keep_codes ? "study " + study : words.file) + kind;
}

/// The text of a CSV; nothing of a database.
using Csv = std::optional<data::RereadableText>;

int fit_identifications(const FitWords& words, const Csv& csv) {
    data::IdentificationOptions options{.lapse = number_of("--lapse", words.lapse)};
    data::TrialTable table =
        csv ? data::read_trials(*csv)
            : words.asked([&](data::Database& file, const data::AnswerChoice& choice) {
                  data::TrialTable stored = data::stored_trials(file, choice);
                  options.items = data::item_values(file, stored.study);
                  return stored;
              });
    table.source = source_of(words, !csv, table.study);
    if (!words.baseline.empty()) {
        data::compare_with(table, words.baseline);
    }
    for (const std::string& item : words.items) {
        const std::size_t equals = item.rfind('=');
        refuse_if(equals == std::string::npos || equals == 0,
                  "--item is \"{}\": give NAME=VALUE, as flat=0", item);
        const std::string name = item.substr(0, equals);
        refuse_if(!options.given.insert(name).second,
                  "--item {} is there twice: give one value for each item", name);
        options.items[name] = number_of("--item " + name, item.substr(equals + 1));
    }
    const data::IdentificationReport report = data::identification_of(std::move(table), options);
    say("{}", words.json ? data::identification_json(report) : data::identification_text(report));
    return 0;
}

/// Options that a fit of identifications does not read.
void refuse_words_of_curves(const FitWords& words) {
    refuse_if(words.of_curves || words.lapse == "free" || words.lapse == "shared",
              "{} holds identifications: --function, --guess, --prior, --at, --bootstrap, --seed, "
              "--svg and --lapse free are for psychometric functions",
              words.file);
}

/// The order of the conditions, with what they are compared with first.
std::vector<std::string> order_of(const data::StoredAnswers& answers, const std::string& baseline) {
    std::vector<std::string> order = answers.conditions;
    if (baseline.empty()) {
        return order;
    }
    std::set<std::string> known;
    for (const data::Answers& one : answers.all) {
        known.insert(one.condition);
    }
    refuse_if(known == std::set<std::string>{""},
              "--baseline is {}: there are no conditions here to compare; leave it out", baseline);
    refuse_if(!known.contains(baseline), "--baseline is {}: give one of {}", baseline,
              fmt::join(known, ", "));
    std::erase(order, baseline);
    order.insert(order.begin(), baseline);
    return order;
}

data::FitOptions options_of(const FitWords& words, bool database) {
    data::FitOptions options{.spec = spec_of(words, database),
                             .bootstrap = static_cast<std::size_t>(words.bootstrap),
                             .seed = words.seed.value_or(1)};
    if (words.at) {
        options.at = number_of("--at", *words.at);
        refuse_if(!(*options.at > 0.0 && *options.at < 1.0),
                  "--at is {}: give a share between 0 and 1", *words.at);
    }
    return options;
}

data::StoredAnswers answers_of(const FitWords& words, protocols::Family family, const Csv& csv) {
    return csv ? data::StoredAnswers{.all = data::read_answers(*csv, family)}
               : words.asked(data::stored_answers);
}

int run(const FitWords& words) {
    const bool database = data::is_database(words.file);
    Csv csv;  // its head is looked at before it is read
    if (!database) {
        words.refuse_words_of_databases();
        csv.emplace(words.file);
    }
    if (csv ? is_trial_csv(*csv) : words.asked(data::answers_are_names)) {
        refuse_words_of_curves(words);
        return fit_identifications(words, csv);
    }
    refuse_if(!words.items.empty(),
              "{} holds no identifications: --item is for answers that name one of several items",
              words.file);
    data::FitOptions options = options_of(words, database);
    const data::StoredAnswers answers = answers_of(words, options.spec.family, csv);
    const auto account =
        database ? std::optional(answers.left_out) : std::optional<data::LeftOut>();
    refuse_if(database && answers.all.empty(),
              "{}: everybody is left out by the protocol's rules{}", words.file, below(account));
    options.conditions = order_of(answers, words.baseline);
    options.stimulus = answers.stimulus;
    require_writable(words.svg, "<svg");
    data::FitReport report =
        data::fit_all(source_of(words, database, answers.study), answers.all, options);
    refuse_if(report.curves.empty(), "{}: {}{}", report.source,
              report.left_out.empty() ? "there are no answers" : text_of(report.left_out.front()),
              below(account));
    report.versions = answers.versions;
    report.file_left_out = account;
    if (!words.svg.empty()) {
        write_whole(words.svg, data::svg(data::fit_figure(report)),
                    words.keep_codes ? Rights::own : Rights::usual);
    }
    say("{}", words.json ? data::fit_json(report) : data::fit_text(report));
    return 0;
}

}  // namespace

Command fit_command() {
    return make_command<FitWords>(
        "fit", "Psychometric functions of a database or a CSV: thresholds, JND, intervals", declare,
        run);
}

}  // namespace palpate::ui

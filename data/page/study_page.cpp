#include <algorithm>
#include <future>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "data/fit/fit_report.hpp"
#include "data/page/sections.hpp"
#include "data/page/study.hpp"
#include "data/store/analysed.hpp"

namespace palpate::data {
namespace {

/// Of the sessions on the page; nothing of them is left where the rules leave out everybody.
bool any(Database& database, const Study& study, std::string_view from) {
    return !study.nobody_left() &&
           database.first(fmt::format("SELECT EXISTS (SELECT 1 FROM {})", from),
                          std::string_view(study.name), std::string_view(study.options.kind))
                   .integer(0) == 1;
}

/// The trials that palpate stats takes without other words.
std::optional<TrialTable> stats_trials(Database& database, const Study& study) {
    const bool answered = any(database, study,
                              "analysis_trial WHERE study_name = ?1 AND session_kind = ?2 AND "
                              "phase = 'main' AND answer_code IS NOT NULL AND run_number IS NULL "
                              "AND (chosen_object IS NOT NULL OR study_name IN (SELECT study_name "
                              "FROM study WHERE protocol_toml LIKE '%kind = \"yes_no\"%'))");
    const PageOptions& options = study.options;
    return answered
             ? std::optional(stored_trials(
                   database, {.kind = options.kind, .study = study.name, .codes = options.codes}))
             : std::nullopt;
}

/// The answers that palpate fit takes without other words; people as on the page.
StoredAnswers fit_answers(Database& database, const Study& study) {
    if (!any(database, study,
             fmt::format("({}) WHERE study_name = ?1 AND session_kind = ?2", kGradedAnswers))) {
        return {};
    }
    StoredAnswers answers =
        stored_answers(database, {.kind = study.options.kind, .study = study.name});
    for (Answers& one : answers.all) {
        one.participant = study.person(one.participant);
    }
    return answers;
}

/// As palpate fit does without other words, then in the page's order of people.
FitReport fit_numbers(const Study& study, const StoredAnswers& answers) {
    constexpr double kLapse = 0.02;
    FitOptions options{.bootstrap = study.options.bootstrap,
                       .conditions = answers.conditions,
                       .stimulus = answers.stimulus};
    options.spec = {.guess = kLapse, .lapse = kLapse, .two_sided = true};
    FitReport fit = fit_all(study.name, answers.all, options);
    if (!study.options.codes) {
        std::ranges::stable_sort(fit.curves, {}, [](const FittedCurve& curve) {
            return std::stoul(curve.answers.participant);
        });
    }
    return fit;
}

std::optional<Audit> audit_numbers(Database& database,
                                   const Study& study,
                                   const AuditBounds& bounds) {
    const bool two = any(database, study,
                         "(SELECT count(DISTINCT friction) AS n FROM exploration WHERE study_name "
                         "= ?1 AND session_kind = ?2 AND phase = 'main' AND counts) WHERE n > 1");
    return two ? std::optional(
                     audit_of(database, {.kind = study.options.kind, .study = study.name}, bounds))
               : std::nullopt;
}

/// The commands that compute them again; no numbers yet.
PageNumbers commands_of(const Study& study, const PageOptions& options) {
    PageNumbers numbers;
    numbers.stats_words =
        fmt::format("palpate stats {}{} --simulations {}{} --json", study.file, study.words,
                    options.simulations, options.codes ? " --keep-codes" : "");
    for (const std::string& signal : options.signals) {
        numbers.stats_words += " --signal " + signal;
    }
    numbers.fit_words = fmt::format("palpate fit {}{} --bootstrap {} --json", study.file,
                                    study.words, options.bootstrap);
    numbers.audit_words = fmt::format("palpate audit {}{}", study.file, study.words);
    return numbers;
}

}  // namespace

std::string study_page(Database& database, const PageOptions& options) {
    const Snapshot now(database);
    keep_attempts(database);
    const Study study(database, options);
    PageNumbers numbers = commands_of(study, options);

    // Statistics need no database any more: they are computed, into members of their own, while
    // the rest is asked for.
    std::optional<TrialTable> trials = stats_trials(database, study);
    const StoredAnswers answers = fit_answers(database, study);
    refuse_if(!trials && !options.signals.empty(),
              "--signal is for answers of yes and no: there are none without a rule here");
    auto computed = std::async(std::launch::async, [&] {
        if (trials) {
            numbers.stats = stats_of(*std::move(trials), {.signals = options.signals,
                                                          .simulations = options.simulations});
        }
        if (!answers.all.empty()) {
            numbers.fit = fit_numbers(study, answers);
        }
    });
    numbers.audit = audit_numbers(database, study, numbers.bounds);
    PageWriter last(study);
    add_exploration(last, study);
    add_audit(last, study, numbers);
    add_health(last, study);
    add_provenance(last, study);
    computed.get();

    PageWriter page(study);
    add_facts(page, study, numbers);
    add_flow(page, study, numbers);
    add_answers(page, study, numbers);
    add_ratings(page, study);
    add_levels(page, study, numbers);
    add_times(page, study, numbers);
    add_methods(last, study, numbers);
    page.append(last);
    const std::string title = study.title.empty() ? study.name : study.title;
    return page.page(
        {.kind = options.kind,
         .version = options.version,
         .kicker = fmt::format("Protocol {}, {} data", study.name, options.kind),
         .title = title,
         .footer = fmt::format(
             "Made by palpate {} from {}. No day, no name{} is on this page.", options.version,
             options.codes
                 ? study.file
                 : "the study's database, called FILE here, whose newest seals stand above",
             options.codes ? "" : ", no code of a participant and no name of a file")});
}

}  // namespace palpate::data

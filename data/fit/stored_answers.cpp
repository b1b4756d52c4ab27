#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <set>
#include <tuple>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "protocols/file/protocol_file.hpp"
#include "protocols/session/progress.hpp"
#include "data/analysis/summary.hpp"
#include "data/csv/csv_text.hpp"
#include "data/csv/number_table.hpp"
#include "data/fit/fit_report.hpp"
#include "data/store/analysed.hpp"
#include "data/store/stored_progress.hpp"

namespace palpate::data {
namespace {

void add_beliefs(Database& database, const AnswerChoice& choice, std::vector<Answers>& all) {
    Statement row = database.prepare(
        "SELECT DISTINCT participant_code, session_number, session_id, run_number, run_name FROM "
        "analysis_trial WHERE counts AND phase = 'main' AND run_trial_number IS NOT NULL AND "
        "study_name = ?1 AND session_kind = ?2 ORDER BY 1, 2, 4",
        choice.study, choice.kind);
    while (row.step()) {
        const auto found = std::ranges::find_if(all, [&](const Answers& one) {
            return one.participant == row.text(0) && one.condition == row.text(4);
        });
        if (found == all.end()) {
            continue;
        }
        try {
            const auto runs = runs_that_count(database, row.integer(2));
            const protocols::Procedure& procedure =
                runs.of(static_cast<std::size_t>(row.integer(3)));
            std::vector<protocols::Estimate> estimates = procedure.estimates();
            if (const auto jnd = procedure.jnd()) {
                estimates.push_back(*jnd);
            }
            for (protocols::Estimate& one : estimates) {
                if (one.mean && one.low) {  // a staircase believes nothing
                    one.name = fmt::format("session {}, {}", row.integer(1), one.name);
                    found->believed.push_back(one);
                }
            }
        } catch (const std::exception&) {  // palpate verify says it
        }
    }
}

/// People by their numbers in exports, and in the order of these.
void number_people(Database& database, std::vector<Answers>& all) {
    for (Answers& one : all) {
        one.participant = fmt::format(
            "sub-{:010}", database
                              .first("SELECT subject FROM participant WHERE participant_code = ?1",
                                     one.participant)
                              .integer(0));
    }
    std::ranges::stable_sort(all, {}, &Answers::participant);
}

/// By name, whatever order they are in.
void give_streams(std::vector<Answers>& all) {
    std::vector<Answers*> by_name;
    for (Answers& one : all) {
        by_name.push_back(&one);
    }
    std::ranges::sort(
        by_name, {}, [](const Answers* one) { return std::tie(one->participant, one->condition); });
    for (std::size_t i = 0; i < by_name.size(); ++i) {
        by_name[i]->stream = i;
    }
}

std::vector<std::string> conditions_of(Database& database, const AnswerChoice& choice) {
    return texts(database.prepare(
        "SELECT name FROM (SELECT run_name AS name, run_number AS place FROM analysis_trial WHERE "
        "study_name = ?1 AND session_kind = ?2 AND run_name IS NOT NULL UNION ALL SELECT friction, "
        "mu_s FROM plan JOIN session USING (session_id) JOIN study USING (study_id) WHERE "
        "study_name = ?1 AND session_kind = ?2 AND phase = 'main') GROUP BY name ORDER BY "
        "min(place), name",
        choice.study, choice.kind));
}

/// @throws std::invalid_argument if versions of a protocol differ in it
std::string stimulus_of(Database& database, const AnswerChoice& choice) {
    std::set<std::string> all;
    for (const std::string& toml :
         texts(database.prepare("SELECT DISTINCT protocol_toml FROM study JOIN session USING "
                                "(study_id) WHERE study_name = ?1 AND session_kind = ?2",
                                choice.study, choice.kind))) {
        all.insert(stimulus_text(protocols::stored_protocol(toml)));
    }
    refuse_if(all.size() > 1,
              "the versions of {} have different stimuli, {}: no curve goes through both; take "
              "them apart, --versions apart",
              choice.study, fmt::join(all, " and "));
    return *all.begin();
}

constexpr double kMaxAnswers = 1e6;

}  // namespace

bool answers_are_names(Database& database, const AnswerChoice& choice) {
    Statement row = database.first(
        fmt::format("SELECT NOT EXISTS (SELECT 1 FROM ({}) WHERE session_kind = ?1 AND ?2 IN ('', "
                    "study_name)) AND EXISTS (SELECT 1 FROM analysis_trial WHERE phase = 'main' "
                    "AND run_number IS NULL AND chosen_object IS NOT NULL AND ?1 = session_kind "
                    "AND ?2 IN ('', study_name))",
                    kGradedAnswers),
        choice.kind, choice.study);
    return row.integer(0) != 0;
}

StoredAnswers stored_answers(Database& database, const AnswerChoice& asked) {
    const Snapshot now(database);
    AnswerChoice choice = asked;
    std::set<std::string> studies;
    std::vector<std::pair<std::string, Answers>> found;
    Statement row = database.prepare(
        fmt::format(
            "SELECT study_name, participant_code, condition, stimulus, count(*), sum(k) FROM ({}) "
            "WHERE session_kind = ?1 GROUP BY 1, 2, 3, 4 ORDER BY 1, 2, 3, 4",
            kGradedAnswers),
        choice.kind);
    while (row.step()) {
        const std::string study = row.text(0);
        if (!choice.study.empty() && study != choice.study) {
            continue;
        }
        studies.insert(study);
        if (found.empty() || found.back().first != study ||
            found.back().second.participant != row.text(1) ||
            found.back().second.condition != row.text(2)) {
            found.push_back({study, {.participant = row.text(1), .condition = row.text(2)}});
        }
        found.back().second.levels.push_back({row.real(3), row.integer(4), row.integer(5)});
    }
    choice.study = one_study(database, choice, studies, "to fit",
                             "else give a file of two intervals, of yes-no with a graded stimulus, "
                             "or of identifications without a rule");
    StoredAnswers stored{
        .study = choice.study,
        .conditions = conditions_of(database, choice),
        .stimulus = stimulus_of(database, choice),
        .versions = versions_of(database),
        .left_out = left_out_of(database, choice.study, choice.kind, choice.codes)};
    const LeftOut by_code = left_out_of(database, choice.study, choice.kind, true);
    for (auto& [study, answers] : found) {
        if (!by_code.leaves_out(answers.participant)) {
            stored.all.push_back(std::move(answers));
        }
    }
    add_beliefs(database, choice, stored.all);
    if (!choice.codes) {
        number_people(database, stored.all);
    }
    give_streams(stored.all);
    return stored;
}

std::vector<Answers> read_answers(const RereadableText& text, protocols::Family family) {
    constexpr std::array<std::string_view, 3> kWanted{"stimulus", "n", "k"};
    constexpr std::array<std::string_view, 2> kTexts{"participant", "condition"};
    const NumberTable table = read_numbers(text, kWanted, {}, kTexts);
    const auto refuse = [&](std::size_t row, std::size_t column, const std::string& remedy) {
        throw CsvError(fmt::format("{}:{}: {} is {}: {}", text.name(), table.place(row, column),
                                   kWanted.at(column), table.at(row, column), remedy));
    };
    const auto name = [&](std::size_t row, std::string_view column) {
        const auto cell = table.text(row, column);
        if (cell && cell->empty()) {  // its place is there only with the column
            throw CsvError(fmt::format("{}:{}: {} is \"\": give a name, or leave the row out",
                                       text.name(), table.text_place(row, column), column));
        }
        return std::string(without_mark(cell.value_or("")));
    };
    std::vector<Answers> all;
    for (std::size_t row = 0; row < table.rows(); ++row) {
        if (const auto fault = stimulus_fault(table.at(row, 0), family); !fault.empty()) {
            refuse(row, 0, fault);
        }
        const double n = table.at(row, 1);
        const double k = table.at(row, 2);
        if (!(n >= 0.0 && n <= kMaxAnswers) || n != std::floor(n)) {
            refuse(row, 1,
                   "give how many answers there are, a whole number from 0 to 1000000 (1 where a "
                   "row is a trial)");
        }
        if (!(k >= 0.0 && k <= n) || k != std::floor(k)) {
            refuse(row, 2,
                   fmt::format("give how many of the n = {} answers were 1 (yes, correct, the "
                               "comparison), a whole number from 0 to {}",
                               n, n));
        }
        const std::string participant = name(row, "participant");
        const std::string condition = name(row, "condition");
        auto found = std::ranges::find_if(all, [&](const Answers& one) {
            return one.participant == participant && one.condition == condition;
        });
        if (found == all.end()) {
            all.push_back({.participant = participant, .condition = condition});
            found = all.end() - 1;
        }
        found->levels.push_back(
            {table.at(row, 0), static_cast<std::int64_t>(n), static_cast<std::int64_t>(k)});
    }
    refuse_if<CsvError>(all.empty(),
                        "{}: there is no row below the head: give stimulus,n,k, a row a stimulus",
                        text.name());
    give_streams(all);
    return all;
}

}  // namespace palpate::data

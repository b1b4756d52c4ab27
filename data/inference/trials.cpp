#include "data/inference/trials.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "protocols/file/protocol_file.hpp"
#include "protocols/observer/person.hpp"
#include "data/csv/csv_text.hpp"
#include "data/csv/number_table.hpp"

namespace palpate::data {
namespace {

constexpr std::array<std::string_view, 4> kNamed{"subject", "shape", "friction", "response"};
constexpr double kLatest = 1e9;

/// One file's rows, field by field, with its places in what is refused.
class Rows {
public:
    Rows(const std::filesystem::path& file, const NumberTable& table)
        : file_(file.string()), table_(table) {
        for (const std::string_view name : kNamed) {
            refuse_if<CsvError>(
                std::ranges::find(table.text_columns, name) == table.text_columns.end(),
                "{}:1: there is no column {}: give a head with "
                "subject,trial,shape,friction,response and, if known, "
                "rt_s,confidence,explore_s,since_break,excluded",
                file_, name);
        }
    }

    [[noreturn]] void refuse(std::size_t row,
                             std::string_view column,
                             const std::string& remedy) const {
        throw CsvError(fmt::format("{}:{}: {} is \"{}\": {}", file_, table_.text_place(row, column),
                                   column, table_.text(row, column)->substr(0, 40), remedy));
    }

    [[nodiscard]] std::string name(std::size_t row, std::string_view column) const {
        const std::string_view text = without_mark(*table_.text(row, column));
        if (text.empty()) {
            refuse(row, column, "give a name, or leave the row out");
        }
        return std::string(text);
    }

    [[nodiscard]] std::int64_t number(std::size_t row) const {
        const double value = table_.at(row, 0);
        refuse_if<CsvError>(!(value >= 0.0 && value <= kLatest) || value != std::floor(value),
                            "{}:{}: trial is {}: give the trial's number in the order run, a "
                            "whole number from 0 to 1000000000",
                            file_, table_.place(row, 0), value);
        return static_cast<std::int64_t>(value);
    }

    /// Nothing for an empty field, or a file without the column.
    [[nodiscard]] std::optional<double> value(std::size_t row,
                                              std::string_view column,
                                              bool above_zero) const {
        const auto text = table_.text(row, column);
        if (!text || text->empty() || *text == "NA" || *text == "n/a") {
            return std::nullopt;
        }
        constexpr double kLimit = 1e9;  // sums of squares stay numbers
        const auto value = parsed<double>(*text);
        if (!value || !(std::fabs(*value) <= kLimit) || (above_zero && *value <= 0.0)) {
            refuse(row, column,
                   above_zero ? "give seconds above 0 to 1e9, or nothing where it is not known"
                              : "give a number from -1e9 to 1e9, or nothing where it is not known");
        }
        return value;
    }

    [[nodiscard]] std::string excluded(std::size_t row) const {
        const std::string_view text = without_mark(table_.text(row, "excluded").value_or(""));
        constexpr std::array<std::string_view, 7> kCounts{"0",     "NA",    "n/a", "False",
                                                          "false", "FALSE", "0.0"};
        return std::ranges::find(kCounts, text) != kCounts.end() ? std::string()
                                                                 : std::string(text);
    }

private:
    std::string file_;
    const NumberTable& table_;
};

std::string field_of(const std::optional<double>& value) {
    return value ? fmt::format("{}", *value) : std::string();
}

/// Of pictures: some answer names a shape.
void check_named(const std::string& file, const TrialTable& table) {
    const bool named = std::ranges::any_of(table.responses, [&](const std::string& response) {
        return std::ranges::binary_search(table.shapes, response);
    });
    if (!named) {  // Yes and No, or numbers, are not all wrong
        constexpr std::size_t kShown = 5;
        const auto some = [&](const std::vector<std::string>& names) {
            const auto end =
                names.begin() + static_cast<std::ptrdiff_t>(std::min(names.size(), kShown));
            return fmt::format("{}{}", fmt::join(names.begin(), end, ", "),
                               names.size() > kShown ? ", ..." : "");
        };
        throw CsvError(fmt::format(
            "{}: no response is the name of a shape (responses: {}; shapes: {}): give the same "
            "names in both, or answers that are yes and no, in lower case",
            file, some(table.responses), some(table.shapes)));
    }
}

/// Answers without a rule: named pictures, or yes and no.
constexpr std::string_view kAnswered = R"sql(
SELECT study_name, participant_code, subject, analysis_trial.planned_object, friction,
       coalesce(chosen_object, iif(answer_code = 1, 'yes', 'no')), reaction_s, done_s - first_contact_s, confidence,
       trials_since_break, iif(counts, '', coalesce(exclusion, 'does not count'))
FROM analysis_trial JOIN participant USING (participant_code)
WHERE phase = 'main' AND session_kind = ?1 AND answer_code IS NOT NULL AND run_number IS NULL
      AND (chosen_object IS NOT NULL OR study_name IN
           (SELECT study_name FROM study WHERE protocol_toml LIKE '%kind = "yes_no"%'))
ORDER BY study_name, participant_code, session_number, trial_number)sql";

std::optional<double> above_zero(const Statement& row, int column) {
    return row.real(column) > 0.0 ? row.real_or_none(column) : std::nullopt;
}

/// By the least static friction of the conditions' plans, as everywhere.
std::string least_friction(Database& database, const AnswerChoice& choice) {
    Statement row = database.first(
        "SELECT friction FROM plan JOIN session USING (session_id) JOIN study USING (study_id) "
        "WHERE study_name = ?1 AND session_kind = ?2 AND phase = 'main' GROUP BY 1 ORDER BY "
        "min(mu_s), friction LIMIT 1",
        choice.study, choice.kind);
    return row.text(0);
}

/// As the newest version of the protocol says.
void add_primary(TrialTable& table, Database& database) {
    const protocols::Protocol protocol = protocols::stored_protocol(
        database
            .first("SELECT protocol_toml FROM study WHERE study_name = ?1 ORDER BY study_id DESC "
                   "LIMIT 1",
                   table.study)
            .text(0));
    table.primary = protocol.analysis.primary;
    table.primary_friction = protocol.frictions[protocols::primary_pair(protocol).with].name;
}

std::size_t pictures_of(Database& database, const AnswerChoice& choice) {
    Statement row = database.first(
        "SELECT coalesce(max(n), 0) FROM (SELECT count(*) AS n FROM picture JOIN session USING "
        "(session_id) JOIN study USING (study_id) WHERE study_name = ?1 AND session_kind = ?2 "
        "GROUP BY session_id)",
        choice.study, choice.kind);
    return static_cast<std::size_t>(row.integer(0));
}

/// A trial before its names have places.
struct NamedTrial {
    std::string subject;
    std::string shape;
    std::string friction;
    std::string response;
    Trial trial{};
};

/// The table, every list of names sorted; without source.
TrialTable table_of_names(std::vector<NamedTrial> all) {
    TrialTable table;
    const auto list = [&](std::vector<std::string>& names, std::string NamedTrial::*member) {
        std::set<std::string> set;
        for (const NamedTrial& one : all) {
            set.insert(one.*member);
        }
        names.assign(set.begin(), set.end());
    };
    list(table.subjects, &NamedTrial::subject);
    list(table.shapes, &NamedTrial::shape);
    list(table.frictions, &NamedTrial::friction);
    list(table.responses, &NamedTrial::response);
    const auto place = [](const std::vector<std::string>& names, const std::string& name) {
        return static_cast<std::size_t>(std::ranges::lower_bound(names, name) - names.begin());
    };
    for (NamedTrial& one : all) {
        Trial& trial = table.trials.emplace_back(std::move(one.trial));
        trial.subject = place(table.subjects, one.subject);
        trial.shape = place(table.shapes, one.shape);
        trial.friction = place(table.frictions, one.friction);
        trial.response = place(table.responses, one.response);
    }
    std::ranges::stable_sort(table.trials, [](const Trial& a, const Trial& b) {
        return std::pair(a.subject, a.number) < std::pair(b.subject, b.number);
    });
    const bool yes_no = std::ranges::all_of(
        table.responses, [](const std::string& name) { return name == "yes" || name == "no"; });
    if (!yes_no) {
        std::set<std::string> pictures(table.shapes.begin(), table.shapes.end());
        pictures.insert(table.responses.begin(), table.responses.end());
        table.alternatives = pictures.size();
    }
    return table;
}

NamedTrial trial_of(const Statement& row, bool codes, std::int64_t number) {
    NamedTrial one{.subject = codes ? row.text(1) : fmt::format("sub-{:010}", row.integer(2)),
                   .shape = row.text(3),
                   .friction = row.text(4),
                   .response = row.text(5)};
    one.trial = {.number = number,
                 .rt_s = above_zero(row, 6),
                 .explore_s = above_zero(row, 7),
                 .confidence = row.real_or_none(8),
                 .since_break = row.real_or_none(9),
                 .excluded = row.text(10)};
    return one;
}

}  // namespace

TrialTable read_trials(const RereadableText& text, bool others) {
    constexpr std::array<std::string_view, 1> kNumbers{"trial"};
    constexpr std::array<std::string_view, 9> kTexts{"subject",   "shape",       "friction",
                                                     "response",  "rt_s",        "confidence",
                                                     "explore_s", "since_break", "excluded"};
    const NumberTable read = read_numbers(text, kNumbers, {}, kTexts);
    const Rows rows(text.name(), read);
    std::vector<NamedTrial> all;
    std::map<std::pair<std::string, std::int64_t>, std::size_t> seen;
    for (std::size_t row = 0; row < read.rows(); ++row) {
        NamedTrial one{.subject = rows.name(row, "subject"),
                       .shape = rows.name(row, "shape"),
                       .friction = rows.name(row, "friction"),
                       .response = rows.name(row, "response")};
        one.trial.number = rows.number(row);
        one.trial.rt_s = rows.value(row, "rt_s", true);
        one.trial.explore_s = rows.value(row, "explore_s", true);
        one.trial.confidence = rows.value(row, "confidence", false);
        one.trial.since_break = rows.value(row, "since_break", false);
        one.trial.excluded = rows.excluded(row);
        const auto [first, is_new] = seen.try_emplace({one.subject, one.trial.number}, row);
        refuse_if<CsvError>(!is_new,
                            "{}:{}: trial {} of this subject stands in line {} too: number the "
                            "trials of a subject in the order run, each once",
                            text.name(), read.place(row, 0), one.trial.number,
                            read.lines[first->second]);
        all.push_back(std::move(one));
    }
    refuse_if<CsvError>(all.empty(),
                        "{}: there is no row below the head: give "
                        "subject,trial,shape,friction,response, a row a trial",
                        text.name());
    TrialTable table = table_of_names(std::move(all));
    if (table.alternatives > 0) {
        check_named(text.name(), table);
    }
    for (std::size_t row = 0; table.alternatives > 0 && !others && row < read.rows(); ++row) {
        if (!std::ranges::binary_search(table.shapes, rows.name(row, "response"))) {
            rows.refuse(row, "response",
                        fmt::format("no shape is called so ({}): correct it, or give "
                                    "--other-answers where it is a picture that nobody felt",
                                    fmt::join(table.shapes, ", ")));
        }
    }
    table.source = text.name();
    return table;
}

std::string trials_csv(const TrialTable& table) {
    std::string text =
        "subject,trial,shape,friction,response,rt_s,confidence,explore_s,since_break,excluded\n";
    for (const Trial& one : table.trials) {
        text += fmt::format(
            "{},{},{},{},{},{},{},{},{},{}\n", csv_field(table.subjects[one.subject]), one.number,
            csv_field(table.shapes[one.shape]), csv_field(table.frictions[one.friction]),
            csv_field(table.responses[one.response]), field_of(one.rt_s), field_of(one.confidence),
            field_of(one.explore_s), field_of(one.since_break),
            one.excluded.empty() ? "" : csv_field(one.excluded));
    }
    return text;
}

void compare_with(TrialTable& table, const std::string& friction) {
    const auto found = std::ranges::find(table.frictions, friction);
    refuse_if(found == table.frictions.end(), "--baseline is {}: give one of {}", friction,
              fmt::join(table.frictions, ", "));
    const auto at = static_cast<std::size_t>(found - table.frictions.begin());
    std::rotate(table.frictions.begin(), found, found + 1);
    for (Trial& one : table.trials) {
        one.friction = one.friction == at ? 0 : one.friction < at ? one.friction + 1 : one.friction;
    }
}

TrialTable stored_trials(Database& database, const AnswerChoice& asked) {
    const Snapshot now(database);
    AnswerChoice choice = asked;
    std::set<std::string> studies;
    std::vector<NamedTrial> all;
    std::string before;
    std::int64_t number = 0;
    for (const Statement& row : database.prepare(kAnswered, choice.kind)) {
        const std::string study = row.text(0);
        if (!choice.study.empty() && study != choice.study) {
            continue;
        }
        studies.insert(study);
        number = row.text(1) == before ? number + 1 : 1;
        before = row.text(1);
        all.push_back(trial_of(row, choice.codes, number));
    }
    choice.study =
        one_study(database, choice, studies, "of identification or yes-no without a rule",
                  "palpate fit is for runs of a rule, palpate summary for ratings");
    LeftOut account = left_out_of(database, choice.study, choice.kind, choice.codes);
    const auto whys = whys_of(account);
    for (NamedTrial& one : all) {
        if (const auto found = whys.find(one.subject); found != whys.end()) {
            one.trial.excluded = found->second;
        }
    }
    TrialTable table = table_of_names(std::move(all));
    table.source = choice.codes ? database.file() : fmt::format("study {}", choice.study);
    table.study = choice.study;
    table.versions = versions_of(database);
    table.left_out = std::move(account);
    table.kind = choice.kind;
    add_primary(table, database);
    if (table.alternatives > 0) {
        table.alternatives = std::max<std::size_t>(pictures_of(database, choice), 2);
    }
    const std::string least = least_friction(database, choice);
    if (std::ranges::find(table.frictions, least) != table.frictions.end()) {
        compare_with(table, least);
    }
    return table;
}

}  // namespace palpate::data

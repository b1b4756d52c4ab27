#include "data/page/study.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <ranges>
#include <set>
#include <stdexcept>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "protocols/file/protocol_file.hpp"
#include "data/csv/csv_text.hpp"
#include "data/shell/sql_shell.hpp"

namespace palpate::data {

std::string_view page_queries();

std::string_view page_query(std::string_view name) {
    const std::string head = fmt::format("-- name: {}\n", name);
    std::string_view query = page_queries();
    const std::size_t at = query.find(head);
    refuse_if<std::logic_error>(at == std::string_view::npos, "{}", head);
    query.remove_prefix(at + head.size());
    query = query.substr(0, query.find("\n\n--"));
    return query.ends_with('\n') ? query.substr(0, query.size() - 1) : query;
}

std::string replaced(std::string text, std::string_view from, std::string_view to) {
    for (std::size_t at = text.find(from); at != std::string::npos;
         at = text.find(from, at + to.size())) {
        text.replace(at, from.size(), to);
    }
    return text;
}

namespace {

/// What the shell prints, of one statement.
std::string printed(Database& database, const std::string& sql) {
    struct Memory {
        char* text = nullptr;
        std::size_t size = 0;
        std::FILE* file = open_memstream(&text, &size);
        Memory() = default;
        Memory(const Memory&) = delete;
        Memory& operator=(const Memory&) = delete;
        ~Memory() {
            std::fclose(file);
            std::free(text);
        }
        std::string said() {
            std::fflush(file);
            return {text, size};
        }
    };
    Memory out;
    Memory error;
    SqlShell shell(database, RowFormat::csv, out.file, error.file);
    if (!shell.run(sql)) {
        throw StoreError(fmt::format("{}: {}", database.file(), error.said()));
    }
    return out.said();
}

std::vector<std::vector<std::string>> rows_of(std::string_view csv) {
    std::vector<std::vector<std::string>> rows;
    while (!csv.empty()) {
        const std::size_t end = std::min(RowEnd().in(csv), csv.size());
        auto& row = rows.emplace_back();
        for (const Field& field : fields_of(csv.substr(0, end))) {
            row.push_back(plain_text(field.text));
        }
        csv.remove_prefix(std::min(end + 1, csv.size()));
    }
    return rows;
}

}  // namespace

const std::string& Rows::text(std::size_t row, std::string_view name) const {
    const auto found = std::ranges::find(names, name);
    refuse_if<std::logic_error>(found == names.end(), "no column {} in {}", name, sql);
    return cells.at(row)[static_cast<std::size_t>(found - names.begin())];
}

double Rows::number(std::size_t row, std::string_view name) const {
    const std::string& field = text(row, name);
    double value = std::numeric_limits<double>::quiet_NaN();
    std::from_chars(field.data(), field.data() + field.size(), value);
    return value;
}

std::vector<double> Rows::numbers(std::string_view name, double factor) const {
    std::vector<double> all(cells.size());
    for (std::size_t row = 0; row < cells.size(); ++row) {
        all[row] = factor * number(row, name);
    }
    return all;
}

double Rows::sum(std::string_view name) const {
    double sum = 0.0;
    for (const double value : numbers(name)) {
        sum += std::isfinite(value) ? value : 0.0;
    }
    return sum;
}

Rows Rows::where(std::string_view name, std::string_view level) const {
    Rows kept{.names = names};
    for (std::size_t row = 0; row < cells.size(); ++row) {
        if (text(row, name) == level) {
            kept.cells.push_back(cells[row]);
        }
    }
    return kept;
}

std::vector<std::string> Rows::levels(std::string_view name) const {
    std::vector<std::string> found;
    for (std::size_t row = 0; row < cells.size(); ++row) {
        const std::string& level = text(row, name);
        if (std::ranges::find(found, level) == found.end()) {
            found.push_back(level);
        }
    }
    return found;
}

Study::Study(Database& database, const PageOptions& asked) : options(asked), database_(&database) {
    file = options.codes ? std::filesystem::path(database.file()).filename().string() : "FILE";
    choose();
    number_people();
}

void Study::choose() {
    const std::vector<std::string> names = texts(database_->prepare(
        "SELECT DISTINCT study_name FROM study JOIN session USING (study_id) WHERE session_kind = "
        "?1 AND (?2 = '' OR study_name = ?2) ORDER BY 1",
        options.kind, options.study));
    if (names.empty()) {
        const std::string left = none_left_text(*database_, options.study, options.kind);
        throw std::invalid_argument(fmt::format(
            "{} has no {} session{}{}: --kind chooses others{}", database_->file(), options.kind,
            options.study.empty() ? "" : fmt::format(" of the study {}", options.study),
            left.empty() ? "" : " that may be shown", left));
    }
    if (names.size() > 1) {
        throw std::invalid_argument(several_studies(*database_, {names.begin(), names.end()}));
    }
    name = names.front();
    words = options.kind == "real" ? "" : " --kind " + options.kind;
    words += options.study.empty() ? "" : " --study " + options.study;
    versions = versions_of(*database_);
    if (!versions.empty() || hides(*database_)) {
        seen = name.find('@') == std::string::npos && !versions.empty() ? " --versions together"
                                                                        : " --versions apart";
        words += seen;
    }
    Statement text = database_->first(
        "SELECT study_title, protocol_toml FROM study JOIN session USING (study_id) WHERE "
        "study_name = ?1 AND session_kind = ?2 ORDER BY session_id DESC LIMIT 1",
        name, options.kind);
    title = text.text(0);
    protocol = protocols::stored_protocol(text.text(1));
}

void Study::number_people() {
    Statement row = database_->prepare(
        "SELECT participant_code, printf('sub-%010d', subject) FROM participant WHERE "
        "participant_id IN (SELECT participant_id FROM session JOIN study USING (study_id) WHERE "
        "study_name = ?1 AND session_kind = ?2) ORDER BY subject",
        name, options.kind);
    std::map<std::string, std::size_t> place;
    while (row.step()) {
        ++people;
        const std::string shown = options.codes ? row.text(0) : fmt::format("{}", people);
        place[row.text(0)] = place[row.text(1)] = people;
        person_[row.text(0)] = person_[row.text(1)] = shown;
    }
    left_out = left_out_of(*database_, name, options.kind, options.codes);
    std::set<std::size_t> places;
    for (LeftOut::Reason& one : left_out.broken) {
        places.insert(place.at(one.person));
        one.person = person(one.person);
    }
    for (LeftOut::Reason& one : left_out.withdrawals) {
        one.why = options.codes ? one.why
                                : "the lab's file says why";  // a page is handed on: no lab's words
        const std::size_t end = one.person.find(' ');
        one.person = person(one.person.substr(0, end)) + one.person.substr(end);
    }
    const std::string study = quoted_text(name);
    const std::string kind = quoted_text(options.kind);
    person_sql_ = fmt::format(
        "person AS (\n"
        "    SELECT participant_id, participant_code, {} AS person,\n"
        "           printf('sub-%010d', subject) AS subject,\n"
        "           row_number() OVER (ORDER BY subject) IN ({}) AS left_out\n"
        "    FROM participant\n"
        "    WHERE participant_id IN (\n"
        "        SELECT participant_id FROM session JOIN study USING (study_id)\n"
        "        WHERE study_name = {} AND session_kind = {}))",
        options.codes ? "participant_code" : "row_number() OVER (ORDER BY subject)",
        fmt::join(places, ", "), study, kind);
    main_sql_ = fmt::format(
        "main AS (\n"
        "    SELECT person, left_out, analysis_trial.*\n"
        "    FROM analysis_trial JOIN person USING (participant_code)\n"
        "    WHERE study_name = {} AND session_kind = {} AND phase = 'main')",
        study, kind);
}

std::string Study::person(const std::string& known_as) const {
    const auto found = person_.find(known_as);
    return found == person_.end() ? known_as : found->second;
}

Rows Study::ask(std::string_view sql) const {
    std::string text(sql);
    const auto signals = std::views::transform(options.signals, quoted_text);
    const std::string signal = fmt::format("planned_object IN ({})", fmt::join(signals, ", "));
    const auto judged = [](const std::string& yes_no) {
        return fmt::format("iif(chosen_object IS NULL, {}, chosen_object = planned_object)",
                           yes_no);
    };
    const std::string said = fmt::format("(answer_code = 1) = ({})", signal);
    const bool known = !options.signals.empty();
    for (const auto& [word, value] :
         {std::pair{std::string("{hit}"), judged(known ? said : "answer_code = 1")},
          std::pair{std::string("{right}"), judged(known ? said : "NULL")},
          std::pair{std::string("{signal}"), signal},
          std::pair{std::string("{study}"), quoted_text(name)},
          std::pair{std::string("{kind}"), quoted_text(options.kind)}}) {
        text = replaced(std::move(text), word, value);
    }
    Rows rows;
    rows.sql = text;
    if (text.find("person") != std::string::npos || text.find("main") != std::string::npos) {
        const bool with = text.starts_with("WITH ");
        std::string before = "WITH " + person_sql_;
        before += text.find("main") == std::string::npos ? "" : ",\n" + main_sql_;
        rows.sql = before + (with ? ",\n" + text.substr(5) : "\n" + text);
    }
    rows.csv = printed(*database_, rows.sql);
    rows.cells = rows_of(rows.csv);
    rows.names = rows.cells.front();
    rows.cells.erase(rows.cells.begin());
    return rows;
}

}  // namespace palpate::data

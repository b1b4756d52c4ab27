#include "data/schema/catalogue.hpp"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "protocols/session/trial_meter.hpp"
#include "data/trace/columns.hpp"

namespace palpate::data {

std::string_view tables_text();  // tables.sql

namespace {

std::string sql_type(std::string_view type) {
    return type == "integer" ? "INTEGER" : type == "real" ? "REAL" : "TEXT";
}

/// Its columns are those of a tick (data/trace/columns.hpp), as everywhere.
std::string fault_tick_table() {
    std::string sql = R"sql(
CREATE TABLE fault_tick (
    -- The last ticks before the force went off by itself, at most 100, the last one the fault's own. Here
    -- also when the trace lost them; NULL for what was not a number.
    trial_id INTEGER NOT NULL REFERENCES trial,  -- trial.trial_id
)sql";
    for (const TraceColumn& column : trace_columns()) {
        // A time is a number; a computed real may be none.
        const bool given = column.type != "real" || column.name == "time_s";
        sql += fmt::format(
            "    {} {}{}{},  -- {}\n", column.name, sql_type(column.type), given ? " NOT NULL" : "",
            column.name == "mode" ? " CHECK (mode IN ('free', 'stuck', 'slip', 'transition'))" : "",
            column.meaning);
    }
    return sql + "    PRIMARY KEY (trial_id, tick)\n) STRICT;\n";
}

/// Columns of what is added up from ticks, where tables.sql names `place`.
void put_measures(std::string& sql, std::string_view named, int protocols::Measure::*place) {
    std::map<int, std::string> lines;
    for (const protocols::Measure& one : protocols::measures()) {
        const bool real = std::holds_alternative<double>(one.value({}));
        lines[one.*place] = fmt::format(
            "    {:<48}-- {}\n", fmt::format("{:<19} {},", one.column, real ? "REAL" : "INTEGER"),
            one.meaning);
    }
    lines.erase(0);  // without a place
    std::string columns;
    for (const auto& [at, line] : lines) {
        columns += line;
    }
    const std::string mark =
        fmt::format("    -- (measures() of protocols/session/trial_meter.cpp, by {})\n", named);
    sql.replace(sql.find(mark), mark.size(), columns);
}

std::string all_tables() {
    std::string sql(tables_text());
    put_measures(sql, "in_trial", &protocols::Measure::in_trial);
    put_measures(sql, "in_interval", &protocols::Measure::in_interval);
    return sql + fault_tick_table();
}

}  // namespace

std::string_view schema_sql() {
    static const std::string all = fmt::format("\n{}{}", all_tables(), views_sql());
    return all;
}

const std::vector<TableManual>& catalogue() {
    static const std::vector<TableManual> all = schema_manual(schema_sql());
    return all;
}

std::vector<std::string> tables_with(std::string_view column) {
    std::vector<std::string> names;
    for (const TableManual& table : catalogue()) {
        if (!table.view && find_column(fmt::format("{}.{}", table.name, column)) != nullptr) {
            names.push_back(table.name);
        }
    }
    return names;
}

const ColumnManual* find_column(std::string_view name) {
    const std::size_t dot = name.find('.');
    const auto table = std::ranges::find(catalogue(), name.substr(0, dot), &TableManual::name);
    if (table == catalogue().end() || dot == std::string_view::npos) {
        return nullptr;
    }
    const auto at = std::ranges::find(table->columns, name.substr(dot + 1), &ColumnManual::name);
    return at == table->columns.end() ? nullptr : &*at;
}

std::string_view views_text();  // views.sql

namespace {

/// One kind of sessions, whatever a file holds: whoever forgets to ask for one gets the study, not
/// its trial runs too.
constexpr std::string_view kMainTrial = R"sql(
CREATE VIEW main_trial AS
-- analysis_trial, less what is no answer of the study: its main trials that count, of who consents, of one kind of
-- sessions: real where the file has such, else pilot, else simulated. Group by study_name: a file can hold several.
SELECT {}
FROM analysis_trial
WHERE counts AND phase = 'main'
      AND participant_code NOT IN (SELECT participant_code FROM participant WHERE consent = 0)
      AND session_kind = (SELECT session_kind FROM session JOIN participant USING (participant_id)
                          WHERE consent IS NOT 0 AND withdrawn_reason IS NULL AND session_id IN
                                (SELECT session_id FROM trial JOIN response USING (trial_id))
                          ORDER BY session_kind = 'real' DESC, session_kind = 'pilot' DESC LIMIT 1);
)sql";

/// The columns of analysis_trial, each by its name, so that the manual has all of them.
std::string main_trial_sql() {
    const std::vector<TableManual> views = schema_manual(views_text());
    std::string columns;
    for (const ColumnManual& one : views.front().columns) {
        columns += fmt::format("{}analysis_trial.{} AS {}", columns.empty() ? "" : ",\n       ",
                               one.name, one.name);
    }
    return fmt::format(kMainTrial, columns);
}

}  // namespace

std::string_view views_sql() {
    static const std::string all = fmt::format("\n{}{}", views_text(), main_trial_sql());
    return all;
}

}  // namespace palpate::data

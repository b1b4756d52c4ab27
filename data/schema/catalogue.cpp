#include "data/schema/catalogue.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "protocols/session/trial_meter.hpp"
#include "data/trace/columns.hpp"

namespace palpate::data {

std::string_view tables_text();  // tables.sql
std::string_view views_text();   // views.sql

namespace {

enum class Kind { word, symbol, literal, comment, end };

struct Token {
    Kind kind = Kind::end;
    std::string_view text;
    std::size_t line = 0;
};

/// SQL as far as its comments need it: words, literals, comments, single characters.
class Scanner {
public:
    explicit Scanner(std::string_view sql) : sql_(sql) {}

    Token next() {
        while (at_ < sql_.size() && std::isspace(static_cast<unsigned char>(sql_[at_])) != 0) {
            line_ += sql_[at_++] == '\n' ? 1U : 0U;
        }
        if (at_ == sql_.size()) {
            return {.kind = Kind::end, .text = {}, .line = line_};
        }
        const std::string_view rest = sql_.substr(at_);
        if (rest.starts_with("--")) {
            const std::string_view all = take(std::min(rest.find('\n'), rest.size()));
            const std::size_t begin = std::min(all.find_first_not_of(' ', 2), all.size());
            return {.kind = Kind::comment, .text = all.substr(begin), .line = line_};
        }
        if (rest.front() == '\'') {
            return {.kind = Kind::literal, .text = take(rest.find('\'', 1) + 1), .line = line_};
        }
        const auto word = std::find_if_not(rest.begin(), rest.end(), [](char c) {
            return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
        });
        const auto size = static_cast<std::size_t>(word - rest.begin());
        return {.kind = size > 0 ? Kind::word : Kind::symbol,
                .text = take(std::max<std::size_t>(size, 1)),
                .line = line_};
    }

private:
    std::string_view take(std::size_t size) {
        const std::string_view taken =
            sql_.substr(at_, size == 0 ? std::string_view::npos : size);  // an open literal
        at_ += taken.size();
        return taken;
    }

    std::string_view sql_;
    std::size_t at_ = 0;
    std::size_t line_ = 1;
};

bool is_constraint(std::string_view word) {
    constexpr std::array kWords{"PRIMARY", "UNIQUE", "FOREIGN", "CHECK", "CONSTRAINT"};
    return std::find(kWords.begin(), kWords.end(), word) != kWords.end();
}

void join(std::string& meaning, std::string_view comment) {
    meaning += meaning.empty() ? "" : " ";
    meaning += comment;
}

/// Takes [details] or [file] from the beginning of a meaning.
Visibility taken_mark(std::string& meaning) {
    for (const auto& [word, seen] :
         {std::pair{"[details] ", Visibility::details}, {"[file] ", Visibility::file}}) {
        if (meaning.starts_with(word)) {
            meaning.erase(0, std::string_view(word).size());
            return seen;
        }
    }
    return Visibility::everybody;
}

/// Takes {a = first; b = second} from the end of a meaning.
std::string taken_levels(std::string& meaning) {
    const std::size_t open = meaning.find('{');
    if (open == std::string::npos || !meaning.ends_with('}') ||
        meaning.find(" = ", open) == std::string::npos) {
        return "";
    }
    std::string levels = meaning.substr(open + 1, meaning.size() - open - 2);
    meaning.erase(meaning.find_last_not_of(' ', open - 1) + 1);
    return levels;
}

/// Reads the columns of one statement.
class Reader {
public:
    Reader(Scanner& scanner, bool view) : scanner_(scanner), view_(view) {}

    TableManual read(std::string_view name) {
        table_.name = name;
        table_.view = view_;
        bool inside = false;  // what stands between the name and the columns is passed over
        for (Token token = scanner_.next(); token.kind != Kind::end; token = scanner_.next()) {
            if (token.kind == Kind::comment) {
                comment(token);
            } else if (!inside) {
                inside = token.text == (view_ ? "SELECT" : "(");
            } else if (depth_ == 0 && token.text == (view_ ? "FROM" : ")")) {
                break;
            } else {
                element(token);
            }
        }
        finish();
        table_.seen = taken_mark(table_.meaning);
        return std::move(table_);
    }

private:
    void comment(const Token& token) {
        if (words_ > 0) {
            join(column_.meaning, token.text);
        } else if (token.line == ended_ && !table_.columns.empty()) {
            join(table_.columns.back().meaning, token.text);
        } else if (table_.columns.empty()) {
            join(table_.meaning, token.text);
        }
    }

    void element(const Token& token) {
        if (depth_ == 0 && token.text == ",") {
            finish();
            ended_ = token.line;
            return;
        }
        depth_ += token.text == "(" ? 1 : token.text == ")" ? -1 : 0;
        ++words_;
        last_line_ = token.line;
        column_.source +=
            words_ <= 3 ? std::string(token.text) : "";  // "trial", ".", "outcome" and no more
        column_.source = words_ == 4 && token.text != "AS" ? "" : column_.source;
        if (depth_ == 0 && !view_) {
            column_.type = words_ == 2 ? token.text : column_.type;
            column_.nullable = column_.nullable && token.text != "NULL" && token.text != "PRIMARY";
        }
        // A table's column begins with its name, a view's ends with it.
        if (depth_ == 0 && token.kind == Kind::word && (view_ || words_ == 1)) {
            column_.name = token.text;
        }
    }

    void finish() {
        if (words_ > 0) {
            ended_ = last_line_;
            if (view_ || !is_constraint(column_.name)) {
                column_.unit = unit_of(column_.name);
                column_.source =
                    view_ && column_.source.find('.') != std::string::npos ? column_.source : "";
                table_.columns.push_back(std::move(column_));
            }
        }
        column_ = {};
        words_ = 0;
    }

    Scanner& scanner_;
    bool view_;
    TableManual table_;
    ColumnManual column_;
    int words_ = 0;  ///< of the column so far
    int depth_ = 0;
    std::size_t ended_ = 0;  ///< line of the last column's end
    std::size_t last_line_ = 0;
};

std::vector<TableManual> statements_of(std::string_view sql) {
    std::vector<TableManual> manual;
    Scanner scanner(sql);
    bool create = false;
    for (Token token = scanner.next(); token.kind != Kind::end; token = scanner.next()) {
        if (create && (token.text == "TABLE" || token.text == "VIEW")) {
            const bool view = token.text == "VIEW";
            const Token name = scanner.next();
            manual.push_back(Reader(scanner, view).read(name.text));
        }
        create = token.kind == Kind::word && token.text == "CREATE";
    }
    return manual;
}

/// A view's column that is another's has its meaning, words and readers.
void say_what_is_repeated(const std::vector<TableManual>& manual, ColumnManual& column) {
    if (const ColumnManual* source = find_column(column.source, manual)) {
        column.type = source->type;
        column.seen = source->seen;
        column.levels = source->levels;
        column.meaning = column.meaning.empty() ? source->meaning : column.meaning;
    }
}

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

std::string_view unit_of(std::string_view column) noexcept {
    struct Ending {
        std::string_view end;
        std::string_view unit;
    };
    constexpr std::array kEndings{
        Ending{"_n_per_m", "N/m"}, Ending{"_m_per_s", "m/s"}, Ending{"_per_m", "1/m"},
        Ending{"_utc", "UTC"},     Ending{"_hz", "Hz"},       Ending{"_us", "us"},
        Ending{"_ns", "ns"},       Ending{"_s", "s"},         Ending{"_m", "m"},
        Ending{"_n", "N"},         Ending{"_j", "J"},
    };
    if (column.ends_with("mu_s")) {  // static, not seconds
        return "-";
    }
    const auto* const found =
        std::find_if(kEndings.begin(), kEndings.end(),
                     [column](const Ending& ending) { return column.ends_with(ending.end); });
    return found == kEndings.end() ? "-" : found->unit;
}

std::vector<TableManual> schema_manual(std::string_view sql) {
    std::vector<TableManual> manual = statements_of(sql);
    for (TableManual& table : manual) {
        for (ColumnManual& column : table.columns) {
            say_what_is_repeated(manual, column);
            column.seen = std::max(column.seen, taken_mark(column.meaning));
            column.levels = column.levels.empty() ? taken_levels(column.meaning) : column.levels;
        }
    }
    return manual;
}

std::string_view schema_sql() {
    static const std::string all = [] {
        std::string tables(tables_text());
        put_measures(tables, "in_trial", &protocols::Measure::in_trial);
        put_measures(tables, "in_interval", &protocols::Measure::in_interval);
        return fmt::format("\n{}{}{}", tables, fault_tick_table(), views_sql());
    }();
    return all;
}

const std::vector<TableManual>& catalogue() {
    static const std::vector<TableManual> all = schema_manual(schema_sql());
    return all;
}

std::vector<std::string> tables_with(std::string_view column) {
    std::vector<std::string> names;
    for (const TableManual& table : catalogue()) {
        if (!table.view && table.find(column) != nullptr) {
            names.push_back(table.name);
        }
    }
    return names;
}

const ColumnManual* TableManual::find(std::string_view column) const {
    const auto at = std::ranges::find(columns, column, &ColumnManual::name);
    return at == columns.end() ? nullptr : &*at;
}

const TableManual* find_table(std::string_view name, const std::vector<TableManual>& among) {
    const auto at = std::ranges::find(among, name, &TableManual::name);
    return at == among.end() ? nullptr : &*at;
}

const ColumnManual* find_column(std::string_view name, const std::vector<TableManual>& among) {
    const std::size_t dot = name.find('.');
    const TableManual* table = find_table(name.substr(0, dot), among);
    return table == nullptr || dot == std::string_view::npos ? nullptr
                                                             : table->find(name.substr(dot + 1));
}

std::string_view views_sql() {
    static const std::string all = fmt::format("\n{}{}", views_text(), main_trial_sql());
    return all;
}

}  // namespace palpate::data

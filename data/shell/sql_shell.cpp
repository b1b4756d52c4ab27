#include "data/shell/sql_shell.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include <fmt/format.h>
#include <sqlite3.h>

#include "engine/base/text.hpp"
#include "data/extension/sample_module.hpp"
#include "data/schema/catalogue.hpp"
#include "data/trace/columns.hpp"

namespace palpate::data {
namespace {

constexpr std::string_view kSpace = " \t\r\n;";
constexpr std::string_view kHelp =
    ".tables          tables and views with their meaning\n"
    ".columns [NAME]  columns with unit and meaning, of one or of all\n"
    ".schema [NAME]   the SQL that made them\n"
    ".help            this\n"
    ".quit            the end\n"
    "Anything else is SQL and ends with a semicolon. Beside the tables there is sample, every tick "
    "of every\n"
    "trial: SELECT avg(rendered_normal_n) FROM sample WHERE trial_id = 1 AND mode <> 'free';\n"
    "Functions: wilson_low, wilson_high, clopper_pearson_low, clopper_pearson_high (k, n [, "
    "confidence]),\n"
    "d_prime(hits, n, alternatives) (n of n hits count as n - 1/2, none as 1/2, so that it is "
    "finite), probit(p)\n"
    "(infinite at 0 and 1), normal_cdf(z). Aggregates, also OVER a window: median(x), quantile(x, "
    "p),\n"
    "geometric_mean(x), stddev_samp(x), share(x) (of 0 and 1), mutual_information(stimulus, "
    "response [, n]),\n"
    "mutual_information_miller_madow(stimulus, response [, n]); where a row is a person, their 95 "
    "% interval:\n"
    "people_share_low(share), people_share_high, people_mean_low(x), people_mean_high.\n";

struct Finalize {
    void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Prepared = std::unique_ptr<sqlite3_stmt, Finalize>;

/// Words of a sentence in lines of at most 64 characters, so that a table fits a window. A word
/// longer than that has a line of its own.
std::vector<std::string> wrapped(std::string_view sentence, RowFormat format) {
    constexpr std::size_t kWidth = 64;
    std::vector<std::string> lines;
    while (format == RowFormat::table && sentence.size() > kWidth) {
        std::size_t end = sentence.rfind(' ', kWidth);
        end = end == std::string_view::npos ? sentence.find(' ') : end;
        if (end == std::string_view::npos) {
            break;
        }
        lines.emplace_back(sentence.substr(0, end));
        sentence.remove_prefix(end + 1);
    }
    lines.emplace_back(sentence);
    return lines;
}

/// A row whose last cell is a sentence; what does not fit goes on below it.
void print_row(RowPrinter& printer,
               RowFormat format,
               std::vector<ColumnValue> cells,
               std::string_view sentence) {
    for (const std::string& line : wrapped(sentence, format)) {
        std::vector<ColumnValue> row = cells;
        row.emplace_back(line);
        printer.row(std::move(row));
        std::fill(cells.begin(), cells.end(), ColumnValue(std::string()));
    }
}

/// What the file says of itself, and the program of what an older one did not say.
std::vector<TableManual> manual_of(Database& database) {
    std::string sql;
    for (const Statement& row :
         database.prepare("SELECT sql FROM sqlite_schema WHERE sql IS NOT NULL ORDER BY rowid")) {
        sql += row.text(0) + ";\n";
    }
    std::vector<TableManual> tables = schema_manual(sql + std::string(sample_declaration()));
    for (TableManual& table : tables) {
        const TableManual* known = find_table(table.name);
        if (known == nullptr) {
            continue;
        }
        table.meaning = table.meaning.empty() ? known->meaning : table.meaning;
        for (ColumnManual& column : table.columns) {
            const ColumnManual* said = known->find(column.name);
            if (column.meaning.empty() && said != nullptr) {
                column.meaning = said->meaning;
            }
        }
    }
    return tables;
}

/// In any letters, as SQL takes names.
bool names_sample(std::string_view sql) {
    constexpr std::string_view kName = "sample";
    return !std::ranges::search(sql, kName, {}, [](char c) {
                return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
            }).empty();
}

/// The table sample and its functions, before a guard says what a statement may do.
Database& with_ticks(Database& database, std::FILE* error) {
    if (has_own_sample(database.handle())) {
        fmt::print(error, "{}: sample are the ticks; what the file calls so is main.sample\n",
                   database.file());
    }
    if (add_extension(database.handle()) != SQLITE_OK) {
        database.fail("adding the table sample");
    }
    return database;
}

}  // namespace

SqlShell::SqlShell(
    Database& database, RowFormat format, std::FILE* out, std::FILE* error, SqlLimits limits)
    : database_(with_ticks(database, error)),
      format_(format),
      out_(out),
      error_(error),
      guard_(database, limits) {}

bool SqlShell::complete(std::string_view text) {
    const std::string_view all = trimmed(text, " \t\r\n");
    return all.empty() || all.front() == '.' || sqlite3_complete(std::string(all).c_str()) != 0;
}

bool SqlShell::run(std::string_view text, std::size_t first_line) {
    std::string_view rest = text;
    while (!quit_) {
        rest.remove_prefix(std::min(rest.find_first_not_of(kSpace), rest.size()));
        if (rest.empty()) {
            return true;
        }
        if (rest.front() == '.') {
            const std::size_t end = std::min(rest.find('\n'), rest.size());
            if (!word(trimmed(rest.substr(0, end), kSpace))) {
                return false;
            }
            rest.remove_prefix(end);
        } else if (!statement(rest, text, first_line)) {
            return false;
        }
    }
    return true;
}

void SqlShell::complain(std::string_view all, std::size_t offset, std::size_t first_line) {
    std::string why = plain(sqlite3_errmsg(database_.handle()));
    if (why.starts_with("access to view")) {
        why +=
            ": the file's schema is not palpate's, so none of its views is read; palpate's own go "
            "by their names without main";
    }
    if (offset > all.size()) {  // it failed while it ran, or SQLite does not know where
        const int code = sqlite3_errcode(database_.handle());
        fmt::print(error_, "palpate: {}{}\n", why,
                   code == SQLITE_NOMEM
                       ? ": more than 1 GB is asked for; sort, group or join less at once"
                   : code == SQLITE_TOOBIG
                       ? ": no value is longer than 50 MB here; put fewer or shorter ones together"
                       : "");
        return;
    }
    const std::string_view before = all.substr(0, offset);
    const auto lines = static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n'));
    const std::size_t begin = before.rfind('\n') + 1;  // npos + 1 is 0
    const std::string_view line =
        all.substr(begin, std::min(all.find('\n', begin), all.size()) - begin);
    fmt::print(error_, "palpate: {}:{}: {}\n  {}\n  {}^\n", first_line + lines, offset - begin + 1,
               why, plain(line), std::string(offset - begin, ' '));
}

int SqlShell::print_rows(sqlite3_stmt* raw) {
    const int columns = sqlite3_column_count(raw);
    std::vector<std::string> names;
    for (int i = 0; i < columns; ++i) {
        names.emplace_back(sqlite3_column_name(raw, i));
    }
    const auto next = [&] {
        const int code = sqlite3_step(raw);
        if (database_.connection().written_since()) {
            database_.fail("reading");
        }
        return code;
    };
    int step = next();
    if (columns > 0 && (step == SQLITE_ROW || step == SQLITE_DONE)) {
        RowPrinter printer(out_, format_, std::move(names));
        for (; step == SQLITE_ROW; step = next()) {
            std::vector<ColumnValue> cells;
            for (int i = 0; i < columns; ++i) {
                cells.push_back(column_value(raw, i));
            }
            printer.row(std::move(cells));
        }
        printer.end();
    }
    return step;
}

bool SqlShell::statement(std::string_view& text, std::string_view all, std::size_t first_line) {
    sqlite3* db = database_.handle();
    sqlite3_stmt* raw = nullptr;
    const char* tail = nullptr;
    guard_.begin();
    const int code =
        sqlite3_prepare_v2(db, text.data(), static_cast<int>(text.size()), &raw, &tail);
    const Prepared prepared(raw);
    if ((code & 0xFF) == SQLITE_AUTH) {
        fmt::print(error_, "{}", guard_.refusal(text));
        return false;
    }
    if (code != SQLITE_OK) {
        const int offset = sqlite3_error_offset(db);
        complain(all,
                 offset < 0 ? std::string_view::npos
                            : static_cast<std::size_t>(text.data() - all.data()) +
                                  static_cast<std::size_t>(offset),
                 first_line);
        return false;
    }
    text.remove_prefix(static_cast<std::size_t>(tail - text.data()));
    if (raw == nullptr) {  // a comment, or a byte at which SQLite reads no further
        const bool stuck = !text.empty() && text.front() == '\0';
        if (stuck) {
            fmt::print(error_, "palpate: a byte of value 0 is no SQL: take it away\n");
        }
        return !stuck;
    }
    asked_ = true;
    if (sqlite3_stmt_readonly(raw) == 0) {
        fmt::print(error_, "{}", guard_.refusal(sqlite3_sql(raw)));
        return false;
    }
    const int step = print_rows(raw);
    const std::string_view asked(sqlite3_sql(raw));
    if (step == SQLITE_DONE && names_sample(asked) && no_ticks()) {
        std::fflush(out_);
        fmt::print(error_, "palpate: no ticks are kept in this file: sample has no row\n");
    }
    if (step != SQLITE_DONE) {
        std::fflush(out_);
        if ((step & 0xFF) == SQLITE_INTERRUPT) {
            fmt::print(error_,
                       "palpate: this has not ended after {} steps of SQLite, or as many us of the "
                       "processor; --steps gives it more\n",
                       guard_.limits().steps);
        } else {
            complain(all, std::string_view::npos, first_line);
        }
    }
    return step == SQLITE_DONE;
}

bool SqlShell::no_ticks() {
    try {
        return !database_.prepare("SELECT 1 FROM main.trace_chunk LIMIT 1").step();
    } catch (const StoreError&) {  // another file's tables
        return false;
    }
}

bool SqlShell::word(std::string_view line) {
    asked_ = true;
    const std::size_t space = std::min(line.find(' '), line.size());
    const std::string_view name = line.substr(0, space);
    const std::string_view rest = trimmed(line.substr(space), kSpace);
    quit_ = name == ".quit" || name == ".exit";
    if (name == ".help") {
        fmt::print(out_, "{}", kHelp);
    } else if (name == ".tables") {
        tables();
    }
    if (quit_ || name == ".help" || name == ".tables") {
        return true;
    }
    if (name == ".columns") {
        return columns(rest);
    }
    if (name == ".schema") {
        return schema(rest);
    }
    constexpr std::array<std::string_view, 6> kWords{".help",   ".tables", ".columns",
                                                     ".schema", ".quit",   ".exit"};
    fmt::print(error_, "palpate: there is no word {}{}; .help lists them\n", plain(name),
               suggestion(name, kWords, ""));
    return false;
}

void SqlShell::tables() {
    const std::vector<TableManual> manual = manual_of(database_);
    RowPrinter printer(out_, format_, {"name", "type", "meaning"});
    for (const Statement& row :
         database_.prepare("SELECT name, type FROM sqlite_schema WHERE type IN ('table', 'view') "
                           "UNION ALL SELECT 'sample', 'virtual table' ORDER BY type, name")) {
        const TableManual* said = find_table(row.text(0), manual);
        print_row(printer, format_, {row.text(0), row.text(1)},
                  said == nullptr ? std::string() : said->meaning);
    }
    printer.end();
}

void SqlShell::no_such(std::string_view table) {
    std::vector<std::string> names;
    for (const TableManual& one : manual_of(database_)) {
        names.push_back(one.name);
    }
    fmt::print(error_, "palpate: there is no table or view {}{}; .tables lists them\n",
               plain(table), suggestion(table, names, ""));
}

bool SqlShell::columns(std::string_view table) {
    RowPrinter printer(out_, format_, {"table", "column", "unit", "meaning"});
    bool found = false;
    for (const TableManual& one : manual_of(database_)) {
        if (!table.empty() && one.name != table) {
            continue;
        }
        found = true;
        for (const ColumnManual& column : one.columns) {
            print_row(printer, format_, {one.name, column.name, column.unit}, column.meaning);
        }
    }
    if (!found) {
        no_such(table);
        return false;
    }
    printer.end();
    return true;
}

bool SqlShell::schema(std::string_view table) {
    bool found = false;
    const auto print = [&](std::string_view sql) {
        fmt::print(out_, "{};\n", plain(sql, Lines::kept));
        found = true;
    };
    for (const Statement& row :
         database_.prepare("SELECT sql FROM sqlite_schema WHERE sql IS NOT NULL AND (?1 = '' OR "
                           "tbl_name = ?1) ORDER BY rowid",
                           table)) {
        print(row.text(0));
    }
    if (table.empty() || table == "sample") {
        print(sample_declaration());
    }
    if (!found) {
        no_such(table);
    }
    return found;
}

}  // namespace palpate::data

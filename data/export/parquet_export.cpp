#include "data/export/parquet_export.hpp"

#include <string>

#include <fmt/format.h>

#include "data/export/csv_export.hpp"
#include "data/export/duckdb.hpp"
#include "data/export/table_sql.hpp"
#include "data/trace/columns.hpp"

namespace palpate::data {
namespace {

namespace fs = std::filesystem;

std::string sql_text(std::string_view text) {
    std::string out = "'";
    for (const char c : text) {
        out += c == '\'' ? "''" : std::string(1, c);
    }
    return out + "'";
}

using Types = std::vector<std::pair<std::string, std::string>>;

std::string type_of(std::string_view type) {
    return type == "integer" ? "BIGINT" : type == "real" ? "DOUBLE" : "VARCHAR";
}

void convert(DuckDb& duck, const std::string& from, const fs::path& to, const Types& types) {
    constexpr std::string_view kMarked = "'^''(''*[-=+@\t\r])'";
    std::string columns;
    std::string texts;
    for (const auto& [name, type] : types) {
        columns +=
            fmt::format("{}{}: {}", columns.empty() ? "" : ", ", sql_text(name), sql_text(type));
        if (type == "VARCHAR") {  // no spreadsheet opens it: the mark of csv_field() goes again
            texts += fmt::format("{}regexp_replace({}, {}, '\\1') AS {}", texts.empty() ? "" : ", ",
                                 quoted_name(name), kMarked, quoted_name(name));
        }
    }
    duck.run(fmt::format(
        "COPY (SELECT *{} FROM read_csv({}, header = true, delim = ',', quote = '\"', escape = "
        "'\"',"
        " auto_detect = false, allow_quoted_nulls = false, columns = {{{}}})) TO {} (FORMAT "
        "parquet, COMPRESSION zstd)",
        texts.empty() ? "" : " REPLACE (" + texts + ")", sql_text(from), columns,
        sql_text(to.string())));
}

Types tick_types() {
    Types types;
    for (const ExportColumn& key : tick_keys()) {
        types.emplace_back(std::string(key.name), type_of(key.type));
    }
    for (const TraceColumn& column : trace_columns()) {
        types.emplace_back(std::string(column.name), type_of(column.type));
    }
    return types;
}

/// A pattern of files could mean more than this folder, whose name is not ours: from inside there
/// are none.
std::string all_ticks(const fs::path& folder) {
    std::string escaped;
    for (const char c : (folder / "ticks").string()) {
        escaped += c == '*' || c == '?' || c == '[' ? fmt::format("[{}]", c) : std::string(1, c);
    }
    return escaped + "/*.csv.gz";
}

}  // namespace

void export_parquet(Database& database,
                    const Selection& selection,
                    const ExportOptions& options,
                    const std::filesystem::path& folder) {
    DuckDb duck;  // before any work
    export_csv(database, selection, options, folder);
    duck.run("SET preserve_insertion_order = true");
    for (const ExportTable& table : export_tables()) {
        const fs::path from = folder / (std::string(table.name) + ".csv");
        if (!fs::exists(from)) {
            continue;
        }
        Types types;
        for (const ExportColumn& column : visible_columns(table, options.details)) {
            types.emplace_back(std::string(column.name), type_of(column.type));
        }
        convert(duck, from.string(), folder / (std::string(table.name) + ".parquet"), types);
        fs::remove(from);
    }
    if (options.traces) {
        if (!fs::is_empty(folder / "ticks")) {
            convert(duck, all_ticks(folder), folder / "ticks.parquet", tick_types());
        }
        fs::remove_all(folder / "ticks");
    }
}

}  // namespace palpate::data

#include "data/export/parquet_export.hpp"

#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include <dlfcn.h>
#include <fmt/format.h>

#include "data/export/csv_export.hpp"
#include "data/trace/columns.hpp"

namespace palpate::data {
namespace {

namespace fs = std::filesystem;

/// duckdb_result of DuckDB's C API, https://duckdb.org/docs/stable/clients/c/api: six words of its own.
struct DuckResult {
    std::uint64_t own[6] = {};
};

/// DuckDB, in memory, as far as it is needed here.
class Duck {
public:
    Duck() {
        const char* named = std::getenv("PALPATE_DUCKDB");
        library_ = dlopen(named != nullptr ? named : "libduckdb.so", RTLD_NOW | RTLD_LOCAL);
        if (library_ == nullptr) {
            throw std::invalid_argument(
                fmt::format("Parquet needs DuckDB's library, and {} could not be loaded: get "
                            "libduckdb.so (duckdb.org, "
                            "or npm's @duckdb/node-bindings-linux-x64) and set PALPATE_DUCKDB to "
                            "it, or export csv",
                            named != nullptr ? named : "libduckdb.so"));
        }
        const auto open = find<int (*)(const char*, void**)>("duckdb_open");
        const auto connect = find<int (*)(void*, void**)>("duckdb_connect");
        query_ = find<int (*)(void*, const char*, DuckResult*)>("duckdb_query");
        error_ = find<const char* (*)(DuckResult*)>("duckdb_result_error");
        destroy_ = find<void (*)(DuckResult*)>("duckdb_destroy_result");
        disconnect_ = find<void (*)(void**)>("duckdb_disconnect");
        close_ = find<void (*)(void**)>("duckdb_close");
        if (open(nullptr, &database_) != 0 || connect(database_, &connection_) != 0) {
            throw std::runtime_error("DuckDB could not be opened");
        }
    }
    Duck(const Duck&) = delete;
    Duck& operator=(const Duck&) = delete;
    ~Duck() {  // the library itself stays: its threads may still end
        disconnect_(&connection_);
        close_(&database_);
    }

    void run(const std::string& sql) {
        DuckResult result;
        const bool failed = query_(connection_, sql.c_str(), &result) != 0;
        const char* words = failed ? error_(&result) : nullptr;
        const std::string why = words != nullptr ? words : "";
        destroy_(&result);
        if (failed) {
            throw std::runtime_error("DuckDB: " + why);
        }
    }

private:
    template <class Function>
    Function find(const char* name) {
        void* found = dlsym(library_, name);
        if (found == nullptr) {
            throw std::invalid_argument(
                fmt::format("the DuckDB library has no {}: set PALPATE_DUCKDB to version 1", name));
        }
        return reinterpret_cast<Function>(found);
    }

    void* library_ = nullptr;
    void* database_ = nullptr;
    void* connection_ = nullptr;
    int (*query_)(void*, const char*, DuckResult*) = nullptr;
    const char* (*error_)(DuckResult*) = nullptr;
    void (*destroy_)(DuckResult*) = nullptr;
    void (*disconnect_)(void**) = nullptr;
    void (*close_)(void**) = nullptr;
};

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

void convert(Duck& duck, const std::string& from, const fs::path& to, const Types& types) {
    std::string columns;
    for (const auto& [name, type] : types) {
        columns +=
            fmt::format("{}{}: {}", columns.empty() ? "" : ", ", sql_text(name), sql_text(type));
    }
    duck.run(fmt::format(
        "COPY (SELECT * FROM read_csv({}, header = true, delim = ',', quote = '\"', escape = '\"',"
        " auto_detect = false, columns = {{{}}})) TO {} (FORMAT parquet, COMPRESSION zstd)",
        sql_text(from), columns, sql_text(to.string())));
}

Types tick_types() {
    Types types{{"subject", "VARCHAR"},
                {"study", "VARCHAR"},
                {"session", "BIGINT"},
                {"trial", "BIGINT"},
                {"interval", "BIGINT"}};
    for (const TraceColumn& column : trace_columns()) {
        types.emplace_back(std::string(column.name),
                           column.type.starts_with('f') ? "DOUBLE" : "BIGINT");
    }
    return types;
}

/// A pattern of files could mean more than this folder, whose name is not ours: from inside there are none.
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
    Duck duck;  // before any work
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

#include "data/export/duckdb.hpp"

#include <cstdint>
#include <cstdlib>
#include <stdexcept>

#include "engine/base/refuse.hpp"
#include "engine/base/shared_library.hpp"

namespace palpate::data {

/// duckdb_result of DuckDB's C API, https://duckdb.org/docs/stable/clients/c/api: six words of its
/// own.
struct DuckDb::Result {
    std::uint64_t own[6] = {};
};

namespace {

SharedLibrary::Symbol needed(const SharedLibrary& library, const char* name) {
    const SharedLibrary::Symbol found = library.find(name);
    refuse_if(found.place == nullptr,
              "what PALPATE_DUCKDB names has no {}: set it to libduckdb.so, version 1", name);
    return found;
}

}  // namespace

DuckDb::DuckDb() {
    const char* named = std::getenv("PALPATE_DUCKDB");
    const std::string name = named != nullptr && *named != '\0' ? named : "libduckdb.so";
    const SharedLibrary library(name);
    refuse_if(!library.loaded(),
              "Parquet needs DuckDB's library, and {} could not be loaded: get libduckdb.so "
              "(duckdb.org; npm install @duckdb/node-bindings-linux-x64 brings one) and set "
              "PALPATE_DUCKDB to its path, or export csv",
              name);
    int (*const open)(const char*, void**) = needed(library, "duckdb_open");
    int (*const connect)(void*, void**) = needed(library, "duckdb_connect");
    query_ = needed(library, "duckdb_query");
    error_ = needed(library, "duckdb_result_error");
    destroy_ = needed(library, "duckdb_destroy_result");
    disconnect_ = needed(library, "duckdb_disconnect");
    close_ = needed(library, "duckdb_close");
    refuse_if<std::runtime_error>(
        open(nullptr, &database_) != 0 || connect(database_, &connection_) != 0,
        "DuckDB could not be opened");
}

DuckDb::~DuckDb() {
    disconnect_(&connection_);
    close_(&database_);
}

void DuckDb::run(const std::string& sql) {
    Result result;
    const bool failed = query_(connection_, sql.c_str(), &result) != 0;
    const char* words = failed ? error_(&result) : nullptr;
    const std::string why = words != nullptr ? words : "";
    destroy_(&result);
    refuse_if<std::runtime_error>(failed, "DuckDB: {}", why);
}

}  // namespace palpate::data

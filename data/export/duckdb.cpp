#include "data/export/duckdb.hpp"

#include <cstdint>
#include <cstdlib>
#include <stdexcept>

#include <dlfcn.h>
#include <fmt/format.h>

namespace palpate::data {

/// duckdb_result of DuckDB's C API, https://duckdb.org/docs/stable/clients/c/api: six words of its own.
struct DuckDb::Result {
    std::uint64_t own[6] = {};
};

template <class Function>
Function DuckDb::find(const char* name) {
    void* found = dlsym(library_, name);
    if (found == nullptr) {
        throw std::invalid_argument(fmt::format(
            "what PALPATE_DUCKDB names has no {}: set it to libduckdb.so, version 1", name));
    }
    return reinterpret_cast<Function>(found);
}

DuckDb::DuckDb() {
    const char* named = std::getenv("PALPATE_DUCKDB");
    const std::string name = named != nullptr && *named != '\0' ? named : "libduckdb.so";
    library_ = dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (library_ == nullptr) {
        throw std::invalid_argument(fmt::format(
            "Parquet needs DuckDB's library, and {} could not be loaded: get libduckdb.so "
            "(duckdb.org; npm install @duckdb/node-bindings-linux-x64 brings one) and set "
            "PALPATE_DUCKDB to its path, or export csv",
            name));
    }
    const auto open = find<int (*)(const char*, void**)>("duckdb_open");
    const auto connect = find<int (*)(void*, void**)>("duckdb_connect");
    query_ = find<int (*)(void*, const char*, Result*)>("duckdb_query");
    error_ = find<const char* (*)(Result*)>("duckdb_result_error");
    destroy_ = find<void (*)(Result*)>("duckdb_destroy_result");
    disconnect_ = find<void (*)(void**)>("duckdb_disconnect");
    close_ = find<void (*)(void**)>("duckdb_close");
    if (open(nullptr, &database_) != 0 || connect(database_, &connection_) != 0) {
        throw std::runtime_error("DuckDB could not be opened");
    }
}

DuckDb::~DuckDb() {  // the library itself stays: its threads may still end
    disconnect_(&connection_);
    close_(&database_);
}

void DuckDb::run(const std::string& sql) {
    Result result;
    const bool failed = query_(connection_, sql.c_str(), &result) != 0;
    const char* words = failed ? error_(&result) : nullptr;
    const std::string why = words != nullptr ? words : "";
    destroy_(&result);
    if (failed) {
        throw std::runtime_error("DuckDB: " + why);
    }
}

}  // namespace palpate::data

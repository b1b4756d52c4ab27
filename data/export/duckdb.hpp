#pragma once

#include <string>

namespace palpate::data {

/// DuckDB in memory, as far as it is needed here, through the C API of its library, which is looked
/// for when this is made: $PALPATE_DUCKDB, or libduckdb.so where the system keeps libraries.
class DuckDb {
public:
    /// @throws std::invalid_argument if there is no such library: says where to get it
    DuckDb();
    DuckDb(const DuckDb&) = delete;
    DuckDb& operator=(const DuckDb&) = delete;
    ~DuckDb();

    /// @throws std::runtime_error with DuckDB's words
    void run(const std::string& sql);

private:
    struct Result;

    void* database_ = nullptr;
    void* connection_ = nullptr;
    int (*query_)(void*, const char*, Result*) = nullptr;
    const char* (*error_)(Result*) = nullptr;
    void (*destroy_)(Result*) = nullptr;
    void (*disconnect_)(void**) = nullptr;
    void (*close_)(void**) = nullptr;
};

}  // namespace palpate::data

#include "data/extension/query.hpp"

#include <new>

#include <fmt/format.h>
#include <sqlite3ext.h>

SQLITE_EXTENSION_INIT3

namespace palpate::data {

StatementCache::~StatementCache() {
    for (const auto& [sql, statement] : idle_) {
        sqlite3_finalize(statement);
    }
}

Query::Query(StatementCache& database, std::string_view sql) : asked_(database) {
    if (const auto known = asked_.idle_.find(sql); known != asked_.idle_.end()) {
        statement_ = known->second;
        asked_.idle_.erase(known);
        return;
    }
    check(sqlite3_prepare_v2(asked_.db_, sql.data(), static_cast<int>(sql.size()), &statement_,
                             nullptr),
          "this is not a palpate database, or a damaged one");
}

Query::~Query() {
    if (statement_ == nullptr) {
        return;
    }
    reset();
    sqlite3_clear_bindings(statement_);
    try {
        asked_.idle_.emplace(sqlite3_sql(statement_), statement_);
    } catch (const std::bad_alloc&) {
        sqlite3_finalize(statement_);
    }
}

void Query::check(int code, std::string_view doing) const {
    if (code != SQLITE_OK) {
        throw SampleError(fmt::format("{}: {}", doing, sqlite3_errmsg(asked_.db_)));
    }
}

Query& Query::bind(int parameter, std::int64_t value) {
    check(sqlite3_bind_int64(statement_, parameter, value), "asking for ticks");
    return *this;
}

bool Query::step() {
    const int code = sqlite3_step(statement_);
    if (code != SQLITE_ROW && code != SQLITE_DONE) {
        check(code, "reading ticks");
    }
    return code == SQLITE_ROW;
}

void Query::reset() {
    sqlite3_reset(statement_);
}

std::int64_t Query::integer(int column) const {
    return sqlite3_column_int64(statement_, column);
}
double Query::real(int column) const {
    return sqlite3_column_double(statement_, column);
}
bool Query::null(int column) const {
    return sqlite3_column_type(statement_, column) == SQLITE_NULL;
}

std::string Query::text(int column) const {
    const auto bytes = blob(column);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::span<const std::byte> Query::blob(int column) const {
    const void* data = sqlite3_column_blob(statement_, column);
    const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_, column));
    return {static_cast<const std::byte*>(data), data == nullptr ? 0 : size};
}

}  // namespace palpate::data

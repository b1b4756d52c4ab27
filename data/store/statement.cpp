#include "data/store/statement.hpp"

#include <utility>

#include <fmt/format.h>
#include <sqlite3.h>

#include "data/store/database.hpp"

namespace palpate::data {

Statement::Statement(Database& database, std::string_view sql) : database_(&database) {
    if (sqlite3_prepare_v2(database.handle(), sql.data(), static_cast<int>(sql.size()), &statement_,
                           nullptr) != SQLITE_OK) {
        database.fail(fmt::format("preparing \"{}\"", sql.substr(0, 60)));
    }
}

Statement::Statement(Statement&& other) noexcept
    : database_(other.database_), statement_(std::exchange(other.statement_, nullptr)) {}

Statement::~Statement() {
    sqlite3_finalize(statement_);
}

Statement& Statement::bound(int code) {
    if (code != SQLITE_OK) {
        database_->fail(fmt::format("giving values to \"{}\"",
                                    std::string_view(sqlite3_sql(statement_)).substr(0, 60)));
    }
    return *this;
}

Statement& Statement::bind(int parameter, std::int64_t value) {
    return bound(sqlite3_bind_int64(statement_, parameter, value));
}
Statement& Statement::bind(int parameter, double value) {
    return bound(sqlite3_bind_double(statement_, parameter, value));
}
Statement& Statement::bind(int parameter, std::string_view value) {
    // A null pointer would be NULL, not the empty text.
    return bound(sqlite3_bind_text64(statement_, parameter, value.empty() ? "" : value.data(),
                                     value.size(), SQLITE_TRANSIENT, SQLITE_UTF8));
}
Statement& Statement::bind(int parameter, std::span<const std::byte> value) {
    return bound(value.empty() ? sqlite3_bind_zeroblob(statement_, parameter, 0)
                               : sqlite3_bind_blob64(statement_, parameter, value.data(),
                                                     value.size(), SQLITE_TRANSIENT));
}
Statement& Statement::bind_null(int parameter) {
    return bound(sqlite3_bind_null(statement_, parameter));
}

bool Statement::step() {
    const int code = sqlite3_step(statement_);
    if (code == SQLITE_ROW) {
        return true;
    }
    if (code != SQLITE_DONE) {
        database_->fail(
            fmt::format("running \"{}\"", std::string_view(sqlite3_sql(statement_)).substr(0, 60)));
    }
    return false;
}

void Statement::run() {
    while (step()) {
    }
    reset();
}

void Statement::reset() {
    sqlite3_reset(statement_);
    sqlite3_clear_bindings(statement_);
}

int Statement::columns() const {
    return sqlite3_column_count(statement_);
}
std::string_view Statement::name(int column) const {
    return sqlite3_column_name(statement_, column);
}
int Statement::type(int column) const {
    return sqlite3_column_type(statement_, column);
}
std::int64_t Statement::integer(int column) const {
    return sqlite3_column_int64(statement_, column);
}
double Statement::real(int column) const {
    return sqlite3_column_double(statement_, column);
}

std::string Statement::text(int column) const {
    const auto bytes = blob(column);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::span<const std::byte> Statement::blob(int column) const {
    const void* data = sqlite3_column_blob(statement_, column);
    const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_, column));
    return {static_cast<const std::byte*>(data), data == nullptr ? 0 : size};
}

}  // namespace palpate::data

#include "data/sql/statement.hpp"

#include <mutex>
#include <new>
#include <utility>

#include <fmt/format.h>
#include <sqlite3ext.h>
#include <sys/stat.h>

#include "engine/base/text.hpp"

SQLITE_EXTENSION_INIT3

namespace palpate::data {
namespace {

/// Of what is idle on any connection: a session's recorder and its screens use one from two
/// threads.
std::mutex idle_guard;

std::span<const std::byte> bytes_in(sqlite3_stmt* row, int column) {
    const void* data = sqlite3_column_blob(row, column);
    const auto size = static_cast<std::size_t>(sqlite3_column_bytes(row, column));
    return {static_cast<const std::byte*>(data), data == nullptr ? 0 : size};
}

std::string text_in(sqlite3_stmt* row, int column) {
    const auto bytes = bytes_in(row, column);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

std::int64_t written_ns(const std::string& name) {
    struct stat status {};
    return stat(name.c_str(), &status) != 0
             ? 0
             : std::int64_t{status.st_mtim.tv_sec} * 1'000'000'000 + status.st_mtim.tv_nsec;
}

bool Connection::written_since() const {
    return as_of_ns != 0 && written_ns(file) != as_of_ns;
}

void Connection::forget_idle() const noexcept {
    const std::scoped_lock lock(idle_guard);
    for (const auto& [sql, statement] : idle) {
        sqlite3_finalize(statement);
    }
    idle.clear();
}

void Connection::fail(std::string_view doing) const {
    if (failed != nullptr) {
        failed(*this, doing);
    }
    throw StoreError(fmt::format("{}: {} failed: {}", file, doing, sqlite3_errmsg(handle)));
}

void Connection::execute(const char* sql) const {
    if (sqlite3_exec(handle, sql, nullptr, nullptr, nullptr) != SQLITE_OK) {
        fail(fmt::format("running \"{}\"", std::string_view(sql).substr(0, 60)));
    }
}

std::string quoted_name(std::string_view name) {
    return in_quotes(name);
}

std::string quoted_text(std::string_view text) {
    return in_quotes(text, '\'');
}

Statement::Statement(const Connection& connection, std::string_view sql)
    : connection_(&connection) {
    {
        const std::scoped_lock lock(idle_guard);
        if (const auto known = connection.idle.find(sql); known != connection.idle.end()) {
            statement_ = known->second;
            connection.idle.erase(known);
            return;
        }
    }
    if (sqlite3_prepare_v3(connection.handle, sql.data(), static_cast<int>(sql.size()),
                           SQLITE_PREPARE_PERSISTENT, &statement_, nullptr) != SQLITE_OK) {
        connection.fail(fmt::format("preparing \"{}\"", sql.substr(0, 60)));
    }
}

Statement::Statement(Statement&& other) noexcept
    : connection_(other.connection_), statement_(std::exchange(other.statement_, nullptr)) {}

Statement::~Statement() {
    constexpr std::size_t kMaxIdle = 100;
    if (statement_ == nullptr) {
        return;
    }
    const std::string_view sql = sqlite3_sql(statement_);
    if (sql.starts_with("PRAGMA")) {  // some of them answer while they are prepared
        sqlite3_finalize(statement_);
        return;
    }
    reset();
    const std::scoped_lock lock(idle_guard);
    if (connection_->idle.size() >= kMaxIdle) {
        sqlite3_finalize(statement_);
        return;
    }
    try {
        connection_->idle.emplace(sql, statement_);
    } catch (const std::bad_alloc&) {
        sqlite3_finalize(statement_);
    }
}

Statement& Statement::bound(int code) {
    if (code != SQLITE_OK) {
        connection_->fail(fmt::format("giving values to \"{}\"",
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
Statement& Statement::bind(int parameter, std::monostate /*null*/) {
    return bound(sqlite3_bind_null(statement_, parameter));
}

bool Statement::step() {
    const int code = sqlite3_step(statement_);
    const bool there = code == SQLITE_ROW;
    if ((!there && code != SQLITE_DONE) || connection_->written_since()) {
        connection_->fail(
            fmt::format("running \"{}\"", std::string_view(sqlite3_sql(statement_)).substr(0, 60)));
    }
    return there;
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
    return text_in(statement_, column);
}

std::span<const std::byte> Statement::blob(int column) const {
    return bytes_in(statement_, column);
}

ColumnValue column_value(sqlite3_stmt* row, int column) {
    switch (sqlite3_column_type(row, column)) {
        case SQLITE_INTEGER:
            return std::int64_t{sqlite3_column_int64(row, column)};
        case SQLITE_FLOAT:
            return sqlite3_column_double(row, column);
        case SQLITE_TEXT:
            return text_in(row, column);
        case SQLITE_BLOB:
            return bytes_in(row, column);
        default:
            return {};
    }
}

}  // namespace palpate::data

#include "data/store/database.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sqlite3.h>
#include <sys/stat.h>
#include <unistd.h>

#include "data/store/schema.hpp"

namespace palpate::data {
namespace {

/// Readers and checkpoints of others are waited for this long, ms.
constexpr int kBusyMs = 5000;

const char* remedy(int code) {
    switch (code & 0xFF) {
        case SQLITE_FULL:
            return "the disk is full: free some space and run again, what was recorded is kept";
        case SQLITE_READONLY:
            return "the file or its folder is read-only: choose another place or change the rights";
        case SQLITE_BUSY:
        case SQLITE_LOCKED:
            return "another program holds a write lock: close it and run again";
        case SQLITE_CANTOPEN:
            return "check that the folder exists and may be written";
        case SQLITE_NOTADB:
            return "this is not a palpate database: choose another file name";
        case SQLITE_CORRUPT:
            return "the file is damaged: keep it, and restore a copy";
        case SQLITE_IOERR:
            return "the disk does not take the data: check its space and health";
        default:
            return "";
    }
}

/// An empty file of one's own, before SQLite makes one that others can read.
void make_private_file(const std::string& file) {
    const int fd = open(file.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR);
    if (fd >= 0) {
        close(fd);
    }
}

}  // namespace

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

Statement& Statement::bind(int parameter, std::int64_t value) {
    sqlite3_bind_int64(statement_, parameter, value);
    return *this;
}
Statement& Statement::bind(int parameter, double value) {
    sqlite3_bind_double(statement_, parameter, value);
    return *this;
}
Statement& Statement::bind(int parameter, std::string_view value) {
    sqlite3_bind_text(statement_, parameter, value.data(), static_cast<int>(value.size()),
                      SQLITE_TRANSIENT);
    return *this;
}
Statement& Statement::bind(int parameter, std::span<const std::byte> value) {
    sqlite3_bind_blob(statement_, parameter, value.data(), static_cast<int>(value.size()),
                      SQLITE_TRANSIENT);
    return *this;
}
Statement& Statement::bind_null(int parameter) {
    sqlite3_bind_null(statement_, parameter);
    return *this;
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

Database::Database(std::string file, Access access) : file_(std::move(file)) {
    try {
        open(access);
    } catch (...) {
        sqlite3_close_v2(handle_);
        throw;
    }
}

Database::~Database() {
    sqlite3_close_v2(handle_);
}

void Database::fail(std::string_view doing) const {
    const int code = handle_ != nullptr ? sqlite3_errcode(handle_) : SQLITE_NOMEM;
    const char* message = handle_ != nullptr ? sqlite3_errmsg(handle_) : "out of memory";
    const char* what = remedy(code);
    throw StoreError(fmt::format("{}: {} failed: {}{}{}", file_, doing, message,
                                 *what == '\0' ? "" : "; ", what));
}

void Database::open(Access access) {
    if (access == Access::write) {
        make_private_file(file_);
    }
    const int flags = access == Access::write ? SQLITE_OPEN_READWRITE : SQLITE_OPEN_READONLY;
    if (sqlite3_open_v2(file_.c_str(), &handle_, flags, nullptr) != SQLITE_OK) {
        fail("opening");
    }
    sqlite3_extended_result_codes(handle_, 1);
    sqlite3_busy_timeout(handle_, kBusyMs);
    check_identity(access);
    if (access == Access::write) {
        execute("PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL; PRAGMA foreign_keys = ON;");
    }
}

void Database::check_identity(Access access) {
    Statement id = prepare(
        "SELECT (SELECT application_id FROM pragma_application_id),"
        " (SELECT user_version FROM pragma_user_version), (SELECT count(*) FROM sqlite_master)");
    id.step();
    const std::int64_t application = id.integer(0);
    const std::int64_t version = id.integer(1);
    const bool empty = id.integer(2) == 0;
    id.reset();
    if (application == 0 && version == 0 && empty && access == Access::write) {
        execute("PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL;");
        Transaction all(*this);
        execute(std::string(schema_sql()).c_str());
        all.commit();
        return;
    }
    if (application != kApplicationId) {
        throw StoreError(
            fmt::format("{}: this is not a palpate database; choose another file name", file_));
    }
    if (version > kSchemaVersion) {
        throw StoreError(fmt::format(
            "{}: made by a newer palpate (schema {}, this program knows {}); update palpate", file_,
            version, kSchemaVersion));
    }
}

void Database::execute(const char* sql) {
    if (sqlite3_exec(handle_, sql, nullptr, nullptr, nullptr) != SQLITE_OK) {
        fail(fmt::format("running \"{}\"", std::string_view(sql).substr(0, 60)));
    }
}

std::int64_t Database::last_row() const {
    return sqlite3_last_insert_rowid(handle_);
}

void Database::checkpoint() {
    const int code =
        sqlite3_wal_checkpoint_v2(handle_, nullptr, SQLITE_CHECKPOINT_PASSIVE, nullptr, nullptr);
    if (code != SQLITE_OK && (code & 0xFF) != SQLITE_BUSY && (code & 0xFF) != SQLITE_LOCKED) {
        fail("moving the log into the file");
    }
}

Transaction::Transaction(Database& database) : database_(&database) {
    database.execute("BEGIN IMMEDIATE");
}

Transaction::~Transaction() {
    if (database_ != nullptr) {
        sqlite3_exec(database_->handle(), "ROLLBACK", nullptr, nullptr, nullptr);
    }
}

void Transaction::commit() {
    database_->execute("COMMIT");
    database_ = nullptr;
}

std::string utc_now() {
    timespec now{};
    clock_gettime(CLOCK_REALTIME, &now);
    tm utc{};
    gmtime_r(&now.tv_sec, &utc);
    return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:03}Z", utc.tm_year + 1900,
                       utc.tm_mon + 1, utc.tm_mday, utc.tm_hour, utc.tm_min, utc.tm_sec,
                       now.tv_nsec / 1'000'000);
}

}  // namespace palpate::data

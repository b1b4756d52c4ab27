#include "data/store/statement.hpp"

#include <mutex>
#include <new>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <pwd.h>
#include <sqlite3.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "data/schema/catalogue.hpp"
#include "data/store/own_schema.hpp"

namespace palpate::data {
namespace {

/// Of what is idle on any connection: a session's recorder and its screens use one from two
/// threads.
std::mutex idle_guard;

const char* remedy(int code) {
    if (code == SQLITE_IOERR_SHMSIZE || code == SQLITE_IOERR_SHMOPEN ||
        code == SQLITE_IOERR_SHMMAP) {
        return "the index of its log finds no room: the disk is full, and reading needs 32 kB of "
               "it; free some, or copy the file and its -wal to another disk";
    }
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

/// Which files of another user's beside the database may not be written, and what to do; empty:
/// none. They stay where another palpate or SQLite was killed, or only read.
std::string in_the_way(const Connection& connection) {
    const char* file = sqlite3_db_filename(connection.handle, "main");
    std::string names;
    std::string whose;
    for (const char* beside : {"-wal", "-shm"}) {
        const std::string name = std::string(file == nullptr ? "" : file) + beside;
        struct stat status {};
        if (stat(name.c_str(), &status) == 0 && status.st_uid != geteuid() &&
            faccessat(AT_FDCWD, name.c_str(), R_OK | W_OK, AT_EACCESS) != 0) {
            const passwd* user = getpwuid(status.st_uid);
            whose = user != nullptr ? user->pw_name : fmt::format("user {}", status.st_uid);
            names += (names.empty() ? "" : " ") + connection.file + beside;
        }
    }
    return names.empty() ? ""
                         : fmt::format(
                               "what SQLite keeps beside it belongs to {}, and must be "
                               "yours: when no program has the file open, do sudo chown "
                               "$USER {}",
                               whose, names);
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

void Connection::execute(const char* sql) const {
    if (sqlite3_exec(handle, sql, nullptr, nullptr, nullptr) != SQLITE_OK) {
        fail(fmt::format("running \"{}\"", std::string_view(sql).substr(0, 60)));
    }
}

void Connection::fail(std::string_view doing) const {
    const int code = handle != nullptr ? sqlite3_errcode(handle) : SQLITE_NOMEM;
    const std::string message = handle != nullptr ? sqlite3_errmsg(handle) : "out of memory";
    std::string what = remedy(code);
    refuse_if<StoreError>(written_since(), "{}: it was written to while it was read: do this again",
                          file);
    if (handle != nullptr) {
        const bool barred = (code & 0xFF) == SQLITE_READONLY || (code & 0xFF) == SQLITE_CANTOPEN;
        const std::string theirs = barred ? in_the_way(*this) : "";
        what = theirs.empty() ? what : theirs;
    }
    if (handle != nullptr && message.starts_with("FOREIGN KEY")) {
        const std::string theirs = referring_tables(*this);
        what = theirs.empty() ? ""
                              : fmt::format(
                                    "a table that was added refers to rows that would change "
                                    "({}): take its rows or its reference away, and try again",
                                    theirs);
    }
    if (message.starts_with("CHECK constraint")) {
        what =
            "a value that is to be written is none that its table takes, and no palpate made it: "
            "palpate verify says which file holds it; take a copy from before";
    }
    const std::string text =
        fmt::format("{}: {} failed: {}{}{}", file, doing, message, what.empty() ? "" : "; ", what);
    if ((code & 0xFF) == SQLITE_BUSY || (code & 0xFF) == SQLITE_LOCKED) {
        throw LockedFile(text);
    }
    if ((code & 0xFF) == SQLITE_FULL || (code & 0xFF) == SQLITE_IOERR) {
        throw DiskError(text);
    }
    throw StoreError(text);
}

void require_sound_pages(const Connection& file) {
    for (const TableManual& table : catalogue()) {
        if (table.view || table.name == "trace_chunk") {
            continue;
        }
        Statement check(file, fmt::format("PRAGMA main.quick_check({})", table.name));
        check.step();
        const std::string all = check.text(0);
        const std::string first = all.substr(all.find('\n') + 1);  // behind a line without news
        refuse_if<StoreError>(all != "ok",
                              "{}: the file is damaged ({}): keep it, and restore a copy; palpate "
                              "verify says what of it can be read",
                              file.file, first.substr(0, first.find('\n')));
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
    const auto bytes = blob(column);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

ColumnValue Statement::value(int column) const {
    switch (type(column)) {
        case SQLITE_INTEGER:
            return integer(column);
        case SQLITE_FLOAT:
            return real(column);
        case SQLITE_TEXT:
            return text(column);
        case SQLITE_BLOB:
            return blob(column);
        default:
            return {};
    }
}

std::span<const std::byte> Statement::blob(int column) const {
    const void* data = sqlite3_column_blob(statement_, column);
    const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_, column));
    return {static_cast<const std::byte*>(data), data == nullptr ? 0 : size};
}

}  // namespace palpate::data

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <filesystem>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <pwd.h>
#include <sqlite3.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/base/descriptor.hpp"
#include "engine/base/files.hpp"
#include "engine/base/refuse.hpp"
#include "data/schema/catalogue.hpp"
#include "data/sql/statement.hpp"
#include "data/store/database.hpp"
#include "data/store/disk_space.hpp"
#include "data/store/own_schema.hpp"
#include "data/store/session_lock.hpp"

// What becomes of a file that somebody deletes while it is in use, or in which nothing came to be;
// and what SQLite refuses, with what to do about it.
namespace palpate::data {
namespace {

/// How many descriptors of this process are of a file that has, or had before somebody deleted it,
/// that name.
std::ptrdiff_t times_open(const std::string& name) {
    std::error_code unknown;
    const auto open = std::filesystem::directory_iterator("/proc/self/fd", unknown);
    return std::ranges::count_if(open, [&](const auto& descriptor) {
        return std::filesystem::read_symlink(descriptor, unknown) == name;
    });
}

bool was_deleted(const std::string& name) {
    return times_open(name + " (deleted)") > 0;
}

/// A deleted file's content takes its name again, if nobody has given that to another one. The log
/// of the deleted one goes first: SQLite would read it into this one.
bool is_put_back(const std::string& rescued, const std::string& name) {
    if (access(name.c_str(), F_OK) == 0 || !sync_to_disk(rescued)) {  // VACUUM INTO does not
        return false;
    }
    for (const char* beside : {"-shm", "-wal"}) {
        if (times_open(name + beside) > 0) {
            unlink((name + beside).c_str());
        }
    }
    return access((name + "-wal").c_str(), F_OK) != 0 &&
           renameat2(AT_FDCWD, rescued.c_str(), AT_FDCWD, name.c_str(), RENAME_NOREPLACE) == 0;
}

/// Another program has the file open: for as long as its log is, SQLite keeps one of these bytes
/// locked (SHARED_FIRST and SHARED_SIZE of its os.h). Only before this connection locks any, for
/// closing a second descriptor drops the locks.
bool is_in_use(const std::string& file) {
    struct flock bytes {};
    bytes.l_type = F_WRLCK;
    bytes.l_whence = SEEK_SET;
    bytes.l_start = 0x40000002;
    bytes.l_len = 510;
    const Descriptor there(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
    return there.get() >= 0 && fcntl(there.get(), F_GETLK, &bytes) == 0 && bytes.l_type != F_UNLCK;
}

/// Pages, indices and references hold, or nobody can say so.
bool is_sound(const Connection& file) {
    try {
        Statement pages(file, "PRAGMA integrity_check(1)");
        return pages.step() && pages.text(0) == "ok" &&
               !Statement(file, "PRAGMA foreign_key_check").step();
    } catch (const StoreError&) {
        return (sqlite3_errcode(file.handle) & 0xFF) != SQLITE_CORRUPT;
    }
}

/// The file without what its log has.
bool is_sound_alone(const std::string& file) {
    Connection alone{.file = file};
    const bool opened =
        sqlite3_open_v2(immutable_uri(file).c_str(), &alone.handle,
                        SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr) == SQLITE_OK;
    const bool sound = opened && is_sound(alone);
    sqlite3_close(alone.handle);
    return sound;
}

const char* remedy(int code) {
    if (code == SQLITE_IOERR_SHMSIZE || code == SQLITE_IOERR_SHMOPEN ||
        code == SQLITE_IOERR_SHMMAP) {
        return "the index of its log finds no room: the disk is full, and reading needs 32 kB of "
               "it; free some, or copy the file and its -wal to another disk";
    }
    if (code == SQLITE_READONLY_ROLLBACK) {
        return "a program was killed while it wrote it: whoever opens it to write, as run does, "
               "takes back what was not whole";
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
            return "the file is damaged: keep it, with its -wal and -shm, in another folder, and "
                   "restore a copy";
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

/// A log that a crash left behind holds whole pages, and goes with the file alone on which it was
/// begun: with another state of it, as of a copy that was put in its place, pages of two moments
/// would be mixed.
void Database::require_own_log() {
    const std::string name = sqlite3_db_filename(connection_.handle, "main");
    // Who has it open, in this process too, knows its log. (Looking would drop locks here.)
    if (!has_log(name) || times_open(name) != 1 || is_in_use(name)) {
        return;
    }
    refuse_if<StoreError>(
        !is_sound(connection_) && is_sound_alone(name),
        "{0}: the log beside it, {0}-wal, goes with another state of it, as where a copy was put "
        "in its place: nothing is read or written; move {0}-wal and {0}-shm away, and it is what "
        "the copy was",
        connection_.file);
}

/// A log beside the file is its own. Of a file that others have open the log has a name, but for
/// the moment in which it gets one or loses it. Without one a second log would be begun, of which
/// they know nothing.
void Database::require_log(Access access) {
    constexpr int kPauseMs = 5;
    constexpr int kMomentMs = 100;
    constexpr int kLogAt = 18;  // of the header: 2 where a log is kept
    const std::string name = sqlite3_db_filename(connection_.handle, "main");
    struct stat status {};
    const bool several = stat(name.c_str(), &status) == 0 && status.st_nlink > 1;
    refuse_if<StoreError>(
        several && access == Access::write,
        "{}: the file has {} names (hard links), each with a log of its own, and what is written "
        "under one is lost under another: find -samefile lists them; leave one, or copy the file",
        connection_.file, status.st_nlink);
    sqlite3_file* file = nullptr;
    sqlite3_file_control(connection_.handle, "main", SQLITE_FCNTL_FILE_POINTER, &file);
    char kind = 0;
    for (int waited = 0; file->pMethods->xRead(file, &kind, 1, kLogAt) == SQLITE_OK && kind == 2 &&
                         ::access((name + "-wal").c_str(), F_OK) != 0 && is_in_use(name);
         waited += kPauseMs) {
        if (waited >= kMomentMs) {
            refuse_if<StoreError>(several,
                                  "{}: another program uses it under another of its names (hard "
                                  "links), where its log is: use that name",
                                  connection_.file);
            throw StoreError(
                fmt::format("{0}: another program uses it, and its log, {0}-wal, was deleted: it "
                            "is neither read nor written; end that program, which keeps what it "
                            "recorded as {0}.rescued",
                            connection_.file));
        }
        sqlite3_sleep(kPauseMs);
    }
    refuse_if<StoreError>(
        SessionLock::held_elsewhere(name),
        "{0}: the log beside it, {0}-wal, is of another database, which a session records in: "
        "this one, put in its place, is neither read nor written; move it away",
        connection_.file);
}

void Database::take_back() noexcept {
    if (!made_ || connection_.handle == nullptr) {
        return;
    }
    sqlite3_busy_timeout(connection_.handle, 0);
    if (sqlite3_exec(connection_.handle, "BEGIN IMMEDIATE", nullptr, nullptr, nullptr) !=
        SQLITE_OK) {  // another program is at it
        return;
    }
    try {
        if (identity().blank || !prepare("SELECT 1 FROM participant").step()) {
            sqlite3_db_config(connection_.handle, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
            for (const char* beside : {"-shm", "-wal", "-journal", ""}) {
                unlink((plain_name(connection_.file) + beside).c_str());
            }
        }
    } catch (const std::exception&) {  // it cannot be read: it stays
    }
    sqlite3_exec(connection_.handle, "ROLLBACK", nullptr, nullptr, nullptr);
}

void Database::rescue_deleted() {
    if (in_memory_) {
        return;
    }
    const std::string path = sqlite3_db_filename(connection_.handle, "main");
    if (rescued_.empty() && !was_deleted(path) && !was_deleted(path + "-wal")) {
        return;
    }
    // Nor at the end, when SQLite would also delete whatever has its log's name then.
    sqlite3_db_config(connection_.handle, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
    if (rescued_.empty()) {
        std::string name = connection_.file + ".rescued";
        for (int i = 2; !made_private(name) && errno == EEXIST; ++i) {
            name = fmt::format("{}.rescued-{}", connection_.file, i);
        }
        try {
            run("VACUUM INTO ?1", plain_name(name));
        } catch (const StoreError& e) {
            std::filesystem::remove(name);
            throw StoreError(fmt::format(
                "{}: it, or its log, was deleted while it was in use, and what was recorded could "
                "not be kept as {}: {}",
                connection_.file, name, e.what()));
        }
        rescued_ = is_put_back(name, path) ? connection_.file : std::move(name);
    }
    refuse_if<StoreError>(rescued_ == connection_.file,
                          "{}: it was deleted while it was in use; all that was recorded is in it "
                          "again: run again",
                          connection_.file);
    refuse_if<StoreError>(was_deleted(path) && access(path.c_str(), F_OK) == 0,
                          "{0}: it was deleted while it was in use, and another file has its name "
                          "now; all that was recorded is in {1}: palpate merge makes one of both, "
                          "if that is of this study",
                          connection_.file, rescued_);
    throw StoreError(
        fmt::format("{0}: it, or its log, was deleted while it was in use; all that was recorded "
                    "is in {1}: put that in the place of {0}, without {0}-wal and {0}-shm, and run "
                    "again",
                    connection_.file, rescued_));
}

void fail_with_remedy(const Connection& connection, std::string_view doing) {
    const std::string& file = connection.file;
    sqlite3* handle = connection.handle;
    const int code = handle != nullptr ? sqlite3_errcode(handle) : SQLITE_NOMEM;
    const std::string message = handle != nullptr ? sqlite3_errmsg(handle) : "out of memory";
    std::string what = remedy(code);
    refuse_if<StoreError>(connection.written_since(),
                          "{}: it was written to while it was read: do this again", file);
    if (handle != nullptr) {
        const bool barred = (code & 0xFF) == SQLITE_READONLY || (code & 0xFF) == SQLITE_CANTOPEN;
        const std::string theirs = barred ? in_the_way(connection) : "";
        what = theirs.empty() ? what : theirs;
    }
    if (handle != nullptr && message.starts_with("FOREIGN KEY")) {
        const std::string theirs = referring_tables(connection);
        what = theirs.empty() ? ""
                              : fmt::format(
                                    "a table that was added refers to rows that would change "
                                    "({}): take its rows or its reference away, and try again",
                                    theirs);
    }
    refuse_if<StoreError>(
        message.starts_with("UNIQUE constraint"),
        "{}: what is to be written is there already ({}): rows were changed or deleted by hand; "
        "palpate verify says which, take a copy from before",
        file, message);
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
                              "{}: the file is damaged ({}): keep it, with its -wal and -shm, in "
                              "another folder, and restore a copy; palpate verify says what of it "
                              "can be read",
                              file.file, first.substr(0, first.find('\n')));
    }
}

}  // namespace palpate::data

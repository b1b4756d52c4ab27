#include <fcntl.h>
#include <fmt/format.h>
#include <pwd.h>
#include <sqlite3.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/base/refuse.hpp"
#include "data/schema/catalogue.hpp"
#include "data/sql/statement.hpp"
#include "data/store/database.hpp"
#include "data/store/own_schema.hpp"

namespace palpate::data {
namespace {

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

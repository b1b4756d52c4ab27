#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sqlite3.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/base/refuse.hpp"
#include "data/store/database.hpp"
#include "data/store/session_lock.hpp"

// What becomes of a file that somebody deletes while it is in use.
namespace palpate::data {
namespace {

/// This process has the file, or its log, open under that name, and somebody deleted the name.
bool was_deleted(const std::string& path) {
    std::error_code unknown;
    const auto open = std::filesystem::directory_iterator("/proc/self/fd", unknown);
    return std::ranges::any_of(open, [&](const auto& descriptor) {
        const std::string target = std::filesystem::read_symlink(descriptor, unknown).string();
        return target == path + " (deleted)" || target == path + "-wal (deleted)";
    });
}

/// An empty file, of nobody else.
bool made_private(const std::string& name) {
    const int made = open(name.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, S_IRUSR | S_IWUSR);
    return made >= 0 && close(made) == 0;
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
    const int there = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
    const bool found = there >= 0 && fcntl(there, F_GETLK, &bytes) == 0 && bytes.l_type != F_UNLCK;
    if (there >= 0) {
        close(there);
    }
    return found;
}

}  // namespace

/// A log beside the file is its own. Of a file that others have open the log has a name, but for
/// the moment in which it gets one or loses it. Without one a second log would be begun, of which
/// they know nothing.
void Database::require_log() {
    constexpr int kPauseMs = 5;
    constexpr int kMomentMs = 100;
    constexpr int kLogAt = 18;  // of the header: 2 where a log is kept
    const std::string name = sqlite3_db_filename(connection_.handle, "main");
    sqlite3_file* file = nullptr;
    sqlite3_file_control(connection_.handle, "main", SQLITE_FCNTL_FILE_POINTER, &file);
    char kind = 0;
    for (int waited = 0; file->pMethods->xRead(file, &kind, 1, kLogAt) == SQLITE_OK && kind == 2 &&
                         access((name + "-wal").c_str(), F_OK) != 0 && is_in_use(name);
         waited += kPauseMs) {
        if (waited >= kMomentMs) {
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

void Database::rescue_deleted() {
    if (in_memory_ || !was_deleted(sqlite3_db_filename(connection_.handle, "main"))) {
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
            run("VACUUM INTO ?1", name);
        } catch (const StoreError& e) {
            std::filesystem::remove(name);
            throw StoreError(fmt::format(
                "{}: it, or its log, was deleted while it was in use, and what was recorded could "
                "not be kept as {}: {}",
                connection_.file, name, e.what()));
        }
        rescued_ = std::move(name);
    }
    throw StoreError(
        fmt::format("{}: it, or its log, was deleted while it was in use; all that was recorded is "
                    "in {}: put that in its place and run again",
                    connection_.file, rescued_));
}

}  // namespace palpate::data

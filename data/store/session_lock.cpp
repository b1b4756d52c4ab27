#include "data/store/session_lock.hpp"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include "data/store/disk_space.hpp"

namespace palpate::data {
namespace {

/// Bytes of a log, from here on one for each database: whoever runs a session holds that of its
/// own, beside one for the session.
constexpr std::int64_t kDatabaseBytes = std::int64_t{1} << 62U;

std::int64_t database_byte(const std::string& name) {
    struct stat status {};
    return stat(name.c_str(), &status) != 0
             ? kDatabaseBytes
             : kDatabaseBytes + static_cast<std::int64_t>(status.st_ino % kDatabaseBytes);
}

/// Of SQLite's log, whether or not it is as long.
struct flock bytes_of(short type, off_t first, off_t end) {
    struct flock bytes {};
    bytes.l_type = type;
    bytes.l_whence = SEEK_SET;
    bytes.l_start = first;
    bytes.l_len = end - first;
    return bytes;
}

/// Locks of others from one byte up to another. The kernel names any of them first.
std::size_t locks_within(int log, off_t first, off_t end) {
    struct flock bytes = bytes_of(F_WRLCK, first, end);
    if (first >= end || fcntl(log, F_OFD_GETLK, &bytes) != 0 || bytes.l_type == F_UNLCK) {
        return 0;
    }
    return 1 + locks_within(log, first, bytes.l_start) + locks_within(log, bytes.l_start + 1, end);
}

/// The same of a file's log.
std::size_t locks_of(const std::string& file, off_t first, off_t end) {
    const Descriptor log(open(log_of(file).c_str(), O_RDONLY | O_CLOEXEC));
    return log.get() >= 0 ? locks_within(log.get(), first, end) : 0;
}

}  // namespace

SessionLock::SessionLock(Database& database, std::int64_t session) {
    if (database.in_memory()) {
        return;  // nobody else sees it
    }
    static_cast<void>(database.first("PRAGMA schema_version"));  // SQLite has laid the log by then
    log_ = Descriptor(open(log_of(database.file()).c_str(), O_RDWR | O_CLOEXEC));
    const std::int64_t byte = database_byte(database.file());
    struct flock own = bytes_of(F_RDLCK, byte, byte + 1);  // several sessions of one database
    struct flock bytes = bytes_of(F_WRLCK, session, session + 1);
    const int log = log_.get();
    if (log >= 0 && fcntl(log, F_OFD_SETLK, &own) == 0 && fcntl(log, F_OFD_SETLK, &bytes) == 0) {
        return;
    }
    const int error = errno;
    throw StoreError(error == EAGAIN
                         ? fmt::format("{}: another palpate is running this session; end it first",
                                       database.file())
                         : fmt::format("{}: the session could not be locked: {}", database.file(),
                                       std::strerror(error)));
}

bool SessionLock::held(const Database& database, std::int64_t session) {
    return locks_of(database.file(), session, session + 1) > 0;
}

std::size_t SessionLock::all_held(const std::string& file) {
    return locks_of(file, 0, kDatabaseBytes);
}

bool SessionLock::held_elsewhere(const std::string& file) {
    const std::int64_t byte = database_byte(file);
    return all_held(file) > 0 && locks_of(file, byte, byte + 1) == 0;
}

}  // namespace palpate::data

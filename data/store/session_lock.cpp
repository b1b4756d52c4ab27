#include "data/store/session_lock.hpp"

#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "data/store/disk_space.hpp"

namespace palpate::data {
namespace {

/// Of SQLite's log a byte each session, or all of them, whether or not the log is as long.
struct flock bytes_of(std::optional<std::int64_t> session) {
    struct flock bytes {};
    bytes.l_type = F_WRLCK;
    bytes.l_whence = SEEK_SET;
    bytes.l_start = session.value_or(0);
    bytes.l_len = session ? 1 : 0;
    return bytes;
}

/// Locks of others from one byte up to another. The kernel names any of them first.
std::size_t locks_within(int log, off_t first, off_t end) {
    struct flock bytes = bytes_of(std::nullopt);
    bytes.l_start = first;
    bytes.l_len = end - first;
    if (first >= end || fcntl(log, F_OFD_GETLK, &bytes) != 0 || bytes.l_type == F_UNLCK) {
        return 0;
    }
    return 1 + locks_within(log, first, bytes.l_start) + locks_within(log, bytes.l_start + 1, end);
}

}  // namespace

SessionLock::SessionLock(Database& database, std::int64_t session) {
    if (database.in_memory()) {
        return;  // nobody else sees it
    }
    static_cast<void>(database.first("PRAGMA schema_version"));  // SQLite has laid the log by then
    log_ = open(log_of(database.file()).c_str(), O_RDWR | O_CLOEXEC);
    struct flock bytes = bytes_of(session);
    struct flock own = bytes_of(database_byte(database.file()));
    own.l_type = F_RDLCK;  // several sessions of one database
    if (log_ >= 0 && fcntl(log_, F_OFD_SETLK, &own) == 0 && fcntl(log_, F_OFD_SETLK, &bytes) == 0) {
        return;
    }
    const int error = errno;
    if (log_ >= 0) {
        close(log_);
    }
    throw StoreError(error == EAGAIN
                         ? fmt::format("{}: another palpate is running this session; end it first",
                                       database.file())
                         : fmt::format("{}: the session could not be locked: {}", database.file(),
                                       std::strerror(error)));
}

bool SessionLock::held(const std::string& file, std::optional<std::int64_t> session) {
    const int log = open(log_of(file).c_str(), O_RDONLY | O_CLOEXEC);
    struct flock bytes = bytes_of(session);
    const bool found = log >= 0 && fcntl(log, F_OFD_GETLK, &bytes) == 0 && bytes.l_type != F_UNLCK;
    if (log >= 0) {
        close(log);
    }
    return found;
}

std::size_t SessionLock::all_held(const std::string& file) {
    const int log = open(log_of(file).c_str(), O_RDONLY | O_CLOEXEC);
    const std::size_t found = log >= 0 ? locks_within(log, 0, kDatabaseBytes) : 0;
    if (log >= 0) {
        close(log);
    }
    return found;
}

SessionLock::SessionLock(SessionLock&& other) noexcept : log_(std::exchange(other.log_, -1)) {}

SessionLock::~SessionLock() {
    if (log_ >= 0) {
        close(log_);
    }
}

}  // namespace palpate::data

#include "data/store/session_lock.hpp"

#include <cerrno>
#include <cstddef>
#include <cstring>
#include <utility>

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

namespace palpate::data {

SessionLock::SessionLock(const Database& database, std::int64_t session) {
    struct stat file {};
    if (stat(database.file().c_str(), &file) != 0) {
        throw StoreError(database.file() + ": it is no longer there");
    }
    // A name in Linux' abstract socket space: no file is left behind, and the kernel takes the name
    // back when the process ends, however it ends.
    const std::string name = fmt::format("palpate-{}-{}-{}", file.st_dev, file.st_ino, session);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path + 1, name.data(), name.size());
    socket_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
    if (socket_ >= 0 && bind(socket_, reinterpret_cast<const sockaddr*>(&address), length) == 0) {
        return;
    }
    const int error = errno;
    if (socket_ >= 0) {
        close(socket_);
    }
    throw StoreError(error == EADDRINUSE
                         ? fmt::format("{}: another palpate is running this session; end it first",
                                       database.file())
                         : fmt::format("{}: the session could not be locked: {}", database.file(),
                                       std::strerror(error)));
}

SessionLock::SessionLock(SessionLock&& other) noexcept
    : socket_(std::exchange(other.socket_, -1)) {}

SessionLock::~SessionLock() {
    if (socket_ >= 0) {
        close(socket_);
    }
}

}  // namespace palpate::data

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

#include "engine/base/refuse.hpp"

namespace palpate::data {

namespace {

/// A name in Linux' abstract socket space: no file is left behind, and the kernel takes the name
/// back when the process ends, however it ends.
struct Name {
    sockaddr_un address{};
    socklen_t length = 0;

    Name(const Database& database, std::int64_t session) {
        struct stat file {};
        refuse_if<StoreError>(stat(database.file().c_str(), &file) != 0,
                              "{}: it is no longer there", database.file());
        const std::string name = fmt::format("palpate-{}-{}-{}", file.st_dev, file.st_ino, session);
        address.sun_family = AF_UNIX;
        std::memcpy(address.sun_path + 1, name.data(), name.size());
        length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
    }
    [[nodiscard]] const sockaddr* get() const {
        return reinterpret_cast<const sockaddr*>(&address);
    }
};

}  // namespace

SessionLock::SessionLock(const Database& database, std::int64_t session) {
    if (database.in_memory()) {
        return;  // nobody else sees it
    }
    const Name name(database, session);
    socket_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    if (socket_ >= 0 && bind(socket_, name.get(), name.length) == 0) {
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

bool SessionLock::held(const Database& database, std::int64_t session) {
    const Name name(database, session);
    const int asking = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    const bool answered = asking >= 0 && connect(asking, name.get(), name.length) == 0;
    if (asking >= 0) {
        close(asking);
    }
    return answered;
}

SessionLock::SessionLock(SessionLock&& other) noexcept
    : socket_(std::exchange(other.socket_, -1)) {}

SessionLock::~SessionLock() {
    if (socket_ >= 0) {
        close(socket_);
    }
}

}  // namespace palpate::data

#pragma once

#include <cstdint>

#include "data/store/database.hpp"

namespace palpate::data {

/// Keeps a second program off a session. Released when this object, or the whole process, ends.
class SessionLock {
public:
    /// @throws StoreError if another program runs the session
    SessionLock(const Database& database, std::int64_t session);
    SessionLock(SessionLock&& other) noexcept;
    SessionLock& operator=(SessionLock&&) = delete;
    SessionLock(const SessionLock&) = delete;
    SessionLock& operator=(const SessionLock&) = delete;
    ~SessionLock();

    /// Some program of this computer, this one too, runs the session.
    [[nodiscard]] static bool held(const Database& database, std::int64_t session);

private:
    int socket_ = -1;
};

}  // namespace palpate::data

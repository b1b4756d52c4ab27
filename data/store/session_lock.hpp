#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "engine/base/descriptor.hpp"
#include "data/store/database.hpp"

namespace palpate::data {

/// Keeps a second program off a session, in another container too: the kernel's lock of one byte of
/// SQLite's log (F_OFD_SETLK). Not of the database itself: whoever closes a second descriptor of it
/// drops SQLite's own locks in this process, and of its log SQLite locks nothing. Released when
/// this object, or the whole process, ends.
class SessionLock {
public:
    /// @throws StoreError if another program runs the session
    SessionLock(Database& database, std::int64_t session);

    /// Some program of this computer, this one too, runs the session.
    [[nodiscard]] static bool held(const Database& database, std::int64_t session);
    /// How many sessions of a file programs of this computer run.
    [[nodiscard]] static std::size_t all_held(const std::string& file);
    /// A session runs on the file's log, and on another database than this one, which was put in
    /// its place: SQLite would write what that session recorded into it.
    [[nodiscard]] static bool held_elsewhere(const std::string& file);

private:
    Descriptor log_{};
};

}  // namespace palpate::data

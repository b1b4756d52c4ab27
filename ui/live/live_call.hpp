#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ui/live/live_segment.hpp"

namespace palpate::ui {

/// A session that runs now on this machine, and shows itself to this user.
struct RunningSession {
    std::string name;  ///< of its control socket
    std::string file;  ///< its database
    std::string uuid;
    ProcessIdentity process{};
    std::unique_ptr<LiveReader> reader;
};

/// @param of  a database, or a session's uuid; none: all
[[nodiscard]] std::vector<RunningSession> running_sessions(const std::optional<std::string>& of);

}  // namespace palpate::ui

#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "ui/rig/control_line.hpp"

/// The other side of a session's control socket: whoever asks for something.
namespace palpate::ui {

/// What became of those that were asked to stop.
struct StopResult {
    std::size_t sessions = 0;
    std::string labels{};  ///< a line each
    std::size_t refused = 0;
    std::size_t silent = 0;  ///< hang, and did not answer within 2 s
};

/// Stops the sessions that run on a database, or, without one, every session that this user may
/// stop. Calls all before it hears any: one that hangs keeps nobody else's force on.
[[nodiscard]] StopResult stop_sessions(const std::optional<std::string>& database);

/// What a session answered.
struct ControlAnswer {
    std::string line;  ///< JSON; empty: it hung up, or did not answer within 2 s
    Descriptor file{};
};
/// @param name  of session_names()   @param line  JSON, without its end
[[nodiscard]] ControlAnswer ask_session(const std::string& name, const std::string& line);

}  // namespace palpate::ui

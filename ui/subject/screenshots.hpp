#pragma once

#include <string>
#include <vector>

#include "protocols/design/plan.hpp"
#include "protocols/protocol/protocol.hpp"
#include "ui/subject/window.hpp"

namespace palpate::ui {

/// Draws every subject screen that a session of the protocol can show off any display, with its own
/// question, hints and counts, and writes each as a PNG file into `directory`, which must exist.
/// Returns their names.
/// @param plan  of such a session
/// @throws std::runtime_error if a file cannot be written
std::vector<std::string> write_screenshots(const std::string& directory,
                                           const protocols::Protocol& protocol,
                                           const protocols::Plan& plan,
                                           const WindowOptions& options);

}  // namespace palpate::ui

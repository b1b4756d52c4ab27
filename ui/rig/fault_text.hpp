#pragma once

#include <string>

#include "protocols/session/recorder.hpp"
#include "protocols/session/session.hpp"

namespace palpate::ui {

/// Of a faulted trial's line on the console: what happened, what to do. For the experimenter, but a participant
/// may see it: nothing of the stimulus.
///
///     fault: the handle was faster than the limit: move more slowly
[[nodiscard]] std::string fault_text(const protocols::Fault& fault);

/// A session that ended because its display did, and how it goes on.
[[nodiscard]] std::string display_lost_text(const protocols::SessionEnd& end);

/// Why a session was given up with SessionEnd::Why::faulted, and how it goes on.
[[nodiscard]] std::string given_up_text(const protocols::SessionEnd& end);

}  // namespace palpate::ui

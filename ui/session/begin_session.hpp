#pragma once

#include <string>
#include <vector>

#include "data/store/database.hpp"
#include "data/store/session_store.hpp"
#include "ui/session/open_apparatus.hpp"
#include "ui/session/rig.hpp"

namespace palpate::ui {

/// What the file says against running spec.key.participant now: a code much like another one,
/// another version of the protocol, no consent, the other handedness. Asked before the rig's
/// questions, which wait without limit, and again in the transaction that begins or resumes the
/// session. What does not stand against it is said, unless spec.said has it.
/// @param database  none: the file is not there yet, and knows nobody
/// @return all that had to be said
/// @throws std::invalid_argument with what stands against it, and the remedy
std::vector<std::string> admit(data::Database* database,
                               const std::string& file,
                               const RigSpec& spec);

/// All that refuses the session that `spec` would go on with, before a device is touched
/// (data::check_session()). Whoever changes its device on purpose says so by spec.other_device, or
/// types whose session it is: then that is set.
/// @throws std::invalid_argument where there is no terminal to ask, or std::runtime_error for
/// another answer
void check_goes_on(data::Database& database, RigSpec& spec);

/// Plans and opens the session, or resumes it, on the device that was opened: as
/// data::plan_and_open_session(), with admit() in its transaction.
/// @param session  becomes what it is, with its plan
/// @throws as these, and as check_goes_on(): which board it is, only an opened one says
[[nodiscard]] data::OpenedSession begin_session(data::Database& database,
                                                const RigSpec& spec,
                                                const OpenedApparatus& felt,
                                                data::SessionSpec& session);

}  // namespace palpate::ui

#pragma once

#include "data/store/database.hpp"
#include "data/store/session_store.hpp"
#include "ui/session/open_apparatus.hpp"
#include "ui/session/rig.hpp"

namespace palpate::ui {

/// As check_goes_on() of the session that `spec` would go on with.
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

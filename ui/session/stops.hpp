#pragma once

#include <memory>

#include "protocols/session/operator_desk.hpp"
#include "protocols/trial/apparatus.hpp"
#include "protocols/trial/observer.hpp"
#include "data/store/database.hpp"
#include "ui/live/live_session.hpp"
#include "ui/rig/stop_lines.hpp"
#include "ui/session/rig.hpp"

namespace palpate::ui {

/// What stops the force without the window, and what others may ask of a session that is shown. The
/// desk hears of a stop first, so that no trial begins unheard.
[[nodiscard]] std::unique_ptr<StopLines> stop_lines(const data::Database& database,
                                                    const RigSpec& spec,
                                                    protocols::Apparatus& apparatus,
                                                    protocols::OperatorDesk& desk,
                                                    LiveSession& live);

/// After what nobody can mend in here, as a full disk, the participant's screen asks for a moment
/// until the experimenter has come. The force is off.
void keep_screen(protocols::Observer& screen, protocols::OperatorDesk& desk, const char* why);

}  // namespace palpate::ui

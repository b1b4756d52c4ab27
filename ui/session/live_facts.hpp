#pragma once

#include "data/store/session_store.hpp"
#include "ui/live/live_board.hpp"
#include "ui/session/open_apparatus.hpp"

namespace palpate::ui {

/// What those who look on see of a session beside what happens in it; of its screen and its noise
/// nothing yet.
[[nodiscard]] LiveFacts live_facts(const RigSpec& spec,
                                   const OpenedApparatus& felt,
                                   data::Database& database,
                                   const data::OpenedSession& opened);

}  // namespace palpate::ui

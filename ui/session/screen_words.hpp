#pragma once

#include "ui/command/command.hpp"
#include "ui/session/rig.hpp"

namespace palpate::ui {

/// The words of every command that shows a session.
void add_screen_words(CommandWords& words, ScreenOptions& screen);

/// A window can be opened here and was not declined.
/// @throws std::invalid_argument if a display is named and cannot be opened: nobody would see the
/// session
[[nodiscard]] bool wants_window(const ScreenOptions& screen);

}  // namespace palpate::ui

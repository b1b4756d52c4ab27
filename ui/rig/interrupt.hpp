#pragma once

namespace palpate::ui {

/// From now on SIGINT, SIGTERM and SIGHUP ask the session to stop instead of killing the program; a
/// second SIGINT kills it. The force is ramped out and the trial kept as aborted. A reader of
/// standard output that goes away (SIGPIPE) ends nothing.
void catch_signals();

/// As a signal does.
void interrupt() noexcept;

/// A signal arrived, or interrupt() was called.
[[nodiscard]] bool interrupted() noexcept;

}  // namespace palpate::ui

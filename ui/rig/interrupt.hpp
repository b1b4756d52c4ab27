#pragma once

namespace palpate::ui {

/// From now on SIGINT, SIGTERM and SIGHUP ask the session to stop instead of killing the program.
/// The force is ramped out and the trial kept as aborted. One that comes again kills it, if the
/// first is more than a second ago. A reader of standard output that goes away (SIGPIPE) ends
/// nothing.
void catch_signals();

/// As a signal does.
void interrupt() noexcept;

/// A signal arrived, or interrupt() was called.
[[nodiscard]] bool interrupted() noexcept;

}  // namespace palpate::ui

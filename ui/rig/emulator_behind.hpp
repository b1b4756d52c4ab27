#pragma once

#include <optional>

#include <sys/types.h>

#include "ui/rig/device_choice.hpp"

namespace palpate::ui {

/// The process of `palpate haply-emulator` that is the board behind a port; none: nothing says so.
///
/// The protocol of a Haply board has no question that would tell, and an answer could be made up.
/// So the kernel is asked who holds the other end: the process whose terminal's master it is
/// (tty-index in /proc/PID/fdinfo), or whose UDP port of this machine, if it calls itself
/// haply-emulator. A real board has no such process, whatever it answers and through whatever
/// program: nothing is guessed from a port that is a pseudo-terminal. The emulator of another user
/// is not seen (another user cannot open its terminal either).
[[nodiscard]] std::optional<pid_t> emulator_behind(const DeviceChoice& choice);

}  // namespace palpate::ui

#pragma once

#include <optional>

#include <sys/types.h>

#include "ui/rig/device_choice.hpp"

namespace palpate::ui {

/// What the kernel says of the other end of a port.
struct Behind {
    std::optional<pid_t> emulator{};  ///< the process of `palpate haply-emulator` that is the board
    bool unseen = false;              ///< a program of this machine, and nobody knows which
};

/// The protocol of a Haply board has no question that would tell, and an answer could be made up.
/// So the kernel is asked who holds the other end: the process whose terminal's master it is
/// (tty-index in /proc/PID/fdinfo), or whose UDP port of this machine; it is the emulator if it
/// calls itself haply-emulator. A real board has no such process, whatever it answers and through
/// whatever program: nothing is guessed from a port that is a pseudo-terminal. Where nobody is seen
/// to hold it (the program of another user, or of a container), it is unseen.
[[nodiscard]] Behind behind(const DeviceChoice& choice);

}  // namespace palpate::ui

#pragma once

#include <sys/types.h>

namespace palpate::engine {

/// Moves a process of this program into a control group of its own, a transient scope of systemd:
/// what freezes or kills palpate's group leaves it alone. Asked over busctl, which comes with
/// systemd-run and, unlike it, moves a process that lives. Takes two seconds at most.
/// @return false: there is no systemd, it refused, or it took too long; the process stays where it
/// was
[[nodiscard]] bool set_apart(pid_t process);

}  // namespace palpate::engine

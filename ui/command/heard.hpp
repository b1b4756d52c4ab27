#pragma once

#include <cstdio>

#include <sys/stat.h>
#include <unistd.h>

#include "ui/command/command.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {

/// The exit code of a command that ended with `code`: a full disk behind standard output is no
/// success. Who closes a pipe has read enough.
[[nodiscard]] inline int heard(int code) {
    struct stat out {};
    const bool lost = std::fflush(stdout) != 0 || std::ferror(stdout) != 0;
    if (code != 0 || !lost || (fstat(STDOUT_FILENO, &out) == 0 && S_ISFIFO(out.st_mode))) {
        return code;
    }
    warn("standard output: cannot be written; check the space on the disk");
    return kExitFailure;
}

}  // namespace palpate::ui

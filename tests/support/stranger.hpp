#pragma once

#include <grp.h>

#include "tests/support/catch.hpp"

namespace palpate::tests {

/// Whether it holds for a user whom nobody knows; true where this one may not become another.
[[nodiscard]] inline bool holds_for_a_stranger(const std::function<bool()>& law) {
    if (geteuid() != 0) {
        WARN("only root can become another user");
        return true;
    }
    const pid_t child = fork();
    if (child == 0) {
        constexpr uid_t kNobody = 65534;
        _exit(setgroups(0, nullptr) == 0 && setresgid(kNobody, kNobody, kNobody) == 0 &&
                      setresuid(kNobody, kNobody, kNobody) == 0 && law()
                  ? 0
                  : 1);
    }
    int status = 1;
    waitpid(child, &status, 0);
    return status == 0;
}

}  // namespace palpate::tests

#pragma once

#include <functional>

#include <sys/types.h>

namespace palpate::tests {

/// In a child, first of all: ends it when `parent` ends, however that comes (a crash, ctest's
/// time-out).
void die_with(pid_t parent);

/// Runs `work` in a child process, which ends after it. @return its id, to be killed and reaped
[[nodiscard]] pid_t in_a_child(const std::function<void()>& work);

/// The guard that `palpate` has started; -1: there is none.
[[nodiscard]] pid_t guard_of(pid_t palpate);

/// 1 ms.
void wait_a_little();

/// Lets up to 20 s pass until `done`. @return done
template <class Done>
bool eventually(const Done& done) {
    for (int waited = 0; waited < 20'000; ++waited) {
        if (done()) {
            return true;
        }
        wait_a_little();
    }
    return done();
}

}  // namespace palpate::tests

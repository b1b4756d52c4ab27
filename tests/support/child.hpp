#pragma once

#include "engine/base/clock.hpp"
#include "tests/support/std.hpp"

namespace palpate::tests {

/// In a child, first of all: ends it when `parent` ends, however that comes (a crash, ctest's
/// time-out).
void die_with(pid_t parent);

/// Runs `work` in a child process, which ends after it. @return its id, to be killed and reaped
[[nodiscard]] pid_t in_a_child(const std::function<void()>& work);

/// The guard that `palpate` has started; -1: there is none.
[[nodiscard]] pid_t guard_of(pid_t palpate);

void wait_a_little(int ms = 1);

/// How long a test waits for what must come: 50 s, or PALPATE_TEST_PATIENCE, of a test that must fail.
[[nodiscard]] std::int64_t patience_ns();

/// Lets up to patience_ns() pass until `done`, and looks less and less often, up to every 8 ms: who
/// looks on keeps no board from its turn. @return done
template <class Done>
bool eventually(const Done& done) {
    const std::int64_t end = monotonic_ns() + patience_ns();
    for (int looks = 0; monotonic_ns() < end; ++looks) {
        if (done()) {
            return true;
        }
        wait_a_little(std::min(1 + looks / 10, 8));
    }
    return done();
}

}  // namespace palpate::tests

#include <sys/prctl.h>

#include "tests/support/std.hpp"

namespace {

/// A test that hangs ends when ctest is killed, and what it started with it (die_with() in
/// child.hpp).
[[maybe_unused]] const int asked = prctl(PR_SET_PDEATHSIG, SIGKILL);

/// A test that waits for nobody's hand gives way to those with a servo in real time.
[[maybe_unused]] const int given_way = [] {
    const char* const by = std::getenv("PALPATE_TEST_NICE");
    return by != nullptr ? nice(std::atoi(by)) : 0;
}();

}  // namespace

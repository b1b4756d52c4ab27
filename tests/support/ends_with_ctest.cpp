#include <csignal>

#include <sys/prctl.h>

namespace {

/// A test that hangs ends when ctest is killed, and what it started with it (die_with() in
/// child.hpp).
[[maybe_unused]] const int asked = prctl(PR_SET_PDEATHSIG, SIGKILL);

}  // namespace

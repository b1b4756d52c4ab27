#include <net/if.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/mount.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <unistd.h>

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

/// Sessions are called by names of the network's, and the next board may get the terminal of one
/// that was unplugged: with a network (loopback alone) and terminals of its own, a test's `palpate
/// stop` ends its own sessions, and its boards stay away. Whoever is not root may have both among
/// users of its own, who are those of before.
[[maybe_unused]] const bool apart = [] {
    constexpr int kApart = CLONE_NEWNET | CLONE_NEWNS;
    if (std::getenv("PALPATE_TEST_APART") == nullptr) {
        return false;
    }
    const auto user = geteuid();
    const auto group = getegid();
    if (unshare(kApart) != 0) {
        if (unshare(CLONE_NEWUSER | kApart) != 0) {
            return false;
        }
        std::ofstream("/proc/self/setgroups") << "deny";
        std::ofstream("/proc/self/uid_map") << fmt::format("{0} {0} 1", user);
        std::ofstream("/proc/self/gid_map") << fmt::format("{0} {0} 1", group);
    }
    const int any = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    ifreq loopback{.ifr_ifrn = {"lo"}, .ifr_ifru = {}};
    loopback.ifr_flags = IFF_UP;
    const bool up = ioctl(any, SIOCSIFFLAGS, &loopback) == 0;
    close(any);
    if (!up || mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0 ||
        mount("devpts", "/dev/pts", "devpts", 0, "newinstance,ptmxmode=0666") != 0) {
        return false;
    }
    const bool opened = mount("/dev/pts/ptmx", "/dev/ptmx", nullptr, MS_BIND, nullptr) == 0;
    return opened || umount2("/dev/pts", MNT_DETACH) != 0;
}();

}  // namespace

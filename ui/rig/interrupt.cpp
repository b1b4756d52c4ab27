#include "ui/rig/interrupt.hpp"

#include <array>
#include <atomic>
#include <csignal>
#include <cstdint>

#include "engine/base/clock.hpp"

namespace palpate::ui {
namespace {

/// A supervisor says it twice at once: timeout(1) to its child, and then to the child's group.
constexpr std::int64_t kSameWish = 1000 * kMillisecond;

std::atomic<bool> arrived{false};
std::array<std::atomic<std::int64_t>, NSIG> first_ns{};  ///< 0: that signal did not come yet
static_assert(std::atomic<bool>::is_always_lock_free &&
                  std::atomic<std::int64_t>::is_always_lock_free,
              "a signal sets them");

extern "C" void on_signal(int signal) {
    arrived = true;
    const std::int64_t now = monotonic_ns();
    std::int64_t first = 0;
    if (!first_ns[static_cast<std::size_t>(signal)].compare_exchange_strong(first, now) &&
        now - first > kSameWish) {
        std::signal(signal, SIG_DFL);
        std::raise(signal);
    }
}

}  // namespace

void catch_signals() {
    std::signal(SIGINT, on_signal);
    std::signal(SIGTERM, on_signal);
    std::signal(SIGHUP, on_signal);
    std::signal(SIGPIPE, SIG_IGN);
}

void interrupt() noexcept {
    arrived = true;
}

bool interrupted() noexcept {
    return arrived;
}

}  // namespace palpate::ui

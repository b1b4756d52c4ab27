#include "ui/rig/interrupt.hpp"

#include <atomic>
#include <csignal>

namespace palpate::ui {
namespace {

std::atomic<bool> arrived{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal sets it");

extern "C" void on_signal(int signal) {
    arrived = true;
    std::signal(signal, SIG_DFL);
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

#include "ui/rig/interrupt.hpp"

#include <csignal>

namespace palpate::ui {
namespace {

volatile std::sig_atomic_t arrived = 0;

extern "C" void on_signal(int signal) {
    arrived = 1;
    std::signal(signal, SIG_DFL);
}

}  // namespace

void catch_signals() {
    std::signal(SIGINT, on_signal);
    std::signal(SIGTERM, on_signal);
    std::signal(SIGHUP, on_signal);
    std::signal(SIGPIPE, SIG_IGN);
}

bool interrupted() noexcept {
    return arrived != 0;
}

}  // namespace palpate::ui
